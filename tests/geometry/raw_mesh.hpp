#pragma once
// Meshes as they are given to the builder, and what must hold of whatever it builds.

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
    /// Each triangle with vertices of its own, as STL has them.
    RawMesh unwelded() const;
};

RawMesh raw_sphere(int subdivisions, double radius = 0.1, double bumps = 0);  // 20 x 4^n triangles
RawMesh raw_box(double x = 0.1, double y = 0.1, double z = 0.1);              // 12, one corner in the origin
RawMesh raw_grid(int nx, int ny, double step = 2e-3);  // 2 nx ny, in z = 0 with the front above
RawMesh raw_cone(int sides);  // a fan of so many around the tip and a fan around the foot's middle
RawMesh raw_strip(int quads, bool twisted);  // a ring of them; twisted: a Moebius strip
RawMesh raw_soup(std::mt19937_64& random, int triangles, double length);  // in a cube of 1 m

double between(std::mt19937_64& random, double low, double high);

/// What is wrong with what was built of it; empty: nothing. Found by looking at everything.
std::string wrong(const Mesh& mesh, const RawMesh& raw, const MeshBuild& how = {});

/// Faces of any of these triangles.
std::size_t crossed(const Mesh& mesh);
std::size_t on_rim(const Mesh& mesh);
bool is_crossed(const Mesh& mesh, std::uint32_t triangle);
/// The triangle over the edge between two vertices of a triangle, or -1.
int over(const Mesh& mesh, const RawMesh& raw, std::uint32_t triangle, std::uint32_t a, std::uint32_t b);

}  // namespace knurl::test
