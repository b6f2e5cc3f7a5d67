#pragma once

/// @file
/// How a bridge's address is written.

#include <string>

namespace knurl::bridge {

/// Throws std::runtime_error, one line, for what is none, as resolve_all() does; looks no name up.
void check_host_and_port(const std::string& host_and_port);

}  // namespace knurl::bridge
