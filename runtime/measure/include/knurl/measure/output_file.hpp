#pragma once
// Writes a program's results to the user's files.

#include <string>

namespace knurl::measure {

/// All or nothing: an existing file stays if writing fails. "-" is standard output. Throws std::runtime_error
/// with path and reason.
void write_file(const std::string& path, const std::string& text);

/// For a program that works long before it writes. Throws as write_file() would.
void require_writable(const std::string& path);

}  // namespace knurl::measure
