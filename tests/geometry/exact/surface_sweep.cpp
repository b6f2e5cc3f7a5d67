// Segments against faces: against those in the cells of a grid, or against all.

#include <algorithm>

#include "surface.hpp"

namespace exact {

namespace {

constexpr Real edge_slack = 1e-15L;  // of a face's size: its edges belong to both of their faces

}  // namespace

void Surface::meet(int face, const V& a, const V& b, Real behind, const V* but, Crossing& first) const {
    const V& n = normal_[face];
    const V d = b - a;
    const Real down = dot(n, d);
    if (!(down < 0)) return;
    const Real height = dot(n, a - corner(face, 0));
    const Real t = -height / down;
    if (height < -behind || t > 1 || t >= first.t) return;
    const V at = a + t * d;
    for (int i = 0; i < 3; ++i) {
        const V edge = corner(face, (i + 1) % 3) - corner(face, i);
        if (dot(cross(n, edge), at - corner(face, i)) < -edge_slack * size_ * length(edge)) return;
    }
    if (but != nullptr && distance(nearest(face, *but).point, *but) <= 1e-13L * size_) return;
    first = {face, t};
}

Crossing Surface::sweep_all(const V& a, const V& b, Real behind, const V* but) const {
    Crossing first;
    for (int f = 0; f < static_cast<int>(face_.size()); ++f) meet(f, a, b, behind, but, first);
    return first;
}

void Surface::fill_grid() {
    const V across = high_ - low_;
    Real mean = 0;
    for (int f = 0; f < static_cast<int>(face_.size()); ++f) mean += distance(corner(f, 0), corner(f, 1));
    mean /= static_cast<Real>(face_.size());
    const Real widest = std::max({across.x, across.y, across.z});
    cell_ = std::max(mean * 1.5L, widest / 150);
    for (int i = 0; i < 3; ++i) {
        const Real wide = i == 0 ? across.x : i == 1 ? across.y : across.z;
        cells_[i] = 1 + static_cast<int>(wide / cell_);
    }
    begin_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2] + 1, 0);
    const auto each_cell = [&](auto&& visit) {
        for (int f = 0; f < static_cast<int>(face_.size()); ++f) {
            V low = corner(f, 0), high = low;
            for (int i = 1; i < 3; ++i) {
                const V& c = corner(f, i);
                low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
                high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
            }
            cells(low, high, [&](std::size_t cell) { visit(cell, static_cast<std::uint32_t>(f)); });
        }
    };
    each_cell([&](std::size_t cell, std::uint32_t) { ++begin_[cell + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    in_cell_.resize(begin_.back());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    each_cell([&](std::size_t cell, std::uint32_t f) { in_cell_[next[cell]++] = f; });
}

/// Calls `each` for every cell that a box touches; the box is enlarged by rounding.
template <class Do>
void Surface::cells(const V& low, const V& high, Do&& each) const {
    const Real slack = 1e-9L * size_;
    const auto place = [&](Real x, Real from, int i) {
        return static_cast<int>(std::clamp<Real>(std::floor((x - from) / cell_), 0, cells_[i] - 1));
    };
    if (high.x < low_.x - slack || high.y < low_.y - slack || high.z < low_.z - slack ||
        low.x > high_.x + slack || low.y > high_.y + slack || low.z > high_.z + slack) {
        return;
    }
    const int x0 = place(low.x - slack, low_.x, 0), x1 = place(high.x + slack, low_.x, 0);
    const int y0 = place(low.y - slack, low_.y, 1), y1 = place(high.y + slack, low_.y, 1);
    const int z0 = place(low.z - slack, low_.z, 2), z1 = place(high.z + slack, low_.z, 2);
    for (int z = z0; z <= z1; ++z) {
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                each((static_cast<std::size_t>(z) * cells_[1] + y) * cells_[0] + x);
            }
        }
    }
}

