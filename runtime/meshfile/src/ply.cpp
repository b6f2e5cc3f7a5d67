// PLY: text, little and big endian; faces and triangle strips. Other elements are skipped.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include <knurl/meshfile/soup.hpp>

#include "ply_header.hpp"
#include "words.hpp"

namespace knurl::meshfile {

namespace {

/// Reads value after value, from text or bytes.
class Body {
  public:
    Body(std::string_view bytes, const PlyHeader& head, const Soup& soup)
        : lines_(bytes.substr(head.bytes)),
          form_(head.form),
          soup_(soup),
          line_(head.lines),
          rest_(bytes.substr(head.bytes)) {}

    void begin(const PlyElement& element) {
        element_ = &element;
        if (form_ == PlyHeader::Form::text || element.least_bytes() == 0) return;
        if (rest_.size() / element.least_bytes() < element.count)
            bad(soup_.path,
                fmt::format(
                    "the head counts {} of element {}, which take {} bytes or more, but {} are left: it is "
                    "cut off; write or fetch it again",
                    element.count, element.name, element.least_bytes() * element.count, rest_.size()));
    }
    void item(std::uint64_t number) { number_ = number; }

    /// The line in a text, else the number of the item.
    std::uint64_t place() const {
        return form_ == PlyHeader::Form::text ? line_ + lines_.number() : number_ + 1;
    }

    [[noreturn]] void fail(const std::string& text) const {
        if (form_ == PlyHeader::Form::text) bad_at(soup_, place(), text);
        bad(soup_.path, fmt::format("{} {}: {}", element_->name, number_ + 1, text));
    }

    double value(PlyType type) {
        if (form_ != PlyHeader::Form::text) return binary(type);
        std::string_view word;
        while ((word = next_word(words_)).empty())
            if (!lines_.next(words_)) cut_off();
        const auto number = number_of(word);
        if (!number) fail(no_number(word));
        return *number;
    }

    void end_of_item() {
        if (const auto word = next_word(words_); !word.empty())
            fail(
                fmt::format("{} behind the values that the head states for element {}; export the file again",
                            in_quotes(word), element_->name));
    }

    void end() {
        if (form_ != PlyHeader::Form::text) {
            constexpr std::string_view line_end = "\r\n";
            const bool blank = rest_.find_first_not_of(line_end) == rest_.npos;
            if (!blank || rest_.size() > line_end.size())
                bad(soup_.path,
                    fmt::format("{} bytes follow what the head counts; export the file again", rest_.size()));
            return;
        }
        while (lines_.next(words_))
            if (!next_word(words_).empty())
                bad_at(soup_, place(), "more lines than the head counts; export the file again");
    }

  private:
    [[noreturn]] void cut_off() const {
        bad(soup_.path,
            fmt::format("ends within element {}, after {} of {}: it is cut off; write or fetch it again",
                        element_->name, number_, element_->count));
    }

    template <class T>
    double taken() {
        std::array<char, sizeof(T)> bytes;
        if (rest_.size() < sizeof(T)) cut_off();
        std::memcpy(bytes.data(), rest_.data(), sizeof(T));
        rest_.remove_prefix(sizeof(T));
        const bool same = (form_ == PlyHeader::Form::little) == (std::endian::native == std::endian::little);
        if (!same) std::reverse(bytes.begin(), bytes.end());
        return static_cast<double>(std::bit_cast<T>(bytes));
    }
    double binary(PlyType type) {
        switch (type) {
            case PlyType::i8:
                return taken<std::int8_t>();
            case PlyType::u8:
                return taken<std::uint8_t>();
            case PlyType::i16:
                return taken<std::int16_t>();
            case PlyType::u16:
                return taken<std::uint16_t>();
            case PlyType::i32:
                return taken<std::int32_t>();
            case PlyType::u32:
                return taken<std::uint32_t>();
            case PlyType::f32:
                return taken<float>();
            case PlyType::f64:
                break;
        }
        return taken<double>();
    }

    Lines lines_;
    PlyHeader::Form form_;
    const Soup& soup_;
    std::size_t line_;  // the last line of the head
    std::string_view rest_, words_;
    const PlyElement* element_ = nullptr;
    std::uint64_t number_ = 0;
};

class PlyReader {
  public:
    PlyReader(std::string_view bytes, const PlyHeader& head, Soup& soup)
        : head_(head), body_(bytes, head, soup), soup_(soup) {}

    void read() {
        for (const PlyElement& element : head_.elements)
            if (element.name == "vertex") vertices_ = static_cast<double>(element.count);
        for (const PlyElement& element : head_.elements) {
            const bool vertices = element.name == "vertex", faces = element.name == "face",
                       strips = element.name == "tristrips";
            const auto axes = vertices ? axes_of(element) : std::array<std::size_t, 3>{};
            const std::size_t corners = vertices ? PlyElement::absent : corners_of(element, faces || strips);
            if (element.name == "edge") soup_.points_and_lines += element.count;
            if (element.properties.empty()) continue;
            strips_ = strips;
            body_.begin(element);
            values_.resize(element.properties.size());
            for (std::uint64_t i = 0; i < element.count; ++i) {
                body_.item(i);
                one(element, corners);
                body_.end_of_item();
                if (vertices)
                    soup_.vertices.push_back({values_[axes[0]], values_[axes[1]], values_[axes[2]]});
                if (faces) face();
                if (strips) strip();
            }
        }
        body_.end();
        check_indices();
    }

