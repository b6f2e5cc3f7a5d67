// Wavefront OBJ: its polygons. Normals and texture coordinates are ignored.

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include <knurl/meshfile/soup.hpp>

#include "words.hpp"

namespace knurl::meshfile {

namespace {

/// Statements without effect on the polygons.
constexpr std::array ignored = {
    "vt",     "vn",    "vp",       "g",          "o",         "s",      "mg",    "mtllib",
    "lod",    "bevel", "c_interp", "d_interp",   "maplib",    "usemap", "ctech", "stech",
    "cstype", "deg",   "bmat",     "step",       "parm",      "trim",   "hole",  "scrv",
    "sp",     "end",   "con",      "shadow_obj", "trace_obj", "curv2",  "csh"};
constexpr std::array freeform = {"surf", "bsp", "bzp", "cdc", "cdp", "res"};
constexpr std::array thin = {"p", "l", "curv"};

template <std::size_t n>
bool among(const std::array<const char*, n>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

class ObjReader {
  public:
    ObjReader(std::string_view bytes, Soup& soup) : lines_(bytes), soup_(soup) {}

    void read() {
        for (std::string_view line; lines_.next(line);) {
            first_ = lines_.number();
            statement(joined(line));
        }
        check_indices();
        if (unknown_ > 0)
            soup_.notes.push_back(
                fmt::format("{} line{} of other kinds are left out, the first is line {}: {}", unknown_,
                            unknown_ == 1 ? "" : "s", unknown_line_, unknown_word_));
    }

  private:
    [[noreturn]] void fail(const std::string& text) { bad_at(soup_, first_, text); }

    /// A line that ends with a backslash continues in the next one; a comment does not (it may name a
    /// folder).
    std::string_view joined(std::string_view line) {
        if (!goes_on(line) || line.find('#') != line.npos) return line;
        whole_.clear();
        while (goes_on(line)) {
            whole_.append(line.substr(0, line.rfind('\\'))).append(" ");
            if (!lines_.next(line)) fail("the file ends in a line that goes on (\\): it is cut off");
        }
        return whole_.append(line);
    }

    /// Some programs leave blanks behind the backslash.
    static bool goes_on(std::string_view line) {
        const auto last = line.find_last_not_of(" \t\v\f");
        return last != line.npos && line[last] == '\\';
    }

    void statement(std::string_view line) {
        std::string_view rest = line;
        const std::string key = lower(next_word(rest));
        if (key.empty() || key.front() == '#') return;
        if (key == "v") {
            vertex(uncommented(rest));
        } else if (key == "f" || key == "fo") {
            face(uncommented(rest));
        } else if (key == "usemtl") {
            use_material(rest);
        } else if (among(thin, key)) {
            ++soup_.points_and_lines;
        } else if (among(freeform, key)) {
            fail(
                fmt::format("\"{}\" is a free-form surface, and only polygons are read; let the program that "
                            "made it write triangles",
                            key));
        } else if (key == "call") {
            fail("\"call\" names another file, and only this one is read; write both as one");
        } else if (!among(ignored, key)) {
            if (unknown_++ == 0) {
                unknown_line_ = first_;
                unknown_word_ = in_quotes(key);
            }
        }
    }

    static std::string_view uncommented(std::string_view line) { return line.substr(0, line.find('#')); }

    void vertex(std::string_view rest) {
        std::array<double, 8> values{};
        std::size_t n = 0;
        for (std::string_view word; !(word = next_word(rest)).empty(); ++n) {
            const auto value = number_of(word);
            if (!value) fail("v: " + no_number(word));
            if (n == values.size()) fail("a vertex has more than 8 numbers; export the file again");
            values[n] = *value;
        }
        if (n < 3)
            fail(fmt::format("a vertex has {} number{} instead of x, y and z; export the file again", n,
                             n == 1 ? "" : "s"));
        // Four: a weight. Six: a colour. Seven: both.
        if ((n == 4 || n == 7) && values[3] != 1)
            fail(fmt::format("a vertex has the weight {:g}, which only free-form surfaces have; leave it out",
                             values[3]));
        if (soup_.vertices.size() == std::numeric_limits<std::uint32_t>::max() - 1)
            fail("there are too many vertices; write several files");
        soup_.vertices.push_back({values[0], values[1], values[2]});
    }

    void face(std::string_view rest) {
        const std::size_t before = soup_.corners.size();
        for (std::string_view word; !(word = next_word(rest)).empty();) soup_.corners.push_back(corner(word));
        const std::size_t n = soup_.corners.size() - before;
        if (n < 3) {
            soup_.corners.resize(before);
            ++soup_.points_and_lines;
            return;
        }
        soup_.polygons.push_back({.corners = static_cast<std::uint32_t>(n),
                                  .place = static_cast<std::uint32_t>(first_),
                                  .material = material()});
    }

    /// v, v/vt, v//vn or v/vt/vn, from 1; negative indices count back from the newest.
    std::uint32_t corner(std::string_view word) {
        const std::string_view first = word.substr(0, word.find('/'));
        const auto index = integer_of(first);
        bool fine = index.has_value();
        int slashes = 0;
        for (std::string_view rest = word.substr(first.size()); fine && !rest.empty(); ++slashes) {
            rest.remove_prefix(1);
            const std::string_view part = rest.substr(0, rest.find('/'));
            rest.remove_prefix(part.size());
            fine = slashes < 2 && (part.empty() || integer_of(part));
        }
        if (!fine)
            fail(fmt::format("f: {} is not v, v/vt, v//vn or v/vt/vn; export the file again",
                             in_quotes(word)));
        const auto there = static_cast<long long>(soup_.vertices.size());
        const long long from_zero = *index > 0 ? *index - 1 : there + *index;
        if (*index == 0) fail("f: a vertex has the number 0, they are counted from 1; export the file again");
        if (*index < 0 && from_zero < 0)
            fail(fmt::format("f: vertex {} is further back than the {} before it; export the file again",
                             *index, there));
        if (from_zero >= std::numeric_limits<std::uint32_t>::max()) out_of_range(first_, *index);
        greatest_ = std::max(greatest_, from_zero);
        return static_cast<std::uint32_t>(from_zero);
    }

    [[noreturn]] void out_of_range(std::uint64_t line, long long index) {
        bad_at(soup_, line,
               fmt::format("f: vertex {} is not there, the file has {}; is it whole? Write or fetch it again",
                           index, soup_.vertices.size()));
    }

    /// A face may come before its vertices.
    void check_indices() {
        if (greatest_ < static_cast<long long>(soup_.vertices.size())) return;
        std::size_t c = 0;
        for (const Soup::Polygon& polygon : soup_.polygons)
            for (std::uint32_t i = 0; i < polygon.corners; ++i, ++c)
                if (soup_.corners[c] >= soup_.vertices.size())
                    out_of_range(polygon.place, soup_.corners[c] + 1ll);
    }

    void use_material(std::string_view rest) {
        const auto begin = rest.find_first_not_of(" \t");
        const auto end = rest.find_last_not_of(" \t");
        name_ = begin == rest.npos ? "" : std::string(rest.substr(begin, end - begin + 1));
        known_ = false;
    }
    std::uint8_t material() {
        if (!known_) {
            auto& names = soup_.material_names;
            const auto found = std::find(names.begin(), names.end(), name_);
            if (found == names.end() && names.size() == most_materials)
                fail(fmt::format("has more than {} materials; join some", most_materials));
            material_ = static_cast<std::uint8_t>(found - names.begin());
            if (found == names.end()) names.push_back(name_);
            known_ = true;
        }
        return material_;
    }

    Lines lines_;
    Soup& soup_;
    std::string whole_;      // of several lines
    std::size_t first_ = 0;  // line of the statement
    long long greatest_ = -1;
    std::string name_ = "DefaultMaterial", unknown_word_;
    bool known_ = false;
    std::uint8_t material_ = 0;
    std::uint64_t unknown_ = 0, unknown_line_ = 0;
};

}  // namespace

Soup read_obj(std::string_view bytes, const std::string& path) {
    Soup soup;
    soup.path = path;
    soup.format = "OBJ";
    soup.text = true;
    ObjReader(bytes, soup).read();
    return soup;
}

}  // namespace knurl::meshfile
