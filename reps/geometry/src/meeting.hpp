#pragma once
// How two pieces meet where they do not as corners and edges.

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>

#include <Eigen/Core>

#include "unite.hpp"

namespace knurl::build {

struct Meeting {
    enum class Kind { none, vertices, vertex_edge, edges, vertex_face, edge_face } kind = Kind::none;
    std::uint32_t a = 0, b = 0, c = 0, d = 0;  // vertices: of the one, then of the other
    int whose = 0;                             // the face: of the one (0) or of the other
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
};

/// Edges that were split at a vertex: vertex, lower end, higher end. Of four points nearly on a line two pairs
/// of slivers may become each other for ever; what was split once stays as it is when it comes again.
using Splits = std::set<std::array<std::uint32_t, 3>>;
inline std::array<std::uint32_t, 3> split_of(std::uint32_t v, std::uint32_t a, std::uint32_t b) {
    return {v, std::min(a, b), std::max(a, b)};
}

inline bool has(const Triangle& t, std::uint32_t v) {
    return t[0] == v || t[1] == v || t[2] == v;
}

/// How two pieces meet where they do not as corners and edges: the simplest way of all.
/// `s_flat` and `t_flat` say which of their edges are flat (a bit each): where the two lie in one plane those
/// may cross, since what is dropped there goes by outlines, and two triangulations of one plane would cut each
/// other without end.
Meeting meet(const Triangle& s, const Eigen::Vector3d (&p)[3], std::uint32_t s_flat, const Triangle& t,
             const Eigen::Vector3d (&q)[3], std::uint32_t t_flat, double touch, const Splits& splits);

}  // namespace knurl::build
