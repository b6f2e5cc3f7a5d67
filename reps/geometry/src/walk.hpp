#pragma once
// The walk goes from a face over its neighbours to the point of the surface nearest to the hand, always
// downhill. It works on any surface that gives a face's corners and the neighbours over its edges
// (mesh_surface.hpp).
//
//   within ──> rests.   edge ──> the face over it.   corner ──> the fan around it: the first that is nearer.
//
// Every step is strictly nearer to the hand, in computed numbers, so no face is met twice.

#include <limits>
#include <numbers>

#include <knurl/geometry/proxy.hpp>

#include "mesh_data.hpp"
#include "triangle_math.hpp"

namespace knurl::detail {

inline constexpr std::uint32_t no_face = 0xffffffff;
inline constexpr double strictly = 1 - 8 * std::numeric_limits<double>::epsilon();

inline constexpr std::uint32_t max_level_steps = 8;

// All lengths are relative to the surface's size.
inline constexpr double hair_of_size = 1e-11;   // a smaller distance is on the surface
inline constexpr double seam_of_size = 1.5e-5;  // faces this close are connected even without a link

/// Where a walk rests.
struct Rest {
    std::uint32_t face = no_face;
    Nearest near;
    bool settled = false;  // false: a limit was reached, and the next cycle continues the walk
    bool outward = false;  // the hand is in front
    bool slipped = false;  // over a rim, beyond which no face continues
    bool crossed = false;  // it came over a face that another one passes through
    bool knotted = false;  // it came over a face at whose vertex faces pass through each other
    std::uint32_t visited[max_walk_faces + 1];
    std::uint32_t visits = 0, level = 0;

