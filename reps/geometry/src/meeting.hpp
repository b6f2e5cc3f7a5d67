#pragma once
// How two pieces meet other than in common corners and edges.

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>

#include <Eigen/Core>

#include "unite.hpp"

namespace knurl::build {

struct Meeting {
    enum class Kind { none, vertices, vertex_edge, edges, vertex_face, edge_face } kind = Kind::none;
    std::uint32_t a = 0, b = 0, c = 0, d = 0;  // vertices: of the first piece, then of the second
    int whose = 0;                             // the face: of the first piece (0) or of the second
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
};

/// Edges that were split at a vertex: vertex, lower end, higher end. Of four points nearly on a line, two
/// pairs of slivers may become each other for ever. So an edge that was split once is not split again.
using Splits = std::set<std::array<std::uint32_t, 3>>;
inline std::array<std::uint32_t, 3> split_of(std::uint32_t v, std::uint32_t a, std::uint32_t b) {
    return {v, std::min(a, b), std::max(a, b)};
}

inline bool has(const Triangle& t, std::uint32_t v) {
    return t[0] == v || t[1] == v || t[2] == v;
}

/// The simplest way in which two pieces meet other than in common corners and edges. `s_flat` and `t_flat`
/// say which of their edges are flat (a bit each). Flat edges in one plane may cross: dropped faces follow
/// outlines, and two triangulations of one plane would cut each other without end.
Meeting meet(const Triangle& s, const Eigen::Vector3d (&p)[3], std::uint32_t s_flat, const Triangle& t,
             const Eigen::Vector3d (&q)[3], std::uint32_t t_flat, double touch, const Splits& splits);

}  // namespace knurl::build
