#pragma once

/// @file
/// What touches holds the hand like one. A surface that can be entered and left (polygon, half_plane, box,
/// shape) is entered where the path of the proxy crosses it, not that of the probe: the proxy is the point
/// that satisfies all that holds the probe (the god-object of Zilles and Salisbury, IROS 95; Ruspini,
/// SIGGRAPH 97).
///
/// ~~~{.unparsed}
///      A       seam       B             the proxy slides along A; beyond A's end nothing holds it but what it falls
///    ==x- - - - -x=====.==========      on, and that is B, from the front, though the probe has gone past below
///      '        |     '
///      p0 ------+---> p1                where nothing holds the probe, the proxy is the probe
/// ~~~
///
/// Alone with its surface a probe is its own path: `Stage::free`. Beside others the scene leads the proxy:
///
/// ~~~{.unparsed}
///   answer ──> solve: x ──> look: who is on the way to x? who does not hold it there?
///                │             │ on the way: enter, the first of them; solve again
///                │             │ not held:   leave, solve, look on from there
///                └─────────────┘ neither: the proxy is at x, and a probe with a radius brushes what it overlaps
/// ~~~
///
/// A surface that is not flat (shape) has another plane where the proxy has come to: it says `turned`, and is
/// evaluated and solved again.
///
/// Touching is a gap or a step of `seam_of_size` of the surface's size at most: by so much it reaches
/// sideways where others hold the probe, and a proxy that lies so little behind its face has not gone
/// through.

#include <cstdint>

#include <Eigen/Core>

namespace knurl {

/// Largest gap or step that counts as touching, as a share of a surface's own size (1).
inline constexpr double seam_of_size = 1e-4;
/// The same of a surface that has no size, a half-plane (m of the hand).
inline constexpr double seam_of_hand = 1e-5;

/// Distance up to which surfaces touch, over a gap and a step at once, in such tolerances (1).
inline constexpr double near_in_seams = 1.5;

/// What the scene and its surfaces say to each other while the scene leads the proxy.
struct ProxyPath {
    /// What is wanted of a surface in an evaluation.
    enum class Stage : std::uint8_t {
        /// The probe is its own path.
        free,
        /// Answer as it holds the probe, or does not: nothing is entered, or left other than by coming back.
        answer,
        /// Go back to when the cycle began, then as `answer`.
        rewind,
        /// Look along the path on to `to`: says `when`, `left`.
        look,
        /// Count itself in `close` if `to` is near enough to touch it.
        near,
        /// Be entered where the path of the last look crosses it at `when`.
        enter,
        /// Be left where it does not hold `to`; says `left`. The path goes on from there.
        leave,
        /// Say by how much a probe with a radius at `to` overlaps it: `deepest`.
        overlap,
        /// Hold that probe, though it has not been entered.
        brush,
    };
    /// What is wanted.
    Stage stage = Stage::free;
    /// True: the surface has not been evaluated in this cycle.
    bool first = true;
    /// In `answer`: the surface is not evaluated again in this cycle.
    bool passes = false;
    /// True: another surface holds the probe too.
    bool joined = false;
    /// True: it holds the proxy of a harder layer, so it is not left yet.
    bool holds_harder = false;
    /// True: there are other surfaces, or have been.
    bool beside = false;
    /// In `look`: a surface that is not flat may answer by another plane from now on.
    bool turns = true;
    /// False: `overlap` leaves no trace.
    bool commits = true;
    /// Answer of the surface: it was entered.
    bool entered = false;
    /// Answer of the surface: it was left.
    bool left = false;
    /// Answer to `look`: the surface's plane has changed, so it has to be evaluated and solved again.
    bool turned = false;
    /// Answer of a surface that goes by the probe: it has been entered, and not left.
    bool holds = false;
    /// Answer: nothing held the probe, and it passed, at `graze`, where the surface reaches if it touches
    /// another one.
    bool grazed = false;
    /// Number of surfaces that are near enough to touch the proxy.
    std::uint32_t close = 0;
    /// Share of the way at which the path crosses the surface, 0 to 1; 2: it does not.
    double when = 2;
    /// Deepest overlap (m).
    double deepest = 0;
    /// seam_of_hand in this world (m).
    double hand = 0;
    /// The proxy, from the probe (m).
    Eigen::Vector3d to = Eigen::Vector3d::Zero();
    /// Place of `grazed`, from the probe (m).
    Eigen::Vector3d graze = Eigen::Vector3d::Zero();
    /// Part of this surface in what holds the probe at `to` (m).
    Eigen::Vector3d push = Eigen::Vector3d::Zero();
    /// By how much the probe was held at the path's beginning (m).
    Eigen::Vector3d hold = Eigen::Vector3d::Zero();
};

}  // namespace knurl
