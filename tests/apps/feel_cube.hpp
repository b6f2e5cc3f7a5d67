#pragma once
// A cube, 2 wide, in every form of mesh file.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>

#include <knurl/meshfile/mesh_file.hpp>

namespace knurl::test::cube_files {

using knurl::meshfile::MeshFile;

// Corner c of the cube lies at (c & 1, c >> 1 & 1, c >> 2) * 2 - 1.
inline constexpr int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
// The first corner is given twice, so that the first triangle, which faces inwards, has no area.
inline constexpr int strip[15] = {2, 2, 3, 6, 7, 5, 3, 1, 2, 0, 6, 4, 5, 0, 1};

inline double place(int corner, int axis) {
    return (corner >> axis & 1) * 2 - 1;
}

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

inline std::string obj_vertices() {
    std::ostringstream out;
    for (int c = 0; c < 8; ++c)
        out << "v " << place(c, 0) << ' ' << place(c, 1) << ' ' << place(c, 2) << '\n';
    return out.str();
}
/// `corner` with its number, from 1, for every #.
inline std::string obj_faces(const std::string& corner = "#", int count_from = 1) {
    std::ostringstream out;
    for (const auto& quad : quads) {
        out << "f";
        for (const int c : quad) out << ' ' << replaced(corner, "#", std::to_string(c + count_from));
        out << '\n';
    }
    return out.str();
}
inline std::string obj() {
    return obj_vertices() + obj_faces();
}

inline std::string stl_text() {
    std::ostringstream out;
    out << "solid a cube of ours\n";
    for (const auto& quad : quads)
        for (int half = 0; half < 2; ++half) {
            out << "  facet normal 0 0 0\n    outer loop\n";
            for (const int c : {quad[0], quad[1 + half], quad[2 + half]})
                out << "      vertex " << place(c, 0) << ' ' << place(c, 1) << ' ' << place(c, 2) << '\n';
            out << "    endloop\n  endfacet\n";
        }
    out << "endsolid a cube of ours\n";
    return out.str();
}

template <class T>
void put(std::string& out, T value, bool big = false) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof value);
    if (big) std::reverse(bytes, bytes + sizeof value);
    out.append(bytes, sizeof value);
}

inline std::string stl_binary(std::uint32_t count = 12, const std::string& title = "") {
    std::string out = title;
    out.resize(80, ' ');
    put(out, count);
    for (const auto& quad : quads)
        for (int half = 0; half < 2; ++half) {
            for (int k = 0; k < 3; ++k) put(out, 0.0f);
            for (const int c : {quad[0], quad[1 + half], quad[2 + half]})
                for (int k = 0; k < 3; ++k) put(out, static_cast<float>(place(c, k)));
            put(out, std::uint16_t{0});
        }
    return out;
}

inline const std::string ply_text_head =
    "ply\nformat ascii 1.0\ncomment by hand\nobj_info nothing\nelement vertex 8\nproperty float x\n"
    "property float y\nproperty float z\n";
inline const std::string ply_faces_head =
    "element face 6\nproperty list uchar int vertex_indices\nend_header\n";

inline std::string ply_vertices() {
    return replaced(obj_vertices(), "v ", "");
}
inline std::string ply_faces() {
    return replaced(obj_faces("#", 0), "f ", "4 ");
}
inline std::string ply_text() {
    return ply_text_head + ply_faces_head + ply_vertices() + ply_faces();
}

template <class Real, class Index>
inline std::string ply_binary(bool big, const std::string& real, const std::string& index,
                              const std::string& line_end) {
    std::string out =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement vertex 8\nproperty " + real + " x\nproperty " + real + " y\nproperty " + real +
        " z\nproperty uchar red\nelement face 6\nproperty uchar flags\nproperty list uchar " + index +
        " vertex_indices\nelement extra 2\nproperty list ushort double more\nend_header\n";
    out = replaced(out, "\n", line_end);
    for (int c = 0; c < 8; ++c) {
        for (int k = 0; k < 3; ++k) put(out, static_cast<Real>(place(c, k)), big);
        put(out, std::uint8_t{10});
    }
    for (const auto& quad : quads) {
        put(out, std::uint8_t{7});
        put(out, std::uint8_t{4});
        for (const int c : quad) put(out, static_cast<Index>(c), big);
    }
    put(out, std::uint16_t{0}, big);
    put(out, std::uint16_t{1}, big);
    put(out, 1.0, big);
    return out;
}

/// The first byte after the header is 0x0a, which ends a line in text.
inline std::string ply_from_0x0a() {
    std::string out =
        "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty short x\nproperty short "
        "y\nproperty "
        "short z\nelement face 6\nproperty list uchar uchar vertex_index\nend_header\n";
    for (int c = 0; c < 8; ++c)
        for (int k = 0; k < 3; ++k) put(out, static_cast<std::int16_t>(place(c, k) + 11));  // 0x0a and 0x0c
    for (const auto& quad : quads) {
        put(out, std::uint8_t{4});
        for (const int c : quad) put(out, static_cast<std::uint8_t>(c));
    }
    return out;
}

inline std::string ply_strip(const std::string& entries, const std::string& type = "int") {
    return ply_text_head + "element tristrips 1\nproperty list int " + type +
           " vertex_indices\nend_header\n" + ply_vertices() + entries + "\n";
}
inline std::string one_strip() {
    std::string out = "15";
    for (const int c : strip) out += " " + std::to_string(c);
    return out;
}
/// Each side is a strip of its own.
inline std::string six_strips(const std::string& between = "-1") {
    std::string out = "29";
    for (int i = 0; i < 6; ++i) {
        const auto& q = quads[i];
        if (i > 0) out += " " + between;
        for (const int c : {q[0], q[1], q[3], q[2]}) out += " " + std::to_string(c);
    }
    return out;
}

inline double volume(const MeshFile& file) {
    double six = 0;
    for (const knurl::Triangle& t : file.triangles) {
        const auto &a = file.vertices[t[0]], &b = file.vertices[t[1]], &c = file.vertices[t[2]];
        six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return six / 6;
}

}  // namespace knurl::test::cube_files
