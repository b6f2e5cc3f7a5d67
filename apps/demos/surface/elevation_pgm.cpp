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

struct PgmHeader {
    long columns, rows, greatest;
    std::size_t samples() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns); }
};

PgmHeader take_pgm_header(Words& words, const std::string& name) {
    const auto take = [&](const char* what) {
        const auto word = words.next();
        const auto value = whole(word);
        if (!value)
            throw std::runtime_error(
                fmt::format("{}: this PGM's header has \"{}\" where its {} belongs; write it again", name,
                            shown(word), what));
        return *value;
    };
    // A list in braces is evaluated from left to right.
    const PgmHeader header{
        .columns = take("width"), .rows = take("height"), .greatest = take("largest value")};
    check_sides(name, header.rows, header.columns);
    if (header.greatest < 256 || header.greatest > 65535)
        throw std::runtime_error(
            fmt::format("{}: this PGM's largest value is {}: {}; "
                        "export it with 16 bits (256 to 65535)",
                        name, header.greatest,
                        header.greatest < 1       ? "that is none"
                        : header.greatest > 65535 ? "the format has at most 65535"
                                                  : "8 bits would be felt as stairs"));
    return header;
}

/// The samples of a P5, after its header.
void read_binary_samples(std::string_view behind, const PgmHeader& header, const std::string& name,
                         ElevationModel& model) {
    const auto data = samples(behind, header.samples(), name, model.notes);
    const auto greatest = static_cast<double>(header.greatest);
    std::optional<std::size_t> above;  // the first sample above
    model.counts.reserve(header.samples());
    for (std::size_t i = 0; i < header.samples(); ++i) {
        model.counts.push_back(static_cast<unsigned char>(data[2 * i]) * 256 +
                               static_cast<unsigned char>(data[2 * i + 1]));
        if (!above && model.counts.back() > greatest) above = i;
    }
    check_byte_order(model, name);
    if (above)
        throw cell_error(
            name, *above, model.columns,
            fmt::format(
                "is {}, above the largest value that the header states ({}); {}", model.counts[*above],
                header.greatest,
                fits_swapped(model, greatest)
                    ? "with the bytes of each swapped none is: swap them (dd conv=swab on the samples)"
                    : "mend the header, or export the file again"));
}

/// The samples of a P2, after its header.
void read_text_samples(Words& words, const PgmHeader& header, const std::string& name,
                       ElevationModel& model) {
    const std::size_t wanted = header.samples();
    model.counts.reserve(std::min(wanted, words.rest.size()));
    for (std::size_t i = 0; i < wanted; ++i) {
        const auto word = words.next();
        if (word.empty()) throw too_short(name, i, wanted);
        const auto value = whole(word);
        if (!value || *value < 0 || *value > header.greatest)
            throw cell_error(name, i, model.columns,
                             fmt::format("is \"{}\", not a whole number from 0 to {}; mend that cell",
                                         shown(word), header.greatest));
        model.counts.push_back(static_cast<double>(*value));
    }
    if (const auto word = words.next(); !word.empty())
        throw std::runtime_error(
            fmt::format("{}: \"{}\" follows the {} heights that the header says; mend the header", name,
                        shown(word), wanted));
}

}  // namespace

ElevationModel read_pgm(std::string_view bytes, const std::string& name) {
    Words words{.rest = bytes.substr(2), .comments = true, .within = true};
    const PgmHeader header = take_pgm_header(words, name);
    ElevationModel model{.rows = static_cast<int>(header.rows), .columns = static_cast<int>(header.columns)};
    if (bytes[1] == '5') {
        read_binary_samples(words.rest, header, name, model);
    } else {
        read_text_samples(words, header, name, model);
    }
    return model;
}

}  // namespace surface
