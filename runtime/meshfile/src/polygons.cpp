#include <algorithm>
#include <cmath>
#include <numeric>

#include <knurl/meshfile/polygons.hpp>

namespace knurl::meshfile {

namespace {

using knurl::Point3;

constexpr double flat = 1e-12;       // of the extent's square: no area
constexpr double thin_share = 1e-7;  // of the extent's square: thinner ones have no effect

Point3 minus(const Point3& a, const Point3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point3 cross(const Point3& a, const Point3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point3& a, const Point3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double length(const Point3& a) {
    return std::sqrt(dot(a, a));
}

/// Twice the area of a triangle; positive if it goes around to the left. In long double, so that three
/// corners on a line give 0: products of differences of decimal coordinates are nearly exact in it.
template <class C>
double turn(const C& a, const C& b, const C& c) {
    using Real = long double;
    return static_cast<double>((Real{b.x} - a.x) * (Real{c.y} - a.y) - (Real{b.y} - a.y) * (Real{c.x} - a.x));
}

/// Removes repeated corners, and paths that go forth and back.
void simplify(std::span<const Point3> vertices, std::vector<std::uint32_t>& ring) {
    const auto same = [&](std::uint32_t a, std::uint32_t b) { return a == b || vertices[a] == vertices[b]; };
    std::vector<std::uint32_t> kept;
    for (const std::uint32_t v : ring) {
        kept.push_back(v);
        for (std::size_t n; (n = kept.size()) > 1;) {
            if (same(kept[n - 1], kept[n - 2])) {
                kept.pop_back();
            } else if (n > 2 && same(kept[n - 1], kept[n - 3])) {
                kept.resize(n - 2);
            } else {
                break;
            }
        }
    }
    std::size_t first = 0, last = kept.size();  // across the end of the list
    while (last - first > 2) {
        if (same(kept[last - 1], kept[first])) {
            --last;
        } else if (same(kept[last - 2], kept[first])) {
            last -= 2;
        } else if (same(kept[last - 1], kept[first + 1])) {
            ++first, --last;
        } else {
            break;
        }
    }
    ring.assign(kept.begin() + static_cast<std::ptrdiff_t>(first),
                kept.begin() + static_cast<std::ptrdiff_t>(last));
}

bool all_finite(std::span<const Point3> vertices, std::span<const std::uint32_t> ring) {
    for (const std::uint32_t v : ring)
        for (const double x : vertices[v])
            if (!std::isfinite(x)) return false;
    return true;
}

/// Are points, relative to the first of them, on one line?
bool all_on_a_line(std::span<const Point3> points, double extent) {
    const auto far = std::max_element(points.begin(), points.end(),
                                      [](const Point3& a, const Point3& b) { return length(a) < length(b); });
    for (const Point3& p : points)
        if (length(cross(*far, p)) > 1e-6 * extent * extent) return false;
    return true;
}

}  // namespace

Cutter::Shape Cutter::cut(std::span<const Point3> vertices, std::span<const std::uint32_t> polygon,
                          std::vector<knurl::Triangle>& out) {
    bent_ = 0;
    ring_.assign(polygon.begin(), polygon.end());
    // The builder leaves out and counts corners that are not finite.
    if (ring_.size() == 3 || !all_finite(vertices, ring_)) return fan(out);
    simplify(vertices, ring_);
    if (ring_.size() < 3) return Shape::nothing;
    if (ring_.size() == 3) return fan(out);

    measure(vertices);
    const double area = length(normal_);
    if (!std::isfinite(area) || !std::isfinite(extent_ * extent_)) return fan(out);
    if (!(area > flat * extent_ * extent_))
        return all_on_a_line(at_, extent_) ? Shape::nothing : Shape::crossed;
    for (const Point3& p : at_) bent_ = std::max(bent_, std::abs(dot(p, normal_)) / area / extent_);

    // Seen along an axis the coordinates stay exact, but a bent polygon may cross itself in that view.
    const std::size_t before = out.size();
    for (int way = 0; way < 2; ++way) {
        project(at_, way);
        if (is_convex()) return fan(out);
        if (!crosses_itself() && clip(out)) return Shape::concave;
        out.resize(before);
        if (work_ > most_work) return Shape::too_large;
    }
    return Shape::crossed;
}

Cutter::Shape Cutter::fan(std::vector<knurl::Triangle>& out) const {
    for (std::size_t i = 2; i < ring_.size(); ++i) out.push_back({ring_[0], ring_[i - 1], ring_[i]});
    return Shape::convex;
}

/// Fills at_, normal_ and extent_ from the ring.
void Cutter::measure(std::span<const Point3> vertices) {
    at_.clear();
    normal_ = {};
    extent_ = 0;
    for (const std::uint32_t v : ring_) {
        at_.push_back(minus(vertices[v], vertices[ring_[0]]));
        extent_ = std::max(extent_, length(at_.back()));
        if (at_.size() < 2) continue;
        const Point3 part = cross(at_[at_.size() - 2], at_.back());
        for (std::size_t k = 0; k < 3; ++k) normal_[k] += part[k];
    }
}

void Cutter::project(std::span<const Point3> at, int way) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (std::abs(normal_[k]) > std::abs(normal_[axis])) axis = k;
    Point3 u{}, v{};
    if (way == 0) {
        u[(axis + 1) % 3] = 1;
        v[(axis + 2) % 3] = normal_[axis] > 0 ? 1 : -1;
    } else {
        Point3 across{};
        across[(axis + 1) % 3] = 1;
        v = cross(normal_, across);
        u = cross(v, normal_);
        for (Point3* each : {&u, &v}) {
            const double of = length(*each);
            for (double& x : *each) x /= of;
        }
    }
    corners_.clear();
    const auto n = static_cast<std::uint32_t>(at.size());
    for (std::uint32_t i = 0; i < n; ++i)
        corners_.push_back({.vertex = ring_[i],
                            .x = dot(at[i], u),
                            .y = dot(at[i], v),
                            .before = (i + n - 1) % n,
                            .after = (i + 1) % n,
                            .reflex = false,
                            .gone = false});
}

/// Does it turn left at every corner, and go around once? A corner on an edge makes it not convex: a fan
/// might have a triangle without an area there, and the neighbour's edge no partner.
bool Cutter::is_convex() const {
    int changes = 0;
    bool right = false, known = false;
    for (const Corner& c : corners_) {
        const Corner& next = corners_[c.after];
        if (!(turn(corners_[c.before], c, next) > 0)) return false;
        if (next.x == c.x) continue;
        changes += known && right != (next.x > c.x);
        right = next.x > c.x;
        known = true;
    }
    return changes <= 2;
}

/// Do two edges pass through each other?
bool Cutter::crosses_itself() {
    const double nothing = 1e-10 * extent_ * extent_;
    const auto low = [&](std::uint32_t i) { return std::min(corners_[i].x, corners_[corners_[i].after].x); };
    const auto high = [&](std::uint32_t i) { return std::max(corners_[i].x, corners_[corners_[i].after].x); };
    by_x_.resize(corners_.size());
    std::iota(by_x_.begin(), by_x_.end(), 0u);
    std::sort(by_x_.begin(), by_x_.end(), [&](std::uint32_t i, std::uint32_t j) { return low(i) < low(j); });
    const auto apart = [&](const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
        const double left = turn(a, b, c), right = turn(a, b, d);
        return (left > nothing && right < -nothing) || (left < -nothing && right > nothing);
    };
    for (auto i = by_x_.begin(); i != by_x_.end(); ++i)
        for (auto j = i + 1; j != by_x_.end() && low(*j) <= high(*i); ++j) {
            if (++work_ > most_work) return false;
            const Corner &a = corners_[*i], &b = corners_[a.after], &c = corners_[*j], &d = corners_[c.after];
            if (std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y)) continue;
            if (apart(a, b, c, d) && apart(c, d, a, b)) return true;
        }
    return false;
}

/// Is a reflex corner in the triangle or on its edge? A corner at the place of one of its corners counts if
/// its edges lead into the triangle.
bool Cutter::blocks(std::uint32_t point, const Corner& a, const Corner& b, const Corner& c) const {
    const Corner& p = corners_[point];
    if (turn(a, b, p) < 0 || turn(b, c, p) < 0 || turn(c, a, p) < 0) return false;
    const Corner* around[] = {&a, &b, &c};
    for (int k = 0; k < 3; ++k) {
        const Corner &here = *around[k], &left = *around[(k + 1) % 3], &right = *around[(k + 2) % 3];
        if (p.x != here.x || p.y != here.y) continue;
        for (const std::uint32_t neighbour : {p.before, p.after}) {
            const Corner& q = corners_[neighbour];
            if (turn(here, left, q) > 0 && turn(here, right, q) < 0) return true;
        }
        return false;
    }
    return true;
}

bool Cutter::is_ear(std::uint32_t corner) {
    const Corner& b = corners_[corner];
    const Corner &a = corners_[b.before], &c = corners_[b.after];
    if (!(turn(a, b, c) > 0)) return false;
    const double low = std::min({a.x, b.x, c.x}), high = std::max({a.x, b.x, c.x});
    const auto begin = std::lower_bound(by_x_.begin(), by_x_.end(), low,
                                        [&](std::uint32_t i, double x) { return corners_[i].x < x; });
    for (auto i = begin; i != by_x_.end() && corners_[*i].x <= high; ++i) {
        ++work_;
        if (!corners_[*i].reflex || *i == b.before || *i == b.after) continue;
        if (blocks(*i, a, b, c)) return false;
    }
    return true;
}

void Cutter::take_out(std::uint32_t corner) {
    Corner& b = corners_[corner];
    b.gone = true;
    b.reflex = false;
    corners_[b.before].after = b.after;
    corners_[b.after].before = b.before;
    for (const std::uint32_t i : {b.before, b.after}) {
        Corner& c = corners_[i];
        c.reflex = !(turn(corners_[c.before], c, corners_[c.after]) > 0);
    }
}

bool Cutter::clip(std::vector<knurl::Triangle>& out) {
    if (work_ > most_work) return false;
    by_x_.clear();
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
        Corner& c = corners_[i];
        c.reflex = !(turn(corners_[c.before], c, corners_[c.after]) > 0);
        if (c.reflex) by_x_.push_back(i);
    }
    std::sort(by_x_.begin(), by_x_.end(),
              [&](std::uint32_t i, std::uint32_t j) { return corners_[i].x < corners_[j].x; });
    const double nothing = thin_share * extent_ * extent_;
    std::uint32_t at = 0;
    std::size_t left = corners_.size(), tried = 0;
    const auto emit = [&](const Corner& b) {
        out.push_back({corners_[b.before].vertex, b.vertex, corners_[b.after].vertex});
    };
    while (left > 3) {
        const Corner& b = corners_[at];
        // Cuts an ear or, if none is left, a sliver that rounding has bent the wrong way.
        const bool sliver = tried >= left;
        const double area = turn(corners_[b.before], b, corners_[b.after]);
        if (sliver ? std::abs(area) <= nothing : is_ear(at)) {
            if (area != 0) emit(b);
            const std::uint32_t next = corners_[b.after].after;
            take_out(at);
            --left;
            tried = 0;
            at = next;  // not the same corner again, which would give ever slimmer triangles
            continue;
        }
        at = b.after;
        if (++work_ > most_work || ++tried >= 2 * left) return false;
    }
    while (corners_[at].gone) at = corners_[at].after;
    const double last = turn(corners_[corners_[at].before], corners_[at], corners_[corners_[at].after]);
    if (last < -nothing) return false;
    if (last != 0) emit(corners_[at]);
    return true;
}

}  // namespace knurl::meshfile
