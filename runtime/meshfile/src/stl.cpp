// STL, text and binary.

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include <knurl/meshfile/soup.hpp>

#include "words.hpp"

namespace knurl::meshfile {

namespace {

constexpr std::size_t head = 84, record = 50;  // bytes: a title and a count; a triangle

template <class T>
T little(const char* at) {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

std::uint32_t count_of(std::string_view bytes) {
    return little<std::uint32_t>(bytes.data() + 80);
}

bool fits_its_count(std::string_view bytes) {
    return bytes.size() >= head && bytes.size() == head + record * std::size_t{count_of(bytes)};
}

/// Without the padding that some programs put after a text: zeros, or CP/M's end-of-file.
std::string_view unfilled(std::string_view bytes) {
    const auto last = bytes.find_last_not_of(std::string_view("\0\x1a", 2));
    return bytes.substr(0, last == bytes.npos ? 0 : last + 1);
}

bool is_printable(std::string_view bytes) {
    return std::all_of(bytes.begin(), bytes.end(),
                       [](char c) { return c >= ' ' || (c >= '\t' && c <= '\r'); });
}

/// "solid", and after its line a word of the format. Binary files may also begin with "solid".
bool is_text(std::string_view bytes) {
    if (bytes.substr(0, 2000).find('\0') != bytes.npos) return false;
    Lines lines(bytes);
    bool solid = false;
    for (std::string_view line; lines.next(line);) {
        const std::string_view word = next_word(line);
        if (word.empty()) continue;
        if (solid) return same_word(word, "facet") || same_word(word, "endsolid") || same_word(word, "solid");
        if (!same_word(word, "solid")) return false;
        solid = true;
    }
    return solid;
}

class TextReader {
  public:
    TextReader(std::string_view bytes, Soup& soup) : lines_(bytes), soup_(soup) {}

    void read() {
        while (advance()) {
            if (!take("solid")) fail("solid");
            // Its name extends to the end of the line.
            line_ = {};
            bool ended = false;
            while (!ended && more()) {
                ended = take("endsolid");
                if (!ended) facet();
            }
            if (!ended) {
                soup_.notes.emplace_back("no \"endsolid\" at the end of the file: is it whole?");
                return;
            }
        }
    }

  private:
    /// To the next non-empty line.
    bool advance() {
        while (lines_.next(line_)) {
            std::string_view look = line_;
            if (!next_word(look).empty()) return true;
        }
        return false;
    }
    bool take(std::string_view wanted) {
        std::string_view look = line_;
        if (!same_word(next_word(look), wanted)) return false;
        line_ = look;
        return true;
    }
    /// To the next word, on this line or a later one.
    bool more() {
        std::string_view look = line_;
        return !next_word(look).empty() || advance();
    }
    void need(std::string_view wanted) {
        if (!more()) cut_off();
        if (!take(wanted)) fail(wanted);
    }
    [[noreturn]] void cut_off() {
        bad_at(soup_, lines_.number(),
               "the file ends within a facet: it is cut off; write or fetch it again");
    }
    [[noreturn]] void fail(std::string_view wanted) {
        std::string_view look = line_;
        const auto word = next_word(look);
        if (wanted == "endloop" && same_word(word, "vertex"))
            bad_at(soup_, lines_.number(),
                   "a facet has a fourth vertex; STL has triangles: cut it into some");
        bad_at(soup_, lines_.number(),
               fmt::format("{} where \"{}\" belongs; export the file again", in_quotes(word), wanted));
    }

    void facet() {
        if (!take("facet")) fail("facet");
        const auto place = static_cast<std::uint32_t>(lines_.number());
        // The normal is optional: the order of the corners gives it.
        if (take("normal"))
            for (int k = 0; k < 3; ++k) {
                std::string_view look = line_;
                if (!same_word(next_word(look), "outer")) line_ = look;
            }
        need("outer");
        need("loop");
        for (int k = 0; k < 3; ++k) {
            need("vertex");
            knurl::Point3 at;
            for (double& x : at) {
                const auto word = next_word(line_);
                const auto value = number_of(word);
                if (!value) bad_at(soup_, lines_.number(), "vertex: " + no_number(word));
                x = *value;
            }
            soup_.corners.push_back(static_cast<std::uint32_t>(soup_.vertices.size()));
            soup_.vertices.push_back(at);
        }
        need("endloop");
        need("endfacet");
        soup_.polygons.push_back({.corners = 3, .place = place});
    }

    Lines lines_;
    std::string_view line_;
    Soup& soup_;
};

/// The number of triangles of a binary file; throws if it cannot be determined.
std::size_t triangles_of(std::string_view bytes, Soup& soup) {
    const std::size_t counted = count_of(bytes), body = bytes.size() - head, there = body / record;
    const bool whole = body % record == 0;
    if (counted == there && whole) return there;
    // Programs that do not know the number at the start leave 0 or -1.
    if ((counted == 0 || counted == 0xffffffff) && whole && there > 0) {
        soup.notes.push_back(fmt::format("its header counts {} triangles; all {} of the file are read",
                                         counted == 0 ? "0" : "-1", there));
        return there;
    }
    if (counted > there)
        bad(soup.path,
            fmt::format("byte 80: the header counts {} triangles, which take {} bytes, but the file "
                        "has {}: it is cut off, or no STL; write or fetch it again",
                        counted, head + record * counted, bytes.size()));
    const std::size_t more = body - record * counted;
    if (counted == 0 || whole)
        bad(soup.path,
            fmt::format("byte 80: the header counts {} triangle{}, but {} bytes follow {}; write it "
                        "again with the right count",
                        counted, counted == 1 ? "" : "s", more, counted == 0 ? "it" : "them"));
    soup.notes.push_back(fmt::format("{} byte{} behind its {} triangles {} left out", more,
                                     more == 1 ? "" : "s", counted, more == 1 ? "is" : "are"));
    return counted;
}

}  // namespace

bool is_stl(std::string_view bytes) {
    return is_text(unfilled(bytes)) || fits_its_count(bytes);
}

Soup read_stl(std::string_view bytes, const std::string& path) {
    Soup soup;
    soup.path = path;
    // If it is a text, but not of the format, the error names its first wrong line.
    const std::string_view text = unfilled(bytes);
    if (!fits_its_count(bytes) &&
        (is_text(text) || (text.size() > head && is_printable(text.substr(0, 2000))))) {
        soup.format = "STL, text";
        soup.text = true;
        TextReader(text, soup).read();
        return soup;
    }
    if (bytes.size() < head)
        bad(path,
            fmt::format("is no STL: neither \"solid\" and facets, nor the {} bytes that a binary file has "
                        "before its triangles ({} are there); write or fetch it again",
                        head, bytes.size()));
    soup.format = "STL, binary";
    const std::size_t n = triangles_of(bytes, soup);
    soup.vertices.reserve(3 * n);
    soup.corners.reserve(3 * n);
    soup.polygons.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
        const char* at = bytes.data() + head + record * i + 12;  // behind the normal
        for (int k = 0; k < 3; ++k, at += 12) {
            soup.corners.push_back(static_cast<std::uint32_t>(soup.vertices.size()));
            soup.vertices.push_back(
                {double{little<float>(at)}, double{little<float>(at + 4)}, double{little<float>(at + 8)}});
        }
        soup.polygons.push_back({.corners = 3, .place = static_cast<std::uint32_t>(i + 1)});
    }
    return soup;
}

}  // namespace knurl::meshfile
