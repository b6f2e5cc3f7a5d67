// Faces that others pass through, or stand on without a common edge: there the walk alone could pass under.

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "build.hpp"

namespace knurl::build {
namespace {

using Eigen::Vector3d;

struct Corners {
    Vector3d at[3], normal;  // unit
    double low[3], high[3];  // m, a little wider

    double longest() const {  // m
        return std::sqrt(std::max(
            {(at[1] - at[0]).squaredNorm(), (at[2] - at[1]).squaredNorm(), (at[0] - at[2]).squaredNorm()}));
    }
    bool meets(const Corners& o) const {
        return low[0] <= o.high[0] && high[0] >= o.low[0] && low[1] <= o.high[1] && high[1] >= o.low[1] &&
               low[2] <= o.high[2] && high[2] >= o.low[2];
    }
};

/// Both sets lie on different sides of the plane across `axis`, or touch by `touch` at most.
template <std::size_t N, std::size_t M>
double gap(const Vector3d& axis, const Vector3d (&a)[N], const Vector3d (&b)[M]) {
    double a_low = axis.dot(a[0]), a_high = a_low, b_low = axis.dot(b[0]), b_high = b_low;
    for (std::size_t i = 1; i < N; ++i) {
        const double x = axis.dot(a[i]);
        a_low = std::min(a_low, x), a_high = std::max(a_high, x);
    }
    for (std::size_t i = 1; i < M; ++i) {
        const double x = axis.dot(b[i]);
        b_low = std::min(b_low, x), b_high = std::max(b_high, x);
    }
    return std::max(b_low - a_high, a_low - b_high);  // < 0: by which they overlap
}

class Finder {
  public:
    Finder(const MeshData& data, const Faces& faces, double touch, Slices& slices)
        : nodes_(data.nodes),
          faces_(faces),
          touch_(touch),
          reach_(std::max(touch, 5e-5 * data.size)),
          slices_(slices) {}

    void find(std::vector<std::uint8_t>& flags) {
        done_.resize(flags.size());
        for (const MeshNode& node : nodes_) {
            for (std::uint32_t i = 0; i < MeshNode::fan; ++i) {
                if (node.low[0][i] <= node.high[0][i] && is_leaf(node.child[i])) query(node, i, flags);
            }
        }
    }

  private:
    /// All but the normal, which most need not have.
    Corners corners(std::uint32_t f) const {
        Corners c;
        for (std::size_t i = 0; i < 3; ++i) c.at[i] = Vector3d(faces_.at[faces_.corners[f][i]].data());
        for (int k = 0; k < 3; ++k) {
            c.low[k] = std::min({c.at[0][k], c.at[1][k], c.at[2][k]}) - touch_;
            c.high[k] = std::max({c.at[0][k], c.at[1][k], c.at[2][k]}) + touch_;
        }
        return c;
    }
    static Vector3d normal(const Corners& c) {
        return (c.at[1] - c.at[0]).cross(c.at[2] - c.at[0]).normalized();
    }

    /// Tests the faces of a leaf against all whose boxes it meets. A face whose query came to its end is
    /// done: others need not ask about it again.
    void query(const MeshNode& leaf, std::uint32_t place, std::vector<std::uint8_t>& flags) {
        const std::uint32_t first = leaf_first(leaf.child[place]), count = leaf_count(leaf.child[place]);
        Corners own[4];
        double low[3], high[3];
        for (std::uint32_t i = 0; i < count; ++i) {
            own[i] = corners(first + i);
            own[i].normal = normal(own[i]);
        }
        for (int k = 0; k < 3; ++k) {
            low[k] = static_cast<double>(leaf.low[k][place]) - touch_;
            high[k] = static_cast<double>(leaf.high[k][place]) + touch_;
        }
        // Where very many boxes overlap, faces are taken for crossed unseen: that costs the hand time, not
        // truth.
        const std::uint64_t limit = spent_ < 128 * flags.size() + 100000 ? 4096 : 128;
        std::uint64_t work = 0;
        bool all = false;
        stack_.assign(1, 0);
        while (!stack_.empty() && work < limit && !all) {
            const MeshNode& node = nodes_[stack_.back()];
            stack_.pop_back();
            ++work;
            std::uint32_t hits = 0;
            for (std::uint32_t i = 0; i < MeshNode::fan; ++i) {
                const bool meets = (node.low[0][i] <= high[0]) & (node.high[0][i] >= low[0]) &
                                   (node.low[1][i] <= high[1]) & (node.high[1][i] >= low[1]) &
                                   (node.low[2][i] <= high[2]) & (node.high[2][i] >= low[2]);
                hits |= static_cast<std::uint32_t>(meets) << i;
            }
            for (; hits != 0 && !all; hits &= hits - 1) {
                const std::uint32_t child = node.child[__builtin_ctz(hits)];
                if (!is_leaf(child)) {
                    stack_.push_back(child);
                    continue;
                }
                for (std::uint32_t g = leaf_first(child); g < leaf_first(child) + leaf_count(child); ++g) {
                    if (!done_[g]) work += against(first, {own, count}, g, flags);
                }
                all = true;
                for (std::uint32_t i = 0; i < count; ++i) all = all && (flags[first + i] & face_crossed) != 0;
            }
        }
        const bool complete = stack_.empty() && !all;
        for (std::uint32_t i = 0; i < count; ++i) {
            if (complete) {
                done_[first + i] = true;
            } else {
                flags[first + i] |= face_crossed;
            }
        }
        spent_ += work;
        slices_(static_cast<std::uint32_t>(4 * work));
    }

