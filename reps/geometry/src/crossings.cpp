// Faces that others pass through, or stand on without a common edge: there the walk alone could pass below.

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "build.hpp"

namespace knurl::build {
namespace {

using Eigen::Vector3d;

/// Measures of each face, computed once.
struct Measures {
    Vector3d normal;  // unit
    double longest;   // m, edge
};

struct Corners {
    Vector3d at[3];
    double low[3], high[3];  // m, slightly enlarged
    bool meets(const Corners& o) const {
        return low[0] <= o.high[0] && high[0] >= o.low[0] && low[1] <= o.high[1] && high[1] >= o.low[1] &&
               low[2] <= o.high[2] && high[2] >= o.low[2];
    }
};

/// The heights of a face's corners over another face's plane (m).
struct Heights {
    Heights(const Corners& of, const Corners& over, const Vector3d& normal)
        : at{normal.dot(of.at[0] - over.at[0]), normal.dot(of.at[1] - over.at[0]),
             normal.dot(of.at[2] - over.at[0])},
          low(std::min({at[0], at[1], at[2]})),
          high(std::max({at[0], at[1], at[2]})) {}
    bool clear(double touch) const { return low > touch || high < -touch; }
    /// The edge opposite a corner.
    bool clear_across(std::size_t c, double touch) const {
        const double a = at[(c + 1) % 3], b = at[(c + 2) % 3];
        return (a > touch && b > touch) || (a < -touch && b < -touch);
    }
    double at[3], low, high;
};

/// The distance of two sets along an axis, which need not be unit; < 0: the overlap.
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
    return std::max(b_low - a_high, a_low - b_high);
}

class Finder {
  public:
    Finder(const MeshData& data, const Faces& faces, double touch, Slices& slices)
        : nodes_(data.nodes),
          faces_(faces),
          touch_(touch),
          tree_(std::max(touch, 5e-5 * data.size)),
          slices_(slices) {}

    void find(std::vector<std::uint8_t>& flags) {
        done_.resize(flags.size());
        measures_.reserve(flags.size());
        for (std::uint32_t f = 0; f < flags.size(); ++f, slices_(2)) {
            const Corners c = corners(f);
            const Vector3d e = c.at[1] - c.at[0], g = c.at[2] - c.at[0];
            measures_.push_back(
                {e.cross(g).normalized(),
                 std::sqrt(std::max({e.squaredNorm(), g.squaredNorm(), (g - e).squaredNorm()}))});
        }
        for (const MeshNode& node : nodes_) {
            for (std::uint32_t i = 0; i < MeshNode::fan; ++i) {
                if (node.low[0][i] <= node.high[0][i] && is_leaf(node.child[i])) search(node, i, flags);
            }
        }
        find_knots(flags);
    }

  private:
    Corners corners(std::uint32_t f) const {
        Corners c;
        for (std::size_t i = 0; i < 3; ++i) c.at[i] = Vector3d(faces_.at[faces_.corners[f][i]].data());
        for (int k = 0; k < 3; ++k) {
            c.low[k] = std::min({c.at[0][k], c.at[1][k], c.at[2][k]}) - touch_;
            c.high[k] = std::max({c.at[0][k], c.at[1][k], c.at[2][k]}) + touch_;
        }
        return c;
    }
    /// From a vertex the walk goes to any face around it at once, also to faces that pass through each other.
    /// All faces around such a vertex get the flag. The pairs of a fan are tested only here, since the search
    /// leaves out faces that are already crossed.
    void find_knots(std::vector<std::uint8_t>& flags) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> fans;  // vertex, crossed face at that vertex
        for (std::uint32_t f = 0; f < flags.size(); ++f) {
            if ((flags[f] & face_crossed) == 0) continue;
            for (const std::uint32_t v : faces_.corners[f]) fans.emplace_back(v, f);
        }
        if (fans.empty()) return;
        std::sort(fans.begin(), fans.end());
        std::vector<bool> knots(faces_.at.size());
        for (auto begin = fans.begin(), end = begin; begin != fans.end(); begin = end) {
            end = std::find_if(begin, fans.end(), [&](const auto& one) { return one.first != begin->first; });
            knots[begin->first] = is_knot({begin, end});
        }
        for (std::uint32_t f = 0; f < flags.size(); ++f, slices_()) {
            for (const std::uint32_t v : faces_.corners[f])
                if (knots[v]) flags[f] |= face_knot;
        }
    }

