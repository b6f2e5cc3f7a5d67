#pragma once
// The servo answers with numbers; here they become one line: what, where, what to do.

#include <string>

#include <knurl/protocol/command.hpp>

namespace knurl::detail {

/// Of a command that was refused: "arm of device 'right': in fault (speed); call reset_fault() ..."
std::string refused_command(const protocol::Reply& reply, const std::string& what);

/// Of a batch that was refused, from the feedback.
std::string refused_batch(const protocol::FeedbackHeader& header);

/// "slew, speed": the names of a fault mask's bits.
std::string fault_names(std::uint32_t faults);

}  // namespace knurl::detail
