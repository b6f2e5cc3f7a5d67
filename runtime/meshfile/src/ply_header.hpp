#pragma once
// The head of a PLY file: which elements follow, and what each consists of.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace knurl::meshfile {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };
std::size_t bytes_of(PlyType type);

struct PlyProperty {
    std::string name;
    std::optional<PlyType> count;  // of a list
    PlyType type = PlyType::f32;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// The least size of one in a binary file: for a list, its count.
    std::size_t least_bytes() const;
    /// Its index; `absent`: no property has that name.
    std::size_t property(std::string_view wanted) const;
    static constexpr std::size_t absent = std::string_view::npos;
};

struct PlyHeader {
    enum class Form { text, little, big };
    Form form = Form::text;
    std::vector<PlyElement> elements;
    std::size_t bytes = 0, lines = 0;  // of the head
};

/// Throws std::runtime_error with path and line.
PlyHeader read_ply_header(std::string_view bytes, const std::string& path);

}  // namespace knurl::meshfile
