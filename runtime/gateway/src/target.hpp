#pragma once
// What a request line and a header of HTTP say, without HTTP.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace knurl::gateway {

struct Target {
    std::string path;
    std::map<std::string, std::string> query;
};

/// "/a%20b?x=1&y": decoded. Nothing: it is none, or holds control characters.
std::optional<Target> parse_target(std::string_view target);

/// The value of a cookie, from a Cookie header; empty: it has none of that name.
std::string_view cookie_of(std::string_view header, std::string_view name);

/// Words between commas, without blanks around them.
std::vector<std::string_view> listed(std::string_view header);

/// ASCII letters in lower case.
std::string lower(std::string_view text);

/// A pattern of a route: how many characters of it fit; nothing: it does not fit.
std::optional<std::size_t> fits(std::string_view pattern, std::string_view path);

}  // namespace knurl::gateway
