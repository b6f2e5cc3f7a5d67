#pragma once

/// @file
/// Text of others (a file, a command line) as a part of one of our messages.

#include <cstddef>
#include <string>
#include <string_view>

namespace knurl::words {

/// `said` on one line, with ? for each byte that is no printable ASCII: a terminal obeys escape sequences,
/// and also control characters beyond ASCII. Cut after `most` bytes, and then "..." says so.
inline std::string printable(std::string_view said, std::size_t most = std::string_view::npos) {
    std::string line;
    for (const char c : said.substr(0, most)) line += c >= ' ' && c <= '~' ? c : '?';
    return said.size() > most ? line + "..." : line;
}

}  // namespace knurl::words
