#pragma once
// The mesh as the walk sees it: faces, the neighbours over their edges, and the tree, which is queried where
// contact begins and ends. HeightSurface has the same interface.

#include <bit>
#include <cmath>
#include <limits>

#include <knurl/geometry/proxy.hpp>

#include "mesh_data.hpp"
#include "triangle_math.hpp"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace knurl::detail {

/// Rounded up, in float arithmetic.
inline float at_most(double x) noexcept {
    const auto f = static_cast<float>(x);
    return f - std::abs(f) * 1.2e-7f - 1e-37f;
}
inline float at_least(double x) noexcept {
    return -at_most(-x);
}

template <class F>
class MeshSurface {
  public:
    MeshSurface(const MeshData& data, const F* faces, std::size_t count) noexcept
        : faces_(faces), nodes_(data.nodes.data()), count_(count), size_(data.size) {}

    bool has(std::uint32_t face) const noexcept { return face < count_; }
    double size() const noexcept { return size_; }
    Vec corner(std::uint32_t face, std::uint32_t i) const noexcept {
        const auto& c = faces_[face].corner[i];
        return {c[0], c[1], c[2]};
    }
    Corners corners(std::uint32_t face) const noexcept {
        return {{corner(face, 0), corner(face, 1), corner(face, 2)}};
    }
    Link over(std::uint32_t face, std::uint32_t edge) const noexcept { return faces_[face].over[edge]; }
    std::uint8_t flags(std::uint32_t face) const noexcept { return faces_[face].flags; }
    std::uint32_t triangle(std::uint32_t face) const noexcept { return faces_[face].triangle; }
    std::uint8_t material(std::uint32_t face) const noexcept { return faces_[face].material; }
    void fetch(std::uint32_t face) const noexcept { __builtin_prefetch(&faces_[face]); }
    void fetch_over(Link link) const noexcept {
        if (link != no_link) fetch(face_of(link));
    }

    /// Calls see(face) for all faces in leaves whose boxes touch the box. False: more nodes than allowed.
    template <class See>
    bool overlapping(const Vec& low, const Vec& high, Work& work, See&& see) const noexcept {
        if (count_ == 0) return true;
        float from[3], to[3];
        for (int axis = 0; axis < 3; ++axis) from[axis] = at_most(low[axis]), to[axis] = at_least(high[axis]);
        std::uint32_t stack[stack_size];
        std::uint32_t depth = 0;
        stack[depth++] = 0;
        while (depth > 0) {
            if (work.nodes + 1 + MeshNode::fan > max_nodes) return false;
            ++work.nodes;
            const MeshNode& node = nodes_[stack[--depth]];
            for (std::uint32_t bits = touched(node, from, to); bits != 0; bits &= bits - 1) {
                const std::uint32_t child = node.child[std::countr_zero(bits)];
                if (is_leaf(child)) {
                    ++work.nodes;  // its faces take as long as a node
                    const std::uint32_t first = leaf_first(child), end = first + leaf_count(child);
                    for (std::uint32_t face = first; face < end; ++face) see(face);
                } else if (depth < stack_size) {
                    fetch_node(child);
                    stack[depth++] = child;
                } else {
                    return false;
                }
            }
        }
        return true;
    }

    /// Calls see(face) for faces of leaves nearer to h than sqrt(square), which see() may reduce: roughly
    /// nearer ones first. False: more nodes than allowed.
    template <class See>
    bool nearer(const Vec& h, double& square, Work& work, See&& see) const noexcept {
        if (count_ == 0) return true;
        const float at[3] = {static_cast<float>(h.x), static_cast<float>(h.y), static_cast<float>(h.z)};
        const float loss = 3e-7f * (std::abs(at[0]) + std::abs(at[1]) + std::abs(at[2]));  // rounding of h
        struct Entry {
            std::uint32_t node;
            float square;
        } stack[stack_size];
        std::uint32_t depth = 0;
        stack[depth++] = {0, 0.0f};
        while (depth > 0) {
            const Entry place = stack[--depth];
            if (place.square > square) continue;
            if (work.nodes + 1 + MeshNode::fan > max_nodes) return false;
            ++work.nodes;
            const MeshNode& node = nodes_[place.node];
            alignas(16) float squares[MeshNode::fan];
            to_boxes(node, at, loss, squares);
            const std::uint32_t base = depth;
            for (std::uint32_t lane = 0; lane < MeshNode::fan; ++lane) {
                if (!(squares[lane] <= square)) continue;
                const std::uint32_t child = node.child[lane];
                if (is_leaf(child)) {
                    ++work.nodes;  // its faces take as long as a node
                    const std::uint32_t first = leaf_first(child), end = first + leaf_count(child);
                    for (std::uint32_t face = first; face < end; ++face) see(face);
                } else if (depth < stack_size) {
                    std::uint32_t to = depth++;  // the nearest on top
                    for (; to > base && stack[to - 1].square < squares[lane]; --to) stack[to] = stack[to - 1];
                    stack[to] = {child, squares[lane]};
                } else {
                    return false;
                }
            }
        }
        return true;
    }

