#pragma once
// The god-object by planes (Zilles and Salisbury, IROS 95). It serves where surfaces pass through each other
// and the walk would pass below one of them. The point moves towards the hand until it hits a face, stays in
// front of its plane from then on, and goes to the point nearest to the hand that all those planes allow.

#include <array>
#include <cmath>

#include <knurl/geometry/proxy.hpp>

#include "sweep.hpp"

namespace knurl::detail {

// Of the size: how far the point stays in front of a plane, and how far behind one it is still held. A
// quarter of it lets the point fall through valleys; three times it lets it pass sheets back to back.
inline constexpr double lift_of_size = 5e-7;
inline constexpr double slack_of_lift = 1.25;
inline constexpr double same_of_size = 5e-9;  // a shorter movement counts as none
inline constexpr std::uint32_t max_planes = 5, max_rounds = 16;
static_assert(max_planes * max_rounds == max_tangles);

struct HalfSpace {
    Vec normal;  // unit
    double least;
    std::uint32_t face;
};

struct Held {
    Vec at;                                   // a lift in front of the holding faces; or the point reached so
                                              // far
    Vec foot;                                 // on the surface
    std::uint32_t face = no_face, faces = 0;  // a holding face, and how many hold; none: free
    bool whole = true;                        // false: a limit bit
};

inline bool allow(const std::array<HalfSpace, max_planes>& planes, std::uint32_t count, const Vec& x,
                  double slack) noexcept {
    bool allowed = true;
    for (std::uint32_t i = 0; i < count; ++i)
        allowed = allowed && planes[i].normal.dot(x) >= planes[i].least - slack;
    return allowed;
}

/// The point nearest to h that lies in all of these planes, at most three; false: they are too near parallel.
inline bool project_onto(const HalfSpace* const (&used)[3], std::uint32_t n, const Vec& h, Vec& x) noexcept {
    x = h;
    if (n == 1) {
        x += used[0]->normal * (used[0]->least - used[0]->normal.dot(h));
    } else if (n == 2) {
        const double c = used[0]->normal.dot(used[1]->normal), sine = 1 - c * c;
        if (!(sine > 1e-9)) return false;
        const double a = used[0]->least - used[0]->normal.dot(h), b = used[1]->least - used[1]->normal.dot(h);
        x += used[0]->normal * ((a - c * b) / sine) + used[1]->normal * ((b - c * a) / sine);
    } else if (n == 3) {
        const Vec bc = used[1]->normal.cross(used[2]->normal), ca = used[2]->normal.cross(used[0]->normal),
                  ab = used[0]->normal.cross(used[1]->normal);
        const double volume = used[0]->normal.dot(bc);
        if (!(std::abs(volume) > 1e-9)) return false;
        x = (bc * used[0]->least + ca * used[1]->least + ab * used[2]->least) * (1 / volume);
    }
    return true;
}

/// The point nearest to h that satisfies all planes, found by trying sets of at most three active planes. False:
/// none does.
inline bool project(const std::array<HalfSpace, max_planes>& planes, std::uint32_t count, const Vec& h,
                    double slack, Vec& goal, std::uint32_t& holding) noexcept {
    double nearest = HUGE_VAL;
    for (std::uint32_t set = 0; set < (1u << count); ++set) {
        const HalfSpace* used[3];
        std::uint32_t n = 0;
        for (std::uint32_t i = 0; i < count && n <= 3; ++i)
            if ((set >> i & 1) != 0) {
                if (n < 3) used[n] = &planes[i];
                ++n;
            }
        if (n > 3) continue;
        Vec x;
        if (!project_onto(used, n, h, x)) continue;
        const double square = (x - h).squaredNorm();
        if (!(square < nearest)) continue;
        if (!allow(planes, count, x, slack)) continue;
        nearest = square, goal = x, holding = set;
    }
    return nearest < HUGE_VAL;
}

inline bool is_among(const std::array<HalfSpace, max_planes>& planes, std::uint32_t count,
                     std::uint32_t face) noexcept {
    for (std::uint32_t i = 0; i < count; ++i)
        if (planes[i].face == face) return true;
    return false;
}

/// Which of the planes hold it at p, a bit each in `holding`, and its foot on the faces. The planes become those of
/// the faces themselves.
inline void note_holders(std::array<HalfSpace, max_planes>& planes, std::uint32_t count,
                         std::uint32_t holding, const Vec& p, const Vec& h, double lift,
                         Held& held) noexcept {
    held.faces = 0;
    for (std::uint32_t i = 0; i < count; ++i)
        if ((holding >> i & 1) != 0) held.face = planes[i].face, ++held.faces;
    if (count > 0 && held.faces == 0) held.face = planes[0].face, held.faces = count;  // on its way yet
    held.foot = p;
    for (std::uint32_t i = 0; i < count; ++i) planes[i].least -= lift;
    Vec on;
    if (held.faces > 0 && project(planes, count, h, 0.01 * lift, on, holding) &&
        (on - p).squaredNorm() < 100 * lift * lift)
        held.foot = on;
}

/// Starts at p, which is in front of all faces.
template <class S>
[[gnu::noinline]] Held hold(const S& s, Vec p, const Vec& h, Work& work) noexcept {
    const double lift = lift_of_size * s.size(), same = same_of_size * s.size();
    Work mine;
    mine.nodes = work.nodes;
    Held held;
    for (std::uint32_t round = 0; round < max_rounds && held.whole; ++round) {
        std::array<HalfSpace, max_planes> planes;
        std::uint32_t count = 0, holding = 0;
        const Vec start = p;
        Vec goal = h;
        bool there = false;
        while (!there && count < max_planes) {
            const Hit hit = sweep(
                s, p, goal, slack_of_lift * lift, mine,
                [&](std::uint32_t face, const Corners&, double) { return !is_among(planes, count, face); });
            p = hit.point;
            held.whole = hit.whole;
            there = hit.face == no_face;
            if (there) break;
            const Corners corners = s.corners(hit.face);
            const Vec normal = unit_or_zero(corners.normal());
            HalfSpace& plane = planes[count++];
            plane = {normal, normal.dot(corners.at[0]) + lift, hit.face};
            p += normal * std::max(0.0, plane.least - normal.dot(p));
            if (!project(planes, count, h, 0.01 * lift, goal, holding)) goal = p;
        }
        note_holders(planes, count, holding, p, h, lift, held);
        if (count == 0 || (p - start).squaredNorm() < same * same) break;
    }
    work.nodes = mine.nodes;
    work.tangles += mine.sweeps;
    held.at = p;
    return held;
}

}  // namespace knurl::detail
