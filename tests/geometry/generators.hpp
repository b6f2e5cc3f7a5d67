#pragma once
// Generated meshes, which need no licence, and whose exact surface is known. In metres, about 0.2 m large
// unless stated otherwise; counter-clockwise as seen from outside.

#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <exact/real.hpp>

namespace knurl::test {

using Rng = std::mt19937_64;
/// The same on every machine, which the library's distributions do not guarantee.
inline double between(Rng& rng, double low, double high) {
    return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
}
inline std::size_t below(Rng& rng, std::size_t count) {
    return static_cast<std::size_t>(rng() % count);
}

struct MadeMesh {
    std::string name;
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;

    std::uint32_t add(const exact::V& v) {
        vertices.push_back({static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)});
        return static_cast<std::uint32_t>(vertices.size() - 1);
    }
    exact::V at(std::uint32_t vertex) const {
        return {vertices[vertex][0], vertices[vertex][1], vertices[vertex][2]};
    }
    exact::V corner(std::size_t triangle, std::size_t i) const { return at(triangles[triangle][i]); }
    void append(const MadeMesh& other);
    double size() const;  // m, its box's diagonal
};

// Closed.
MadeMesh icosphere(int subdivisions, double radius = 0.1);  // 20 x 4^n triangles
MadeMesh torus(int around, int across, double ring = 0.07, double tube = 0.03);
/// An icosphere with bumps of many sizes, up to `height` of its radius.
MadeMesh noisy_sphere(int subdivisions, double height, std::uint64_t seed, double radius = 0.1);
MadeMesh hollow_sphere(int subdivisions);  // a wall of 5 mm
/// A solid of blocks between the given coordinates, without the walls between two of them.
using Filled = std::function<bool(int i, int j, int k)>;
MadeMesh blocks(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z,
                const Filled& filled);
MadeMesh cube(int divisions, double side = 0.1);
MadeMesh staircase();
MadeMesh comb();        // teeth of 0.5 mm, 2 mm apart, 20 mm deep
MadeMesh thin_plate();  // 0.1 mm
MadeMesh needle_box();  // of triangles of 10 mm by 10 um

// Open; in z = 0, front above, the middle in the origin.
MadeMesh grid(int nx, int ny, double dx, double dy);
MadeMesh plane_grid();  // 4 cm of 2 mm triangles
MadeMesh needles();     // 10 mm by 10 um

// Non-manifold meshes.
MadeMesh crossing_sheets();  // a floor, and through it a wall (x = 0, front to +x); they share no vertex
MadeMesh two_sided_sheet();  // the same vertices, every triangle twice, one of them turned
MadeMesh three_sheets();     // at one edge
MadeMesh cubes_at_an_edge();
MadeMesh cubes_at_a_corner();  // a bow tie
MadeMesh moebius();

/// Closed manifolds without any fault.
std::vector<MadeMesh> clean_shapes(std::uint64_t seed);

}  // namespace knurl::test
