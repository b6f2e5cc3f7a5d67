#pragma once

/// @file
/// What a servo, or a device, may be called: it is part of a socket's path and of an address.

#include <string_view>

#include <knurl/protocol/bounds.hpp>

namespace knurl::protocol {

/// 1 to name_bytes - 1 of the characters a-z A-Z 0-9 _ . - and no dot in front.
constexpr bool is_name(std::string_view name) noexcept {
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return !name.empty() && name.size() < name_bytes && name.front() != '.' &&
           name.find_first_not_of(letters) == std::string_view::npos;
}

}  // namespace knurl::protocol