    bool has_visited(std::uint32_t f) const noexcept {
        for (std::uint32_t i = 0; i < visits; ++i)
            if (visited[i] == f) return true;
        return false;
    }
};

/// Is y worth a step? Of two convex faces that share x, the point y of the other is nearer to the hand by at
/// least |x - y| in the square. y may be away from x by much more than the distances show, so a few level
/// steps are taken too.
inline bool nearer(const Nearest& y, const Nearest& x, std::uint32_t& level, double size) noexcept {
    if (y.square < x.square * strictly) return true;
    constexpr double moved = 1e-15;
    return y.square <= x.square && (y.point - x.point).squaredNorm() > moved * moved * size * size &&
           level++ < max_level_steps;
}

/// Which of two faces around a corner to continue on. The two sides of a sheet without thickness share the
/// point and the distance, or rounding separates the distances. The side with the hand behind it holds the
/// hand; from the other side the hand would seem free.
inline bool preferred(const Nearest& y, const Nearest& x, std::uint32_t& level, double size) noexcept {
    const bool holds = !(y.height > 0);
    if (holds == !(x.height > 0) || (y.point - x.point).squaredNorm() > std::pow(hair_of_size * size, 2))
        return nearer(y, x, level, size);
    return holds;
}

enum class Fan { closed, open, stopped };

/// Visits the other faces around a face's corner: see(face, pivot, to_after, to_before), with the edges from
/// the pivot, until it returns false.
template <class S, class See>
// NOLINTNEXTLINE(readability-function-cognitive-complexity): in the cycle; a split would write the loop twice
Fan turn(const S& s, std::uint32_t face, std::uint32_t corner, const Vec& v, See&& see) noexcept {
    std::uint32_t seen = 0;
    for (const bool forward : {true, false}) {
        std::uint32_t q = face, pivot = corner;
        Vec shared = s.corner(q, forward ? after(pivot) : before(pivot)) - v;
        for (;;) {
            const Link link = s.over(q, forward ? pivot : before(pivot));
            if (link == no_link) break;
            q = face_of(link);
            if (q == face) return Fan::closed;
            if (++seen > max_fan) return Fan::stopped;
            pivot = forward ? after(edge_of(link)) : edge_of(link);
            const Vec other = s.corner(q, forward ? after(pivot) : before(pivot)) - v;
            if (!(forward ? see(q, pivot, other, shared) : see(q, pivot, shared, other))) return Fan::stopped;
            shared = other;
        }
    }
    return Fan::open;
}

inline double angle_between(const Vec& a, const Vec& b) noexcept {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The angle-weighted normal (Baerentzen and Aanaes 2005), of any length, at a place of a face, over the
/// links.
template <class S>
Vec pseudonormal(const S& s, std::uint32_t face, const Nearest& near) noexcept {
    if (near.place == within) return unit_or_zero(near.normal);
    Vec sum = unit_or_zero(near.normal);
    if (near.place >= 3) {
        const Link link = s.over(face, near.place - 3);
        if (link != no_link) sum += unit_or_zero(s.corners(face_of(link)).normal());
    } else {
        const Corners own = s.corners(face);
        sum = sum * angle_at(own, near.place);
        turn(s, face, near.place, own.at[near.place],
             [&](std::uint32_t, std::uint32_t, const Vec& next, const Vec& previous) {
                 sum += unit_or_zero(next.cross(previous)) * angle_between(next, previous);
                 return true;
             });
    }
    return sum;
}

/// At the edge of a sheet with two sides the normals cancel: a hand nearest to that edge is beyond it.
inline bool is_free(const Vec& d, const Vec& normal) noexcept {
    return d.dot(normal) > 0 || normal.squaredNorm() < 1e-18;
}

/// The angle of a face around a point of it.
inline double angle_around(const Corners& face, const Nearest& near, const Vec& x, double seam) noexcept {
    for (std::uint32_t i = 0; i < 3; ++i)
        if ((face.at[i] - x).squaredNorm() <= seam * seam) return angle_at(face, i);
    if (near.place >= 3 && near.place < within) return std::numbers::pi;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const Vec side = face.side(i);
        if (side.cross(x - face.at[i]).squaredNorm() <= seam * seam * side.squaredNorm())
            return std::numbers::pi;
    }
    return 2 * std::numbers::pi;
}

/// The walk has come to an open edge or corner. The tree may know neighbours that no link names (faces that
/// were not welded, T-junctions). Returns the next face, or no_face: the walk rests.
template <class S>
std::uint32_t over_rim(const S& s, const Vec& h, Rest& rest, Work& work) noexcept {
    const double seam = seam_of_size * s.size();
    const Vec x = rest.near.point, own_normal = unit_or_zero(rest.near.normal);
    std::uint32_t own[max_fan + 1] = {rest.face}, owned = 1;
    if (rest.near.place < 3) {
        turn(s, rest.face, rest.near.place, x, [&](std::uint32_t q, auto...) {
            own[owned++] = q;
            return owned <= max_fan;
        });
    }
    const Vec own_sum = pseudonormal(s, rest.face, rest.near);
    Vec sum = rest.near.place < 3 ? own_sum : own_sum * std::numbers::pi;
    bool others = false;
    std::uint32_t next = no_face;
    Nearest nearest = rest.near;
    const bool all = s.overlapping(low_of(x, x, seam), high_of(x, x, seam), work, [&](std::uint32_t face) {
        for (std::uint32_t i = 0; i < owned; ++i)
            if (own[i] == face) return;
        const Corners corners = s.corners(face);
        const Nearest to_x = nearest_on(corners, x);
        if (!(to_x.square <= seam * seam)) return;
        const Vec normal = unit_or_zero(to_x.normal);
        if (normal.dot(own_normal) < -0.99) return;  // the other side of a thin sheet
        others = true;
        sum += normal * angle_around(corners, to_x, x, seam);
        const Nearest to_h = nearest_on(corners, h);
        if (to_h.square < nearest.square * strictly) nearest = to_h, next = face;
    });
    rest.settled = all;
    if (next != no_face) {
        rest.near = nearest;
        return next;
    }
    const Vec d = h - x;
    rest.outward = is_free(d, sum);
    rest.slipped =
        !others && d.cross(unit_or_zero(own_sum)).squaredNorm() > std::pow(hair_of_size * s.size(), 2);
    return no_face;
}

/// One step. Returns the next face, with rest.near on it; or no_face: the walk rests, and `rest` says how.
template <class S>
// NOLINTNEXTLINE(readability-function-cognitive-complexity): in the cycle; a split would hand on all its state
std::uint32_t step(const S& s, const Vec& h, Rest& rest, Work& work) noexcept {
    Nearest& near = rest.near;
    rest.settled = true;
    bool front = near.height > 0, behind = !front;
    if (near.place == within) {
        rest.outward = front;
        return no_face;
    }
    if (near.place >= 3) {
        const Link link = s.over(rest.face, near.place - 3);
        if (link == no_link) return over_rim(s, h, rest, work);
        const Nearest there = nearest_on(s.corners(face_of(link)), h);
        if (nearer(there, near, rest.level, s.size())) {
            near = there;
            return face_of(link);
        }
        (there.height > 0 ? front : behind) = true;
    } else {
        const Vec v = near.point, d = h - v;
        std::uint32_t next = no_face;
        Nearest nearest = near;  // the nearest of all faces around: the steepest way, whichever face the walk
                                 // comes from
        const auto look = [&](std::uint32_t q, std::uint32_t, const Vec& to, const Vec& from) {
            ++work.fans;
            if (d.dot(to) > 0 || d.dot(from) > 0) {
                const Nearest there = nearest_on(s.corners(q), h);
                if (next == no_face ? nearer(there, near, rest.level, s.size())
                                    : preferred(there, nearest, rest.level, s.size()))
                    nearest = there, next = q;
            }
            (d.dot(to.cross(from)) > 0 ? front : behind) = true;
            return work.fans < max_fans;
        };
        const Fan fan = turn(s, rest.face, near.place, v, look);
        if (next != no_face) {
            near = nearest;
            return next;
        }
        if (fan == Fan::stopped) rest.settled = false;
        if (fan == Fan::open) return over_rim(s, h, rest, work);
    }
    rest.outward = front && (!behind || is_free(h - near.point, pseudonormal(s, rest.face, near)));
    return no_face;
}

/// Starts at rest.face.
template <class S>
void walk(const S& s, const Vec& h, Rest& rest, Work& work) noexcept {
    rest.outward = rest.slipped = rest.crossed = rest.knotted = false;
    rest.visits = rest.level = 0;
    rest.near = nearest_on(s.corners(rest.face), h);
    for (;;) {
        rest.visited[rest.visits++] = rest.face;
        rest.crossed |= (s.flags(rest.face) & face_crossed) != 0;
        rest.knotted |= (s.flags(rest.face) & face_knot) != 0;
        const std::uint32_t next = step(s, h, rest, work);
        if (next == no_face) return;
        rest.face = next;
        if (work.faces >= max_walk_faces) {
            rest.settled = false;
            return;
        }
        ++work.faces;
    }
}

}  // namespace knurl::detail
