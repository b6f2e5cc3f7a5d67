#pragma once
// What touches holds the hand like one. A surface that can be entered and left (polygon, half_plane, box, shape)
// is entered where the path of the proxy crosses it, not that of the probe: the proxy is the point that satisfies
// all that holds the probe (the god-object of Zilles and Salisbury, IROS 95; Ruspini, SIGGRAPH 97).
//
//      A       seam       B             the proxy slides along A; beyond A's end nothing holds it but what it falls
//    ==x- - - - -x=====.==========      on, and that is B, from the front, though the probe has gone past below
//      '        |     '
//      p0 ------+---> p1                where nothing holds the probe, the proxy is the probe
//
// Alone with its surface a probe is its own path: `Stage::free`. Beside others the scene leads the proxy:
//
//   answer ──> solve: x ──> look: who is on the way to x? who does not hold it there?
//                │             │ on the way: enter, the first of them; solve again
//                │             │ not held:   leave, solve, look on from there
//                └─────────────┘ neither: the proxy is at x, and a probe with a radius brushes what it overlaps
//
// A surface that is not flat (shape) has another plane where the proxy has come to: it says `turned`, and is
// evaluated and solved again.
//
// Touching is a gap or a step of `seam_of_size` of the surface's size at most: by so much it reaches sideways where
// others hold the probe, and a proxy that lies so little behind its face has not gone through.

#include <cstdint>

#include <Eigen/Core>

namespace knurl {

/// Of a surface's own size.
inline constexpr double seam_of_size = 1e-4;
/// Of what has no size: a half-plane (m, of the hand).
inline constexpr double seam_of_hand = 1e-5;

/// So far away it touches, over a gap and a step at once.
inline constexpr double near_in_seams = 1.5;

struct ProxyPath {
    enum class Stage : std::uint8_t {
        free,     // the probe is its own path
        answer,   // as it holds, or does not: nothing is entered or left but by coming back
        rewind,   // as it was when the cycle began, and as `answer`
        look,     // on, to `to`: says `when`, `left`
        near,     // counts in `close`: `to` is near enough to touch it
        enter,    // where the path of the last look crosses it at `when`
        leave,    // where it does not hold `to`; says `left`. From there the path goes on
        overlap,  // says by how much a probe with a radius at `to` overlaps it: `deepest`
        brush,    // holds that, though it has not been entered
    };
    Stage stage = Stage::free;
    bool first = true;    // it has not been evaluated in this cycle
    bool passes = false;  // in `answer`: it is not evaluated again in this cycle
    bool joined = false;  // another surface holds the probe too
    bool beside = false;  // there are other surfaces, or have been
    bool turns = true;    // in `look`: a surface that is not flat may answer by another plane from now on
    bool commits = true;  // else `overlap` leaves no trace
    // What they say.
    bool entered = false, left = false;
    bool turned = false;  // in `look` a surface's plane has changed: it has to be evaluated and solved again
    bool holds = false;   // one that goes by the probe has been entered, and not left
    bool grazed =
        false;  // nothing held the probe, and it passed where one reaches if it touches another: at `graze`
    std::uint32_t close = 0;
    double when = 2;     // 0 ... 1 of the way
    double deepest = 0;  // m
    double hand = 0;     // m: seam_of_hand, in this world
    // m, from the probe: the proxy; and see `grazed`
    Eigen::Vector3d to = Eigen::Vector3d::Zero(), graze = Eigen::Vector3d::Zero();
    Eigen::Vector3d push = Eigen::Vector3d::Zero();  // m: that surface's part of what holds the probe at `to`
    Eigen::Vector3d hold = Eigen::Vector3d::Zero();  // m: by which the probe was held at the path's beginning
};

}  // namespace knurl