    /// Do two of these faces around one vertex pass through each other?
    bool is_knot(std::span<const std::pair<std::uint32_t, std::uint32_t>> fan) {
        constexpr std::size_t most = 64;  // as above: an untested vertex that counts as a knot costs only
                                          // time
        if (fan.size() > most) return true;
        for (std::size_t i = 0; i < fan.size(); ++i) {
            const std::uint32_t f = fan[i].second;
            const Corners own = corners(f);
            slices_(static_cast<std::uint32_t>(fan.size()));
            for (std::size_t k = i + 1; k < fan.size(); ++k) {
                const Corners other = corners(fan[k].second);
                if (own.meets(other) && crossed(f, own, fan[k].second, other)) return true;
            }
        }
        return false;
    }

    /// Looks for faces that cross those of one leaf.
    struct Query {
        std::uint32_t first, count;  // of the leaf's faces
        Corners own[4];              // of these
        float low[3], high[3];       // m, a little wider than the leaf's box
    };
    Query query_of(const MeshNode& leaf, std::uint32_t place) const {
        Query out;
        out.first = leaf_first(leaf.child[place]), out.count = leaf_count(leaf.child[place]);
        for (std::uint32_t i = 0; i < out.count; ++i) out.own[i] = corners(out.first + i);
        for (int k = 0; k < 3; ++k) {
            constexpr float inf = std::numeric_limits<float>::infinity();
            const auto wider = static_cast<float>(touch_);
            out.low[k] = std::nextafter(leaf.low[k][place] - wider, -inf);
            out.high[k] = std::nextafter(leaf.high[k][place] + wider, inf);
        }
        return out;
    }

    /// Tests the faces of a leaf against all faces whose boxes they meet. A face with a complete query is
    /// done: other queries need not test it again.
    void search(const MeshNode& leaf, std::uint32_t place, std::vector<std::uint8_t>& flags) {
        const Query query = query_of(leaf, place);
        // Where very many boxes overlap, faces count as crossed without a test. That costs time in the cycle,
        // but the contact stays right.
        const std::uint64_t limit = spent_ < 128 * flags.size() + 100000 ? 4096 : 128;
        std::uint64_t work = 0;
        bool all = false;
        stack_.assign(1, 0);
        while (!stack_.empty() && work < limit && !all) {
            const MeshNode& node = nodes_[stack_.back()];
            stack_.pop_back();
            ++work;
            all = look_into(node, query, work, flags);
        }
        const bool complete = stack_.empty() && !all;
        for (std::uint32_t f = query.first; f < query.first + query.count; ++f) {
            if (complete) {
                done_[f] = true;
            } else {
                flags[f] |= face_crossed;
            }
        }
        spent_ += work;
        slices_(static_cast<std::uint32_t>(4 * work));
    }

    /// Tests what is in the leaves below a node and puts its other children onto the stack. True, and nothing
    /// more is looked at: all faces of the query are crossed.
    bool look_into(const MeshNode& node, const Query& query, std::uint64_t& work,
                   std::vector<std::uint8_t>& flags) {
        alignas(32) std::int32_t meets[MeshNode::fan];  // in four lanes at a time
        for (std::uint32_t i = 0; i < MeshNode::fan; ++i) {
            meets[i] = (node.low[0][i] <= query.high[0]) & (node.high[0][i] >= query.low[0]) &
                       (node.low[1][i] <= query.high[1]) & (node.high[1][i] >= query.low[1]) &
                       (node.low[2][i] <= query.high[2]) & (node.high[2][i] >= query.low[2]);
        }
        for (std::uint32_t k = 0; k < MeshNode::fan; ++k) {
            if (meets[k] == 0) continue;
            const std::uint32_t child = node.child[k];
            if (!is_leaf(child)) {
                stack_.push_back(child);
                continue;
            }
            for (std::uint32_t g = leaf_first(child); g < leaf_first(child) + leaf_count(child); ++g) {
                if (!done_[g]) work += against(query.first, {query.own, query.count}, g, flags);
            }
            if (all_crossed(query, flags)) return true;
        }
        return false;
    }

