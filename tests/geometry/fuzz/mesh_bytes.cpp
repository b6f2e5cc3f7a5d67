// Any bytes as a mesh, and hands on the built mesh. The builder makes a mesh within its budget, or refuses
// in one line. On a mesh every cycle is within its limits, and the contact is finite and on that mesh. An
// input has the form (8 bytes), then vertices, then triangles; the rest moves the hand.

#include <cmath>
#include <string>
#include <vector>

#include <knurl/geometry/mesh.hpp>

#include "hands.hpp"

using namespace knurl;
using namespace knurl::fuzz;

namespace {

struct Form8 {
    std::uint8_t vertices, triangles, coordinates, flags, weld, budget, hands, unused;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input input({data, size});
    const auto form = input.next<Form8>();
    const unsigned vertex_count = count_of(form.vertices);
    std::vector<Point3> vertices(vertex_count);
    for (Point3& v : vertices) {
        for (double& x : v) x = coordinate(input, form.coordinates & 3);
    }
    std::vector<Triangle> triangles(count_of(form.triangles));
    for (Triangle& t : triangles) {
        for (std::uint32_t& i : t) {
            i = input.next<std::uint8_t>();
            if (form.flags & 4) i %= vertex_count + 1U;  // rarely out of range
        }
    }
    std::vector<std::uint8_t> materials;
    if (form.flags & 8) materials.resize(triangles.size() + (form.flags & 16 ? 1 : 0), 3);
    MeshBuild how{.exact = (form.flags & 1) != 0,
                  .weld = form.weld == 0     ? 0
                          : form.weld == 255 ? std::numeric_limits<double>::quiet_NaN()
                                             : std::pow(0.5, form.weld % 30),
                  .budget = std::size_t{form.budget} << 14,
                  .find_crossings = (form.flags & 2) == 0};
    int asked = 0;
    if (form.flags & 32) how.go_on = [&] { return ++asked < form.hands; };
    try {
        const Mesh mesh({.vertices = vertices, .triangles = triangles, .materials = materials}, how);
        require(mesh.faces() > 0, "a mesh has faces");
        require(mesh.bytes() <= how.budget, "a mesh keeps to its budget");
        require(
            mesh.low.allFinite() && mesh.high.allFinite() && (mesh.low.array() <= mesh.high.array()).all(),
            "a mesh has a box");
        move_about(mesh, input, form.hands & 1 ? 0.01 * (mesh.high - mesh.low).norm() : 0, triangles.size());
    } catch (const MeshError& refused) {
        const std::string why = refused.what();
        require(!why.empty() && why.find('\n') == std::string::npos, "a refusal is one line");
    }
    return 0;
}
