#pragma once

/// @file
/// Text for errors and names, inside Knurl's libraries. An application needs no libfmt for them, so fmt comes
/// from its headers alone, and is compiled here once: a source that called fmt::format() itself would have
/// all of it.

#include <string>
#include <utility>

#include <fmt/core.h>

namespace knurl::detail {

std::string format_text(fmt::string_view pattern, fmt::format_args arguments);

/// As fmt::format().
template <class... Arguments>
std::string format(fmt::format_string<Arguments...> pattern, Arguments&&... arguments) {
    return format_text(pattern, fmt::make_format_args(arguments...));
}

}  // namespace knurl::detail
