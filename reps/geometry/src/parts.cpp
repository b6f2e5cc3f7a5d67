#include <Eigen/Geometry>

#include <knurl/geometry/parts.hpp>

#include "mesh_data.hpp"

namespace knurl {

namespace {

template <class F>
MeshParts parts_of(std::span<const F> faces, const Eigen::Vector3d& origin) {
    MeshParts found;
    found.triangles.reserve(faces.size());
    std::vector<bool> seen(faces.size());
    std::vector<std::uint32_t> order;  // faces, in the order of `triangles`
    order.reserve(faces.size());
    for (std::uint32_t seed = 0; seed < faces.size(); ++seed) {
        if (seen[seed]) continue;
        seen[seed] = true;
        MeshPart part{.first = static_cast<std::uint32_t>(order.size())};
        order.push_back(seed);
        const auto at = [&](const F& face, int c) {
            return Eigen::Vector3d(face.corner[c][0], face.corner[c][1], face.corner[c][2]);
        };
        const Eigen::Vector3d middle = at(faces[seed], 0);
        Eigen::Vector3d low = middle, high = middle;
        for (std::size_t i = part.first; i < order.size(); ++i) {
            const F& face = faces[order[i]];
            for (int c = 0; c < 3; ++c) {
                low = low.cwiseMin(at(face, c));
                high = high.cwiseMax(at(face, c));
                const Link over = face.over[c];
                if (over == no_link) {
                    part.closed = false;
                } else if (!seen[face_of(over)]) {
                    seen[face_of(over)] = true;
                    order.push_back(face_of(over));
                }
            }
            part.volume += (at(face, 0) - middle).dot((at(face, 1) - middle).cross(at(face, 2) - middle)) / 6;
            found.triangles.push_back(face.triangle);
        }
        part.faces = static_cast<std::uint32_t>(order.size()) - part.first;
        part.low = low + origin;
        part.high = high + origin;
        found.parts.push_back(part);
    }
    return found;
}

}  // namespace

MeshParts parts_of(const Mesh& mesh) {
    const MeshData& data = mesh.data();
    return data.exact ? parts_of<ExactFace>(data.exact_faces, data.origin)
                      : parts_of<Face>(data.faces, data.origin);
}

}  // namespace knurl