/// Calls `each` for every face in these cells, maybe more than once.
template <class Do>
void Surface::within(const V& low, const V& high, Do&& each) const {
    cells(low, high, [&](std::size_t cell) {
        for (std::uint32_t i = begin_[cell]; i < begin_[cell + 1]; ++i) each(static_cast<int>(in_cell_[i]));
    });
}

Crossing Surface::sweep(const V& a, const V& b, Real behind, const V* but) const {
    const V slack{behind, behind, behind};
    const Real way = distance(a, b);
    const int pieces = 1 + static_cast<int>(std::min<Real>(way / cell_, 1000));
    Crossing first;
    for (int i = 0; i < pieces; ++i) {
        const Real t0 = static_cast<Real>(i) / pieces, t1 = static_cast<Real>(i + 1) / pieces;
        const V p = a + t0 * (b - a), q = a + t1 * (b - a);
        const V low{std::min(p.x, q.x), std::min(p.y, q.y), std::min(p.z, q.z)};
        const V high{std::max(p.x, q.x), std::max(p.y, q.y), std::max(p.z, q.z)};
        within(low - slack, high + slack, [&](int f) { meet(f, a, b, behind, but, first); });
        if (first.face >= 0 && first.t <= t1) break;  // later pieces of the segment have no earlier crossing
    }
    return first;
}

int Surface::nearest_face_near(const V& p) const {
    for (Real reach = cell_; reach < size_; reach *= 2) {
        const V around{reach, reach, reach};
        int best = -1;
        Real shortest = reach;
        within(p - around, p + around, [&](int f) {
            const Real d = distance(nearest(f, p).point, p);
            if (d < shortest || (d == shortest && f < best)) shortest = d, best = f;
        });
        if (best >= 0) return best;
    }
    return nearest_face(p);
}

bool Surface::blocked(const V& at, const V& start, const V& hand) const {
    const Real near = 1e-13L * size_;
    const V slack{near, near, near};
    Crossing first;
    within(at - slack, at + slack, [&](int f) {
        if (distance(nearest(f, at).point, at) <= near) meet(f, start, hand, 0, nullptr, first);
    });
    return first.face >= 0;
}

bool Surface::near_rim(const V& at, Real reach) const {
    const V slack{reach, reach, reach};
    bool found = false;
    within(at - slack, at + slack, [&](int f) {
        for (int i = 0; i < 3 && !found; ++i) {
            const V &a = corner(f, i), &b = corner(f, (i + 1) % 3);
            const Real t = std::clamp<Real>(dot(at - a, b - a) / dot(b - a, b - a), 0, 1);
            found = over_[f][i] < 0 && distance(a + t * (b - a), at) <= reach;
        }
    });
    return found;
}

Real Surface::gain(const V& p, const V& hand, Real near, int from) const {
    const V slack{near, near, near};
    std::vector<int> there;
    within(p - slack, p + slack, [&](int f) {
        if (distance(nearest(f, p).point, p) <= near) there.push_back(f);
    });
    std::vector<int> reached = from < 0 ? there : std::vector<int>{from};
    for (std::size_t i = 0; i < reached.size(); ++i) {
        for (const int next : over_[reached[i]]) {
            const int f = next / 3;
            if (next >= 0 && std::find(there.begin(), there.end(), f) != there.end() &&
                std::find(reached.begin(), reached.end(), f) == reached.end()) {
                reached.push_back(f);
            }
        }
    }
    const Real now = distance(p, hand);
    Real best = 0;
    for (const int f : reached) best = std::max(best, now - distance(nearest(f, hand).point, hand));
    return best;
}

Real Surface::gain_in_sight(const V& p, const V& normal, const V& hand, Real near) const {
    const Real now = distance(p, hand);
    const V start = p + near * normal;
    Real best = 0;
    for (int f = 0; f < static_cast<int>(face_.size()); ++f) {
        const V at = nearest(f, hand).point;
        const Real gained = now - distance(at, hand);
        if (gained <= best) continue;
        const V end = at + near * normal_[f];
        if (sweep_all(start, end, 0).face < 0) best = gained;
    }
    return best;
}

}  // namespace exact
