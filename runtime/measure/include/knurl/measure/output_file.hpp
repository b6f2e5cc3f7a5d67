#pragma once
// What a program leaves in a file of the user's.

#include <string>

namespace knurl::measure {

/// All of it or nothing: what was there stays if it cannot be written. "-" is standard output. Throws
/// std::runtime_error with the path and the reason.
void write_file(const std::string& path, const std::string& text);

/// For who works long before there is something to write. Throws as write_file() would.
void require_writable(const std::string& path);

}  // namespace knurl::measure
