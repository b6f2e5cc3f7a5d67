#include <array>

#include <knurl/geometry/mesh.hpp>

int main() {
    const std::array<knurl::Point3, 3> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const std::array<knurl::Triangle, 1> triangles{{{0, 1, 2}}};
    return knurl::Mesh({corners, triangles}).faces() == 1 ? 0 : 1;
}