    static bool all_crossed(const Query& query, const std::vector<std::uint8_t>& flags) {
        bool all = true;
        for (std::uint32_t i = 0; i < query.count; ++i)
            all = all && (flags[query.first + i] & face_crossed) != 0;
        return all;
    }

    std::uint32_t against(std::uint32_t first, std::span<const Corners> own, std::uint32_t g,
                          std::vector<std::uint8_t>& flags) {
        std::uint32_t tests = 0;
        const Corners other = corners(g);
        for (std::uint32_t i = 0; i < own.size(); ++i) {
            const std::uint32_t f = first + i;
            if (f == g || (flags[f] & flags[g] & face_crossed) != 0) continue;
            // Both faces are in this leaf: one test is enough.
            if (g >= first && g < first + own.size() && g < f) continue;
            if (!own[i].meets(other)) continue;
            ++tests;
            if (!crossed(f, own[i], g, other)) continue;
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
        if (shared > 1)
            return false;  // faces with a common edge meet elsewhere only when folded onto each
                           // other
        const Vector3d &a_normal = measures_[f].normal, &b_normal = measures_[g].normal;
        const Heights of_b(b, a, a_normal);
        if (of_b.clear(touch_)) return false;
        const double longest = std::min(measures_[f].longest, measures_[g].longest);
        const double touch = std::min(touch_, 1e-4 * longest), reach = std::min(tree_, 1e-2 * longest);
        // A face matters only with free space before it on both sides, not when it hangs behind the other.
        // Two faces in one plane matter only where they overlap.
        if (of_b.high <= reach && of_b.low < -reach) return false;
        const Heights of_a(a, b, b_normal);
        if (of_a.clear(touch) || of_b.clear(touch)) return false;
        const bool level = of_a.high <= reach || of_b.high <= reach;
        if (level) {
            if (std::max(of_a.high, of_b.high) > reach || std::min(of_a.low, of_b.low) < -reach) return false;
            return a_normal.dot(b_normal) > 0 && meet(a, a_normal, b.at, b_normal, -reach, true);
        }
        if (shared == 0) return meet(a, a_normal, b.at, b_normal, touch, false);
        // From the common corner they meet up to the far edge of one of them.
        const Vector3d a_far[2] = {a.at[(ia + 1) % 3], a.at[(ia + 2) % 3]};
        const Vector3d b_far[2] = {b.at[(ib + 1) % 3], b.at[(ib + 2) % 3]};
        return (!of_a.clear_across(ia, touch) && meet(b, b_normal, a_far, a_normal, touch, false)) ||
               (!of_b.clear_across(ib, touch) && meet(a, a_normal, b_far, b_normal, touch, false));
    }

    /// No axis separates the face from the other face's corners (all, or an edge of them) by more than
    /// `apart`.
    template <std::size_t N>
    static bool meet(const Corners& face, const Vector3d& normal, const Vector3d (&other)[N],
                     const Vector3d& other_normal, double apart, bool level) {
        const auto separates = [&](const Vector3d& axis, double least) {
            const double square = axis.squaredNorm();
            return square > least && gap(axis, face.at, other) > apart * std::sqrt(square);
        };
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3d e = face.at[(i + 1) % 3] - face.at[i];
            if (separates(normal.cross(e), 0)) return false;
        }
        for (std::size_t k = 0; k < (N == 3 ? 3 : 1); ++k) {
            const Vector3d e = other[(k + 1) % N] - other[k];
            if (separates(other_normal.cross(e), 0)) return false;
            if (level) continue;
            for (std::size_t i = 0; i < 3; ++i) {
                const Vector3d g = face.at[(i + 1) % 3] - face.at[i];
                if (separates(e.cross(g), 1e-12 * e.squaredNorm() * g.squaredNorm())) return false;
            }
        }
        return true;
    }

    std::span<const MeshNode> nodes_;
    const Faces& faces_;
    const double touch_, tree_;
    Slices& slices_;
    std::vector<Measures> measures_;
    std::vector<bool> done_;  // of faces
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
