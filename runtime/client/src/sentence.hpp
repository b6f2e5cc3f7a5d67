#pragma once
// Turns the servo's numeric answers into one line: what, where, what to do.

#include <string>

#include <knurl/protocol/command.hpp>

namespace knurl::detail {

/// For a refused command: "arm of device 'right': in fault (speed); call reset_fault() ..."
std::string refused_command(const protocol::Reply& reply, const std::string& what);

/// For a refused batch, from the feedback.
std::string refused_batch(const protocol::FeedbackHeader& header);

/// "slew, speed": the names of a fault mask's bits.
std::string fault_names(std::uint32_t faults);

}  // namespace knurl::detail