    std::uint32_t against(std::uint32_t first, std::span<const Corners> own, std::uint32_t g,
                          std::vector<std::uint8_t>& flags) {
        std::uint32_t tests = 0;
        Corners other = corners(g);
        for (std::uint32_t i = 0; i < own.size(); ++i) {
            const std::uint32_t f = first + i;
            if (f == g || (flags[f] & flags[g] & face_crossed) != 0) continue;
            // Both in one leaf: once is enough.
            if (g >= first && g < first + own.size() && g < f) continue;
            const Corners& c = own[i];
            if (!c.meets(other)) continue;
            if (tests == 0) other.normal = normal(other);
            ++tests;
            if (!crossed(f, c, g, other)) continue;
            flags[f] |= face_crossed;
            flags[g] |= face_crossed;
        }
        return tests;
    }

    bool crossed(std::uint32_t f, const Corners& a, std::uint32_t g, const Corners& b) const {
        const Triangle &s = faces_.corners[f], &t = faces_.corners[g];
        std::uint32_t shared = 0, ia = 0, ib = 0;
        for (std::uint32_t i = 0; i < 3; ++i) {
            for (std::uint32_t k = 0; k < 3; ++k) {
                if (s[i] == t[k]) ++shared, ia = i, ib = k;
            }
        }
        if (shared > 1) return false;  // beyond a common edge they meet only when folded onto each other

        // How far each goes on either side of the other's plane.
        const auto heights = [](const Corners& of, const Corners& over) {
            const double h[3] = {over.normal.dot(of.at[0] - over.at[0]),
                                 over.normal.dot(of.at[1] - over.at[0]),
                                 over.normal.dot(of.at[2] - over.at[0])};
            return std::pair(std::min({h[0], h[1], h[2]}), std::max({h[0], h[1], h[2]}));
        };
        const auto [a_low, a_high] = heights(a, b);
        if (a_low > touch_ || a_high < -touch_) return false;
        const auto [b_low, b_high] = heights(b, a);
        if (b_low > touch_ || b_high < -touch_) return false;
        const double longest = std::min(a.longest(), b.longest());
        const double touch = std::min(touch_, 1e-4 * longest), reach = std::min(reach_, 1e-2 * longest);
        if (a_low > touch || a_high < -touch || b_low > touch || b_high < -touch) return false;
        // In the way of a hand is what has free space before it on both: not what hangs behind the other.
        // Level with the other it is only if they overlap.
        const bool flat = a_high <= reach || b_high <= reach;
        if (flat && (std::max(a_high, b_high) > reach || std::min(a_low, b_low) < -reach ||
                     a.normal.dot(b.normal) <= 0))
            return false;
        const double apart = flat ? -reach : touch;
        if (shared == 0) return meet(a, b.at, b.normal, apart, flat);
        // From the common corner on they meet until the far edge of one of them.
        const Vector3d a_far[2] = {a.at[(ia + 1) % 3], a.at[(ia + 2) % 3]};
        const Vector3d b_far[2] = {b.at[(ib + 1) % 3], b.at[(ib + 2) % 3]};
        if (flat) return meet(a, b.at, b.normal, apart, true);
        return meet(b, a_far, a.normal, apart, false) || meet(a, b_far, b.normal, apart, false);
    }

    /// No axis separates the face from the other's corners (all, or an edge of them) by more than `apart`.
    template <std::size_t N>
    static bool meet(const Corners& face, const Vector3d (&other)[N], const Vector3d& other_normal,
                     double apart, bool flat) {
        const auto separates = [&](const Vector3d& axis, double least) {
            const double square = axis.squaredNorm();
            return square > least && gap(axis, face.at, other) > apart * std::sqrt(square);
        };
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3d e = face.at[(i + 1) % 3] - face.at[i];
            if (separates(face.normal.cross(e), 0)) return false;
        }
        for (std::size_t k = 0; k < (N == 3 ? 3 : 1); ++k) {
            const Vector3d e = other[(k + 1) % N] - other[k];
            if (separates(other_normal.cross(e), 0)) return false;
            if (flat) continue;
            for (std::size_t i = 0; i < 3; ++i) {
                const Vector3d g = face.at[(i + 1) % 3] - face.at[i];
                if (separates(e.cross(g), 1e-12 * e.squaredNorm() * g.squaredNorm())) return false;
            }
        }
        return true;
    }

    const std::vector<MeshNode>& nodes_;
    const Faces& faces_;
    const double touch_, reach_;
    Slices& slices_;
    std::vector<bool> done_;
    std::vector<std::uint32_t> stack_;
    std::uint64_t spent_ = 0;
};

}  // namespace

void find_crossings(const MeshData& data, const Faces& faces, double touch, std::vector<std::uint8_t>& flags,
                    MeshNotes& notes, Slices& slices) {
    slices.ask();
    Finder(data, faces, touch, slices).find(flags);
    for (const std::uint8_t f : flags) notes.faces_crossed += (f & face_crossed) != 0;
}

}  // namespace knurl::build
