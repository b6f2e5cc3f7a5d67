#pragma once
// Compares the walk with the reference under the same hand, cycle by cycle. Where a hand crosses a ridge, the
// surface may hold it at one of two points. Both are right if no face around them is nearer to the hand
// (Surface::gain); the reference then goes on from the walk's point.

#include <ostream>

#include <exact/god_object.hpp>

#include <knurl/geometry/mesh.hpp>
#include <knurl/geometry/proxy.hpp>

#include "paths.hpp"

namespace knurl::test {

struct Verdict {
    std::uint64_t cycles = 0, touching = 0, reference_touching = 0;
    std::uint64_t other_place = 0;  // cycles in which the walk came to another place that is also right
    std::uint64_t border = 0;       // in which rounding decides about contact, or the proxy rests on a rim
    std::uint64_t capped = 0;       // in which the walk reached its limit of faces before the place
    std::uint64_t wrong = 0;        // with a place at which no face holds, or without a place that must be
    std::uint64_t lost = 0;         // without contact, deeper inside than a thousandth of the size
    std::uint64_t not_finite = 0, over_work = 0, misfit = 0;  // misfit: the foot does not fit itself
    std::uint64_t jumps = 0, reference_jumps = 0;             // of the place from the hand, by size / 200
    std::vector<double> errors;                               // m, where both touch in one place
    double worst_gain = 0;                                    // m
    Work most;
    std::string first_wrong;  // where to look

    double error_at(double share);  // 0.5: the median
    void add(const Verdict&);
};
std::ostream& operator<<(std::ostream& out, Verdict v);

struct Allowed {
    double same = 0;  // m: nearer places are the same place
    // m, of corners. It tilts a face, which moves the foot in proportion to the hand's depth
    double rounding = 0;
};
/// The error that corners in float, or double, permit on a mesh of that size and distance from the origin.
/// Where surfaces cross, the active set stays 5e-7 of the size away from each of up to three planes.
Allowed allowed_of(const exact::Surface& surface, bool exact, bool crossed = false);

/// Judges one hand, with a new proxy and a new reference. `truth`: the surface that should be felt.
Verdict judge(const Mesh& mesh, const exact::Surface& truth, const Hand& hand, const Allowed& allowed);

/// All kinds of hands, `times` of each.
Verdict judge_all(const Mesh& mesh, const exact::Surface& truth, const MadeMesh& shape,
                  const Allowed& allowed, std::uint64_t seed, int times);

std::uint64_t seed();  // KNURL_SEED, or 1
bool long_form();      // KNURL_STROKES=long: minutes instead of seconds
inline Triangles given(const MadeMesh& s) {
    return {.vertices = s.vertices, .triangles = s.triangles, .materials = {}};
}
inline exact::Surface surface_of(const MadeMesh& s) {
    return exact::Surface(s.vertices, s.triangles);
}
inline bool within_limits(const Work& w) {
    return w.faces <= max_walk_faces && w.sweeps <= max_sweeps && w.pieces <= max_pieces * max_sweeps &&
           w.nodes <= max_nodes && w.fans <= max_fans && w.tangles <= max_tangles;
}

}  // namespace knurl::test
