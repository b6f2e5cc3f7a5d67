#pragma once
// Texts of idlc's C structs.

#include <string>

namespace knurl::dds {

/// Its pointers are not const, and nothing writes through them.
inline char* text(const std::string& of) {
    return const_cast<char*>(of.c_str());
}

/// What a peer has written; empty for none.
inline std::string said(const char* text) {
    return text == nullptr ? std::string() : std::string(text);
}

}  // namespace knurl::dds
