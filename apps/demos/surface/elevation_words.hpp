#pragma once
// Words of a text, and their values as numbers.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include <knurl/words/printable.hpp>

namespace surface {

/// Word after word; empty at the end of the text.
struct Words {
    static constexpr std::string_view blank = " \t\r\n\f\v";

    std::string_view rest;
    bool comments = false;  // from # to the end of the line
    bool within = false;    // # also ends a word

    std::string_view next() {
        for (;;) {
            const auto begin = rest.find_first_not_of(blank);
            if (begin == std::string_view::npos) return rest = {};
            rest.remove_prefix(begin);
            if (!comments || rest.front() != '#') break;
            const auto line = rest.find_first_of("\r\n");
            if (line == std::string_view::npos) return rest = {};
            rest.remove_prefix(line);
        }
        std::size_t end = 0;
        while (end < rest.size() && blank.find(rest[end]) == blank.npos && !(within && rest[end] == '#'))
            ++end;
        const auto word = rest.substr(0, end);
        rest.remove_prefix(end);
        return word;
    }
};

/// The part that fits a line of text, without control characters.
inline std::string shown(std::string_view word) {
    return knurl::words::printable(word, 40);
}

inline std::optional<double> number(std::string_view word) {
    double value = 0;
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

inline std::optional<long> whole(std::string_view word) {
    const auto value = number(word);
    if (!value || *value != std::floor(*value) || std::abs(*value) > 1e9) return std::nullopt;
    return static_cast<long>(*value);
}

inline std::string lower(std::string_view word) {
    std::string out(word);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

}  // namespace surface
