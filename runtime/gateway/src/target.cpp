#include "target.hpp"

#include <algorithm>

namespace knurl::gateway {

namespace {

constexpr std::size_t most_parameters = 64;

int percent_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::optional<std::string> percent_decoded(std::string_view text, bool form) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '%') {
            if (i + 2 >= text.size()) return {};
            const int high = percent_digit(text[i + 1]), low = percent_digit(text[i + 2]);
            if (high < 0 || low < 0) return {};
            c = static_cast<char>(16 * high + low);
            i += 2;
        } else if (form && c == '+') {
            c = ' ';
        }
        // No control characters: paths stand in messages, and names of files come from parameters.
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') return {};
        out += c;
    }
    return out;
}

std::string_view without_blanks(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

template <class Each>
void for_each_part(std::string_view text, char at, Each each) {
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(at), text.size());
        each(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

}  // namespace

std::optional<Target> parse_target(std::string_view target) {
    if (target.empty() || target.front() != '/') return {};
    const std::size_t mark = std::min(target.find('?'), target.size());
    auto path = percent_decoded(target.substr(0, mark), false);
    if (!path) return {};
    Target result{.path = std::move(*path), .query = {}};
    bool good = true;
    std::size_t count = 0;
    for_each_part(target.substr(std::min(mark + 1, target.size())), '&', [&](std::string_view pair) {
        const std::size_t equals = std::min(pair.find('='), pair.size());
        auto name = percent_decoded(pair.substr(0, equals), true);
        auto value = percent_decoded(pair.substr(std::min(equals + 1, pair.size())), true);
        good = good && name && value && ++count <= most_parameters;
        if (good && !name->empty()) result.query[std::move(*name)] = std::move(*value);
    });
    if (!good) return {};
    return result;
}

std::string_view cookie_of(std::string_view header, std::string_view name) {
    std::string_view found;
    for_each_part(header, ';', [&](std::string_view pair) {
        pair = without_blanks(pair);
        if (found.empty() && pair.size() > name.size() && pair.starts_with(name) && pair[name.size()] == '=')
            found = pair.substr(name.size() + 1);
    });
    return found;
}

std::vector<std::string_view> listed(std::string_view header) {
    std::vector<std::string_view> words;
    for_each_part(header, ',', [&](std::string_view word) {
        word = without_blanks(word);
        if (!word.empty()) words.push_back(word);
    });
    return words;
}

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

std::optional<std::size_t> fits(std::string_view pattern, std::string_view path) {
    if (pattern.ends_with('*')) {
        pattern.remove_suffix(1);
        if (!path.starts_with(pattern)) return {};
        return pattern.size();
    }
    if (pattern != path) return {};
    return pattern.size() + 1;  // before a pattern with a *
}

}  // namespace knurl::gateway
