#pragma once
// Meshes as they are given to the builder, and checks of the built result.

#include <random>
#include <string>
#include <vector>

#include <knurl/geometry/mesh.hpp>

namespace knurl::test {

struct RawMesh {
    std::vector<Point3> vertices;
    std::vector<Triangle> triangles;
    std::vector<std::uint8_t> materials = {};

    Triangles given() const { return {vertices, triangles, materials}; }
    void add(const RawMesh& other);
    void move(const Point3& by);
    void scale(double by);
    void turn_over(std::size_t triangle) { std::swap(triangles[triangle][1], triangles[triangle][2]); }
    /// Each triangle has vertices of its own, as in an STL file.
    RawMesh unwelded() const;
};

RawMesh raw_sphere(int subdivisions, double radius = 0.1, double bumps = 0);  // 20 x 4^n triangles
RawMesh raw_box(double x = 0.1, double y = 0.1, double z = 0.1);              // 12, one corner in the origin
RawMesh raw_grid(int nx, int ny, double step = 2e-3);  // 2 nx ny, in z = 0 with the front above
RawMesh raw_cone(int sides);  // a fan of that many triangles around the tip, and one around the base's centre
RawMesh raw_strip(int quads, bool twisted);  // a ring of them; twisted: a Moebius strip
RawMesh raw_soup(std::mt19937_64& random, int triangles, double length);  // in a cube of 1 m

double between(std::mt19937_64& random, double low, double high);

/// Checks everything that was built of `raw`, and returns the first fault; empty: there is none.
std::string wrong(const Mesh& mesh, const RawMesh& raw, const MeshBuild& how = {});

/// The number of faces with that flag.
std::size_t crossed(const Mesh& mesh);
std::size_t on_rim(const Mesh& mesh);
bool is_crossed(const Mesh& mesh, std::uint32_t triangle);
/// The triangle over the edge between two vertices of a triangle, or -1.
int over(const Mesh& mesh, const RawMesh& raw, std::uint32_t triangle, std::uint32_t a, std::uint32_t b);

}  // namespace knurl::test