  private:
    std::array<std::size_t, 3> axes_of(const PlyElement& element) const {
        const std::array axes = {element.property("x"), element.property("y"), element.property("z")};
        for (const std::size_t axis : axes)
            if (axis == PlyElement::absent || element.properties[axis].count)
                bad(soup_.path, "the head's vertices have no x, y and z; give a file with places");
        return axes;
    }

    std::size_t corners_of(const PlyElement& element, bool wanted) const {
        std::size_t corners = element.property("vertex_indices");
        if (corners == PlyElement::absent) corners = element.property("vertex_index");
        if (corners != PlyElement::absent && !element.properties[corners].count) corners = PlyElement::absent;
        if (element.count == 0 || wanted == (corners != PlyElement::absent)) return corners;
        if (wanted)
            bad(soup_.path,
                fmt::format("element {} has no list vertex_indices; export the file again with faces",
                            element.name));
        bad(soup_.path,
            fmt::format("element {} has lists of vertices, and only face and tristrips are known; let "
                        "the program that made it write faces",
                        element.name));
    }

    void one(const PlyElement& element, std::size_t wanted) {
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty& property = element.properties[p];
            values_[p] = body_.value(property.count.value_or(property.type));
            if (p == 0) place_ = body_.place();
            if (!property.count) continue;
            if (!(values_[p] >= 0 && values_[p] < 4294967296.0) || values_[p] != std::floor(values_[p]))
                body_.fail(fmt::format("the list {} has {:g} entries; export the file again", property.name,
                                       values_[p]));
            const bool kept = wanted == p;
            if (kept) list_.clear();
            for (auto left = static_cast<std::uint64_t>(values_[p]); left > 0; --left) {
                const double entry = body_.value(property.type);
                if (kept) list_.push_back(begins_anew(entry, property.type) ? new_strip : index(entry));
            }
        }
    }

    /// -1, or its value in an unsigned type, unless there is such a vertex.
    bool begins_anew(double entry, PlyType type) const {
        if (entry < 0) return true;
        const bool is_unsigned = type == PlyType::u8 || type == PlyType::u16 || type == PlyType::u32;
        return strips_ && is_unsigned && entry >= vertices_ &&
               entry == std::ldexp(1.0, static_cast<int>(8 * bytes_of(type))) - 1;
    }

    std::uint32_t index(double entry) {
        if (!(entry >= 0 && entry < std::numeric_limits<std::uint32_t>::max()) || entry != std::floor(entry))
            body_.fail(fmt::format("{:g} is no number of a vertex; export the file again", entry));
        return static_cast<std::uint32_t>(entry);
    }

    void face() {
        if (list_.size() < 3) {
            ++soup_.points_and_lines;
            return;
        }
        for (const std::uint32_t v : list_) {
            if (v == new_strip) body_.fail("a vertex has a number below 0; export the file again");
            soup_.corners.push_back(v);
        }
        add(list_.size());
    }

    /// Each three in a row are a triangle, every second one with the opposite winding; a negative entry
    /// begins a new strip.
    void strip() {
        std::size_t begin = 0;
        for (std::size_t i = 0; i < list_.size(); ++i) {
            if (list_[i] == new_strip) begin = i + 1;
            if (i < begin + 2) continue;
            const std::uint32_t a = list_[i - 2], b = list_[i - 1], c = list_[i];
            if (a == b || b == c || a == c) continue;  // joins two strips
            const bool turned = (i - begin) % 2 != 0;
            for (const std::uint32_t v : {turned ? b : a, turned ? a : b, c}) soup_.corners.push_back(v);
            add(3);
        }
    }

    void add(std::size_t corners) {
        soup_.polygons.push_back(
            {.corners = static_cast<std::uint32_t>(corners), .place = static_cast<std::uint32_t>(place_)});
    }

    /// Faces may come before their vertices.
    void check_indices() {
        std::size_t c = 0;
        for (const Soup::Polygon& polygon : soup_.polygons)
            for (std::uint32_t i = 0; i < polygon.corners; ++i, ++c)
                if (soup_.corners[c] >= soup_.vertices.size())
                    bad_at(
                        soup_, polygon.place,
                        fmt::format(
                            "vertex {} is not there, the file has {}, counted from 0; export the file again",
                            soup_.corners[c], soup_.vertices.size()));
    }

    const PlyHeader& head_;
    Body body_;
    Soup& soup_;
    static constexpr std::uint32_t new_strip = 0xffffffff;
    double vertices_ = 0;              // that the head counts
    bool strips_ = false;              // the element has strips
    std::vector<double> values_;       // of the present item
    std::vector<std::uint32_t> list_;  // its list of vertices
    std::uint64_t place_ = 0;          // where it began
};

}  // namespace

Soup read_ply(std::string_view bytes, const std::string& path) {
    Soup soup;
    soup.path = path;
    const PlyHeader head = read_ply_header(bytes, path);
    soup.text = head.form == PlyHeader::Form::text;
    soup.format = soup.text                              ? "PLY, text"
                  : head.form == PlyHeader::Form::little ? "PLY, little endian"
                                                         : "PLY, big endian";
    PlyReader(bytes, head, soup).read();
    return soup;
}

}  // namespace knurl::meshfile
