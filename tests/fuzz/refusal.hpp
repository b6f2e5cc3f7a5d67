#pragma once
// Checks a reader's message for a file that it refuses.

#include <cstdio>
#include <string_view>

#include "require.hpp"

namespace knurl::fuzz {

/// Demands one line that names the file, without a terminal's control characters.
inline void check_refusal(std::string_view text, std::string_view file, std::size_t longest = 600) {
    if (!text.starts_with(file)) std::fprintf(stderr, "%.*s\n", static_cast<int>(text.size()), text.data());
    require(text.starts_with(file), "a refusal names the file");
    require(!text.empty() && text.size() < longest, "a refusal is short");
    for (const char c : text)
        require(static_cast<unsigned char>(c) >= ' ' && c != 0x7f, "a refusal is one line of text");
}

}  // namespace knurl::fuzz
