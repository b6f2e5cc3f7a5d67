// PGM, P2 and P5, of more than 8 bits.

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "elevation.hpp"
#include "elevation_words.hpp"

namespace surface {
namespace {

/// Where the samples of a P5 may begin after its largest value: after the one blank that ends the header,
/// after CR LF, or after comments that some programs put there.
std::vector<std::string_view> beginnings(std::string_view behind) {
    std::vector<std::string_view> found;
    const auto add = [&](std::string_view data) {
        if (std::find(found.begin(), found.end(), data) == found.end()) found.push_back(data);
    };
    const auto over_line_end = [](std::string_view text) {
        return text.substr(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, text.size()));
    };
    if (behind.empty()) return found;
    if (behind.front() != '#') add(behind.substr(1));
    if (behind.starts_with("\r\n")) add(behind.substr(2));
    for (std::string_view rest = behind; !rest.empty();) {
        const auto begin = rest.find_first_not_of(" \t\r\n");
        if (begin == rest.npos || rest[begin] != '#') break;
        const auto end = rest.find_first_of("\r\n", begin);
        if (end == rest.npos) break;
        rest = over_line_end(rest.substr(end));
        add(rest);
    }
    return found;
}

/// What may follow the samples: a line end, or the next picture.
bool is_tail(std::string_view tail) {
    return tail == "\n" || tail == "\r\n" ||
           (tail.size() > 2 && tail[0] == 'P' && tail[1] >= '1' && tail[1] <= '7' &&
            std::string_view("# \t\r\n").find(tail[2]) != std::string_view::npos);
}

/// The samples of a P5: the possible beginning after which there are as many as the header says.
std::string_view samples(std::string_view behind, std::size_t wanted, const std::string& name,
                         std::vector<std::string>& notes) {
    std::size_t most = 0;
    for (const auto& data :
         beginnings(behind)) {  // the format's own rule first: samples may look like a comment
        most = std::max(most, data.size());
        if (data.size() == 2 * wanted) return data;
        if (data.size() < 2 * wanted || !is_tail(data.substr(2 * wanted))) continue;
        if (data.size() > 2 * wanted + 2)
            notes.emplace_back("the file holds several pictures; the first is read");
        return data.substr(0, 2 * wanted);
    }
    if (most < 2 * wanted) throw too_short(name, most / 2, wanted);
    throw std::runtime_error(fmt::format(
        "{}: {} bytes follow this PGM's header, but its {} samples of 16 bits take {}; mend the header's "
        "width, height and largest value, or cut the rest off",
        name, most, wanted, 2 * wanted));
}

}  // namespace

// NOLINTNEXTLINE(readability-function-cognitive-complexity): a file's format, from top to bottom
ElevationModel read_pgm(std::string_view bytes, const std::string& name) {
    Words words{.rest = bytes.substr(2), .comments = true, .within = true};
    std::optional<long> columns, rows, greatest;
    for (auto [value, what] :
         {std::pair{&columns, "width"}, {&rows, "height"}, {&greatest, "largest value"}}) {
        const auto word = words.next();
        *value = whole(word);
        if (!*value)
            throw std::runtime_error(
                fmt::format("{}: this PGM's header has \"{}\" where its {} belongs; write it again", name,
                            shown(word), what));
    }
    check_sides(name, *rows, *columns);
    if (*greatest < 256 || *greatest > 65535)
        throw std::runtime_error(
            fmt::format("{}: this PGM's largest value is {}: {}; "
                        "export it with 16 bits (256 to 65535)",
                        name, *greatest,
                        *greatest < 1       ? "that is none"
                        : *greatest > 65535 ? "the format has at most 65535"
                                            : "8 bits would be felt as stairs"));

    ElevationModel model{.rows = static_cast<int>(*rows), .columns = static_cast<int>(*columns)};
    const auto wanted = static_cast<std::size_t>(*rows) * static_cast<std::size_t>(*columns);
    std::optional<std::size_t> above;  // the first sample above
    if (bytes[1] == '5') {
        const auto data = samples(words.rest, wanted, name, model.notes);
        model.counts.reserve(wanted);
        for (std::size_t i = 0; i < wanted; ++i) {
            model.counts.push_back(static_cast<unsigned char>(data[2 * i]) * 256 +
                                   static_cast<unsigned char>(data[2 * i + 1]));
            if (!above && model.counts.back() > static_cast<double>(*greatest)) above = i;
        }
        check_byte_order(model, name);
        if (above)
            throw cell_error(
                name, *above, model.columns,
                fmt::format(
                    "is {}, above the largest value that the header states ({}); {}", model.counts[*above],
                    *greatest,
                    fits_swapped(model, static_cast<double>(*greatest))
                        ? "with the bytes of each swapped none is: swap them (dd conv=swab on the samples)"
                        : "mend the header, or export the file again"));
        return model;
    }
    model.counts.reserve(std::min(wanted, bytes.size()));
    for (std::size_t i = 0; i < wanted; ++i) {
        const auto word = words.next();
        if (word.empty()) throw too_short(name, i, wanted);
        const auto value = whole(word);
        if (!value || *value < 0 || *value > *greatest)
            throw cell_error(name, i, model.columns,
                             fmt::format("is \"{}\", not a whole number from 0 to {}; mend that cell",
                                         shown(word), *greatest));
        model.counts.push_back(static_cast<double>(*value));
    }
    if (const auto word = words.next(); !word.empty())
        throw std::runtime_error(
            fmt::format("{}: \"{}\" follows the {} heights that the header says; mend the header", name,
                        shown(word), wanted));
    return model;
}

}  // namespace surface