    /// Half the side of a cube around h that no face reaches, at most `most`. 0: there is none, or the search
    /// would take too long.
    double room(const Vec& h, double most, Work& work) const noexcept {
        const float at[3] = {static_cast<float>(h.x), static_cast<float>(h.y), static_cast<float>(h.z)};
        auto best = static_cast<float>(most);
        std::uint32_t stack[stack_size];
        std::uint32_t depth = 0, seen = 0;
        if (count_ > 0) stack[depth++] = 0;
        while (depth > 0) {
            if (++seen > max_room_nodes || work.nodes >= max_nodes) return 0;
            ++work.nodes;
            const MeshNode& node = nodes_[stack[--depth]];
            float away[MeshNode::fan];
            for (std::uint32_t lane = 0; lane < MeshNode::fan; ++lane) {
                float far = -HUGE_VALF;
                for (int axis = 0; axis < 3; ++axis)
                    far = std::max(
                        far, std::max(node.low[axis][lane] - at[axis], at[axis] - node.high[axis][lane]));
                away[lane] = node.low[0][lane] > node.high[0][lane] ? HUGE_VALF : far;
            }
            for (std::uint32_t lane = 0; lane < MeshNode::fan; ++lane) {
                if (!(away[lane] < best)) continue;
                if (is_leaf(node.child[lane]))
                    best = away[lane];
                else if (depth < stack_size)
                    stack[depth++] = node.child[lane];
                else
                    return 0;
            }
            if (!(best > 0)) return 0;
        }
        const float loss = 3e-7f * (std::abs(at[0]) + std::abs(at[1]) + std::abs(at[2]) + best);
        return std::max(0.0f, best - loss);
    }

  private:
    static constexpr std::uint32_t stack_size = 256, max_room_nodes = 64;

    void fetch_node(std::uint32_t node) const noexcept {
        const char* at = reinterpret_cast<const char*>(&nodes_[node]);
        for (std::size_t line = 0; line < sizeof(MeshNode); line += 64) __builtin_prefetch(at + line);
    }

    // Squares of the distances to the children's boxes, less `loss`.
    static void to_boxes(const MeshNode& node, const float (&at)[3], float loss,
                         float (&squares)[MeshNode::fan]) noexcept {
        for (std::uint32_t lane = 0; lane < MeshNode::fan; ++lane) {
            float sum = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const float below = node.low[axis][lane] - at[axis], above = at[axis] - node.high[axis][lane];
                const float far = std::max(std::max(below, above) - loss, 0.0f);
                sum += far * far;
            }
            squares[lane] = node.low[0][lane] > node.high[0][lane] ? HUGE_VALF : sum * 0.999999f;
        }
    }

    // Bits of the children whose boxes touch that one.
    static std::uint32_t touched(const MeshNode& node, const float (&from)[3],
                                 const float (&to)[3]) noexcept {
        std::uint32_t bits = 0;
#if defined(__x86_64__)
        for (std::uint32_t half = 0; half < MeshNode::fan; half += 4) {
            __m128 all = _mm_cmple_ps(_mm_load_ps(&node.low[0][half]), _mm_load_ps(&node.high[0][half]));
            for (int axis = 0; axis < 3; ++axis) {
                all =
                    _mm_and_ps(all, _mm_cmple_ps(_mm_load_ps(&node.low[axis][half]), _mm_set1_ps(to[axis])));
                all = _mm_and_ps(all,
                                 _mm_cmpge_ps(_mm_load_ps(&node.high[axis][half]), _mm_set1_ps(from[axis])));
            }
            bits |= static_cast<std::uint32_t>(_mm_movemask_ps(all)) << half;
        }
#else
        for (std::uint32_t lane = 0; lane < MeshNode::fan; ++lane) {
            bool all = node.low[0][lane] <= node.high[0][lane];
            for (int axis = 0; axis < 3; ++axis)
                all = all && node.low[axis][lane] <= to[axis] && node.high[axis][lane] >= from[axis];
            bits |= std::uint32_t{all} << lane;
        }
#endif
        return bits;
    }

    const F* faces_;
    const MeshNode* nodes_;
    std::size_t count_;
    double size_;
};

}  // namespace knurl::detail
