// Finds closed parts that are wound inside out, and which part lies in which.

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <knurl/geometry/parts.hpp>
#include <knurl/meshfile/mesh_file.hpp>

namespace knurl::meshfile {

namespace {

using Eigen::Vector3d;
using knurl::MeshPart;

class Nest {
  public:
    Nest(const MeshFile& file, const knurl::MeshParts& found) : file_(file), found_(found) {}

    /// Does `inner` lie in the closed `outer`? Tests one corner: parts that cross each other lie in none.
    bool lies_in(const MeshPart& inner, const MeshPart& outer) {
        if (!outer.closed || &inner == &outer) return false;
        if ((inner.low.array() < outer.low.array()).any() || (inner.high.array() > outer.high.array()).any())
            return false;
        // The solid angle of the outer part, seen from that corner.
        const Vector3d from = corner(found_.triangles[inner.first], 0);
        double angle = 0;
        for (std::uint32_t i = 0; i < outer.faces; ++i) {
            if (++work_ > most_work) return true;  // then nothing is turned
            const std::uint32_t triangle = found_.triangles[outer.first + i];
            const Vector3d a = corner(triangle, 0) - from, b = corner(triangle, 1) - from,
                           c = corner(triangle, 2) - from;
            const double la = a.norm(), lb = b.norm(), lc = c.norm();
            angle += 2 * std::atan2(a.dot(b.cross(c)),
                                    la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
        }
        return std::abs(angle) > 2 * M_PI;
    }

  private:
    Vector3d corner(std::uint32_t triangle, std::size_t k) const {
        return Vector3d(file_.vertices[file_.triangles[triangle][k]].data());
    }

    const MeshFile& file_;
    const knurl::MeshParts& found_;
    static constexpr std::uint64_t most_work = 50'000'000;  // triangles, some seconds
    std::uint64_t work_ = 0;
};

}  // namespace

std::size_t turn_inside_out(MeshFile& file, const knurl::Mesh& mesh) {
    const knurl::MeshParts found = knurl::parts_of(mesh);
    Nest nest(file, found);
    std::vector<const MeshPart*> turned;
    std::size_t outermost = 0;
    for (const MeshPart& part : found.parts) {
        if (!part.closed || !(part.volume < 0)) continue;
        const auto holds = [&](const MeshPart& other) { return nest.lies_in(part, other); };
        if (std::any_of(found.parts.begin(), found.parts.end(), holds)) continue;
        ++outermost;
        for (const MeshPart& other : found.parts)
            if (&other == &part || nest.lies_in(other, part)) turned.push_back(&other);
    }
    for (const MeshPart* part : turned)
        for (std::uint32_t i = 0; i < part->faces; ++i) {
            knurl::Triangle& corners = file.triangles[found.triangles[part->first + i]];
            std::swap(corners[1], corners[2]);
        }
    return outermost;
}

}  // namespace knurl::meshfile
