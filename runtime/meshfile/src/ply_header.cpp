#include "ply_header.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include <knurl/meshfile/soup.hpp>
#include <knurl/words/printable.hpp>

#include "words.hpp"

namespace knurl::meshfile {

namespace {

constexpr std::size_t most_of_a_name = 100;  // bytes; messages show the whole name

struct TypeName {
    std::string_view name;
    PlyType type;
};
constexpr std::array type_names = {
    TypeName{"char", PlyType::i8},     TypeName{"int8", PlyType::i8},     TypeName{"uchar", PlyType::u8},
    TypeName{"uint8", PlyType::u8},    TypeName{"short", PlyType::i16},   TypeName{"int16", PlyType::i16},
    TypeName{"ushort", PlyType::u16},  TypeName{"uint16", PlyType::u16},  TypeName{"int", PlyType::i32},
    TypeName{"int32", PlyType::i32},   TypeName{"uint", PlyType::u32},    TypeName{"uint32", PlyType::u32},
    TypeName{"float", PlyType::f32},   TypeName{"float32", PlyType::f32}, TypeName{"double", PlyType::f64},
    TypeName{"float64", PlyType::f64},
};

/// The head's lines, with the line end of the first line: the following data may begin with bytes that look
/// like a line end.
class HeadLines {
  public:
    explicit HeadLines(std::string_view bytes) : bytes_(bytes) {
        const auto end = bytes.find_first_of("\r\n");
        lone_cr_ = end != bytes.npos && bytes[end] == '\r' && bytes.substr(end + 1, 1) != "\n";
    }
    bool next(std::string_view& line) {
        const auto end = bytes_.find(lone_cr_ ? '\r' : '\n', at_);
        if (end == bytes_.npos) return false;
        line = bytes_.substr(at_, end - at_);
        at_ = end + 1;
        ++number;
        return true;
    }
    std::size_t read() const { return at_; }
    std::size_t number = 0;

  private:
    std::string_view bytes_;
    bool lone_cr_ = false;
    std::size_t at_ = 0;
};

class HeadReader {
  public:
    HeadReader(std::string_view bytes, const std::string& path) : lines_(bytes), path_(path) {}

    PlyHeader read() {
        PlyHeader head;
        bool has_form = false;
        for (std::string_view line; lines_.next(line);) {
            const auto key = next_word(line);
            if (lines_.number == 1 || key == "comment" || key == "obj_info" || key.empty()) continue;
            if (key == "end_header") {
                if (!has_form) fail("the head says no \"format\"; export the file again");
                head.bytes = lines_.read();
                head.lines = lines_.number;
                return head;
            }
            if (key == "format") {
                head.form = form(line);
                has_form = true;
            } else if (key == "element") {
                head.elements.push_back(element(line, head));
            } else if (key == "property") {
                if (head.elements.empty()) fail("a property without an element; export the file again");
                head.elements.back().properties.push_back(property(line));
            } else {
                fail(in_quotes(key) + " is none of a PLY's head; export the file again");
            }
        }
        ++lines_.number;
        fail("the head has no \"end_header\": the file is cut off; write or fetch it again");
    }

  private:
    [[noreturn]] void fail(const std::string& text) {
        bad(path_ + ":" + std::to_string(lines_.number), text);
    }

    PlyHeader::Form form(std::string_view line) {
        const auto name = next_word(line), version = next_word(line);
        if (version != "1.0")
            fail("version " + in_quotes(version) + " of PLY is not known, 1.0 is; convert it");
        if (name == "ascii") return PlyHeader::Form::text;
        if (name == "binary_little_endian") return PlyHeader::Form::little;
        if (name == "binary_big_endian") return PlyHeader::Form::big;
        fail("format " + in_quotes(name) +
             " is not known; known are ascii, binary_little_endian and binary_big_endian");
    }

    PlyElement element(std::string_view line, const PlyHeader& head) {
        PlyElement element;
        element.name = knurl::words::printable(next_word(line), most_of_a_name);
        const auto word = next_word(line);
        const auto count = integer_of(word);
        if (!count || *count < 0)
            fail(fmt::format("element {} has the count {}; write a whole number", element.name,
                             in_quotes(word)));
        element.count = static_cast<std::uint64_t>(*count);
        for (const PlyElement& other : head.elements)
            if (other.name == element.name)
                fail("element " + element.name + " is there twice; export the file again");
        return element;
    }

    PlyProperty property(std::string_view line) {
        PlyProperty property;
        auto word = next_word(line);
        if (word == "list") {
            property.count = type(next_word(line));
            word = next_word(line);
        }
        property.type = type(word);
        property.name = knurl::words::printable(next_word(line), most_of_a_name);
        if (property.name.empty()) fail("a property without a name; export the file again");
        return property;
    }

    PlyType type(std::string_view word) {
        for (const TypeName& known : type_names)
            if (known.name == word) return known.type;
        fail(in_quotes(word) +
             " is no type of PLY; known are char, uchar, short, ushort, int, uint, float, double");
    }

    HeadLines lines_;
    const std::string& path_;
};

}  // namespace

std::size_t bytes_of(PlyType type) {
    switch (type) {
        case PlyType::i8:
        case PlyType::u8:
            return 1;
        case PlyType::i16:
        case PlyType::u16:
            return 2;
        case PlyType::f64:
            return 8;
        default:
            return 4;
    }
}

std::size_t PlyElement::least_bytes() const {
    std::size_t sum = 0;
    for (const PlyProperty& property : properties) sum += bytes_of(property.count.value_or(property.type));
    return sum;
}

std::size_t PlyElement::property(std::string_view wanted) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].name == wanted) return i;
    return absent;
}

bool is_ply(std::string_view bytes) {
    return bytes.starts_with("ply") && bytes.size() > 3 &&
           std::string_view(" \t\r\n").find(bytes[3]) != bytes.npos;
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& path) {
    return HeadReader(bytes, path).read();
}

}  // namespace knurl::meshfile
