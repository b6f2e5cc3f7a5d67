#pragma once

/// @file
/// Texts in the fixed fields of messages and of shared memory: cut to fit, a zero behind them.

#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

namespace knurl::protocol {

/// Writes a text into a field of zeros, cut to fit.
template <std::size_t n>
void put_text(char (&field)[n], std::string_view text) noexcept {
    text.copy(field, n - 1);
}

/// The text in a field.
template <std::size_t n>
std::string text_of(const char (&field)[n]) {
    return {field, ::strnlen(field, n)};
}

/// A client's name as it may be printed on other people's terminals.
std::string printable(const std::string& name);
/// The same of a field.
template <std::size_t n>
std::string printable(const char (&field)[n]) {
    return printable(text_of(field));
}

}  // namespace knurl::protocol
