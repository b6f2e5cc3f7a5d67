#include "words.hpp"

#include <algorithm>
#include <charconv>
#include <string>

#include <fmt/format.h>

#include <knurl/words/printable.hpp>

namespace knurl::meshfile {

bool Lines::next(std::string_view& line) {
    if (rest_.empty()) return false;
    ++number_;
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    line = rest_.substr(0, end);
    rest_.remove_prefix(end);
    rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : rest_.empty() ? 0 : 1);
    return true;
}

std::string_view next_word(std::string_view& line) {
    constexpr std::string_view blank = " \t\v\f\r\n";
    line.remove_prefix(std::min(line.find_first_not_of(blank), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(blank));
    line.remove_prefix(word.size());
    return word;
}

std::optional<double> number_of(std::string_view word) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || word.empty()) return std::nullopt;
    if (error == std::errc{}) return value;
    // Out of range: so small that it is 0, or so large that it is no length.
    const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    return error == std::errc::result_out_of_range && tiny ? std::optional(0.0) : std::nullopt;
}

std::optional<long long> integer_of(std::string_view word) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    long long value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

std::string in_quotes(std::string_view word) {
    return '"' + knurl::words::printable(word, 30) + '"';
}

std::string no_number(std::string_view word) {
    if (word.empty()) return "a number is missing; export the file again";
    if (const auto comma = word.find(',');
        comma != word.npos && std::count(word.begin(), word.end(), ',') == 1) {
        std::string point(word);
        point[comma] = '.';
        if (number_of(point))
            return fmt::format("{} is not a number: the format has decimal points, no commas; write {}",
                               in_quotes(word), point);
    }
    return in_quotes(word) + " is not a number; export the file again";
}

std::string lower(std::string_view word) {
    std::string out(word);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

bool same_word(std::string_view word, std::string_view lower_case) {
    return lower(word) == lower_case;
}

}  // namespace knurl::meshfile
