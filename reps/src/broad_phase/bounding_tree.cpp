#include "broad_phase/bounding_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace knurl::detail {

namespace {

// A difference of coordinates is rounded, so the test takes each ball as slightly larger than it is.
constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();

}  // namespace

BoundingTree::BoundingTree(std::uint32_t capacity, Moves moves)
    : ball_(capacity),
      loose_(capacity),
      place_(capacity, nowhere),
      in_tree_(capacity, 0),
      moving_(moves == Moves::some ? capacity : 0),
      moving_place_(capacity, nowhere) {}

void BoundingTree::drop(std::uint32_t slot) noexcept {
    if (place_[slot] != nowhere) {
        const std::uint32_t last = loose_[--loose_size_];
        loose_[place_[slot]] = last;
        place_[last] = place_[slot];
        place_[slot] = nowhere;
    } else if (in_tree_[slot]) {
        in_tree_[slot] = 0;
    } else if (moving_place_[slot] != nowhere) {
        const Moving& last = moving_[moving_place_[slot]] = moving_[--moving_size_];
        moving_place_[last.slot] = moving_place_[slot];
        moving_place_[slot] = nowhere;
    } else {
        return;
    }
    radii_ = --size_ > 0 ? radii_ - ball_[slot].r : 0;
}

void BoundingTree::put(std::uint32_t slot, const Eigen::Vector3d& center, double radius) noexcept {
    drop(slot);
    ball_[slot] = {center.x(), center.y(), center.z(), radius};
    place_[slot] = loose_size_;
    loose_[loose_size_++] = slot;
    ++size_;
    radii_ += radius;
}

void BoundingTree::put_moving(std::uint32_t slot, const Eigen::Vector3d& center, double radius,
                              const Eigen::Vector3d& velocity, double since, bool holds) noexcept {
    drop(slot);
    ball_[slot] = {center.x(), center.y(), center.z(), radius};
    moving_place_[slot] = moving_size_;
    moving_[moving_size_++] = {.ball = ball_[slot],
                               .vx = velocity.x(),
                               .vy = velocity.y(),
                               .vz = velocity.z(),
                               .speed = velocity.norm(),
                               .since = since,
                               .slot = slot,
                               .holds = holds};
    ++size_;
    radii_ += radius;
}

void BoundingTree::clear() noexcept {
    std::fill(place_.begin(), place_.end(), nowhere);
    std::fill(moving_place_.begin(), moving_place_.end(), nowhere);
    std::fill(in_tree_.begin(), in_tree_.end(), std::uint8_t{0});
    loose_size_ = moving_size_ = size_ = 0;
    radii_ = 0;
    nodes_.clear();
    items_.clear();
    item_balls_.clear();
}

void BoundingTree::index() {
    items_.clear();
    items_.reserve(size_);
    for (std::uint32_t slot = 0; slot < ball_.size(); ++slot) {
        if (place_[slot] == nowhere && !in_tree_[slot]) continue;
        items_.push_back(slot);
        place_[slot] = nowhere;
        in_tree_[slot] = 1;
    }
    loose_size_ = 0;
    nodes_.clear();
    if (items_.empty()) return;
    origin_.setZero();
    for (const std::uint32_t slot : items_)
        origin_ +=
            Eigen::Vector3d(ball_[slot].x, ball_[slot].y, ball_[slot].z) / static_cast<double>(items_.size());
    nodes_.reserve(items_.size() / 4 + 8);
    build(0, static_cast<std::uint32_t>(items_.size()));
    item_balls_.resize(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) item_balls_[i] = ball_[items_[i]];
}

BoundingTree::Box BoundingTree::box_of(std::uint32_t item) const noexcept {
    const Ball& b = ball_[items_[item]];
    const Eigen::Vector3d center(b.x, b.y, b.z);
    const double r = b.r + rounding * (center.lpNorm<1>() + origin_.lpNorm<1>() + b.r);
    return {(center - origin_).array() - r, (center - origin_).array() + r};
}

// Sorts into runs of `part` items that lie close together. Splits each range along the longest extent of its
// centres.
void BoundingTree::sort(std::uint32_t begin, std::uint32_t end, std::uint32_t part) {
    if (end - begin <= part) return;
    const auto along = [&](std::uint32_t slot, int axis) {
        const Ball& ball = ball_[slot];
        return axis == 0 ? ball.x : axis == 1 ? ball.y : ball.z;
    };
    int longest = 0;
    double length = -1;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax_element(
            items_.begin() + begin, items_.begin() + end,
            [&](std::uint32_t a, std::uint32_t b) { return along(a, axis) < along(b, axis); });
        if (along(*high, axis) - along(*low, axis) > length)
            length = along(*high, axis) - along(*low, axis), longest = axis;
    }
    const std::uint32_t parts = (end - begin + part - 1) / part, middle = begin + parts / 2 * part;
    std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) { return along(a, longest) < along(b, longest); });
    sort(begin, middle, part);
    sort(middle, end, part);
}

std::pair<std::uint32_t, BoundingTree::Box> BoundingTree::build(std::uint32_t begin, std::uint32_t end) {
    std::uint32_t part = 1;  // items of a child: each child is full, except the last
    while (part * std::uint64_t{fan} < end - begin) part *= fan;
    sort(begin, end, part);
    constexpr double none = std::numeric_limits<double>::infinity();
    Box whole{Eigen::Vector3d::Constant(none), Eigen::Vector3d::Constant(-none)};
    const auto me = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    Node node;
    node.bottom = part == 1;
    for (std::uint32_t lane = 0; lane < fan; ++lane) {
        const std::uint64_t from = begin + std::uint64_t{lane} * part;
        Box box{Eigen::Vector3d::Constant(none), Eigen::Vector3d::Constant(-none)};
        node.child[lane] = nowhere;
        if (from < end) {
            const auto first = static_cast<std::uint32_t>(from);
            if (part == 1) {
                node.child[lane] = first;
                box = box_of(first);
            } else {
                std::tie(node.child[lane], box) = build(first, std::min(first + part, end));
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            constexpr float away = std::numeric_limits<float>::infinity();
            node.low[axis][lane] = std::nextafter(static_cast<float>(box.low[axis]), -away);
            node.high[axis][lane] = std::nextafter(static_cast<float>(box.high[axis]), away);
        }
        whole = {whole.low.cwiseMin(box.low), whole.high.cwiseMax(box.high)};
    }
    nodes_[me] = node;
    return {me, whole};
}

// Bits of the children whose boxes are within sqrt(square) of p. `square` in m^2; p is relative to the
// origin.
std::uint32_t BoundingTree::near_children(const Node& node, const float (&p)[3], float square) noexcept {
    std::uint32_t bits = 0;
#if defined(__x86_64__)
    for (std::uint32_t half = 0; half < fan; half += 4) {
        __m128 sum = _mm_setzero_ps();
        for (int axis = 0; axis < 3; ++axis) {
            const __m128 at = _mm_set1_ps(p[axis]);
            const __m128 below = _mm_sub_ps(_mm_load_ps(&node.low[axis][half]), at),
                         above = _mm_sub_ps(at, _mm_load_ps(&node.high[axis][half])),
                         far = _mm_max_ps(_mm_max_ps(below, above), _mm_setzero_ps());
            sum = _mm_add_ps(sum, _mm_mul_ps(far, far));
        }
        const int near = _mm_movemask_ps(_mm_cmple_ps(sum, _mm_set1_ps(square)));
        bits |= static_cast<std::uint32_t>(near) << half;
    }
#else
    for (std::uint32_t lane = 0; lane < fan; ++lane) {
        float sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const float far =
                std::max(std::max(node.low[axis][lane] - p[axis], p[axis] - node.high[axis][lane]), 0.0f);
            sum += far * far;
        }
        bits |= std::uint32_t{sum <= square} << lane;
    }
#endif
    return bits;
}

std::uint32_t BoundingTree::collect(const Eigen::Vector3d& p, double within,
                                    std::span<std::uint32_t> out) const noexcept {
    std::uint32_t n = 0;
    const double px = p.x(), py = p.y(), pz = p.z();
    const double slack = within + rounding * p.lpNorm<1>();
    const auto near = [&](const Ball& b) {
        const double x = b.x - px, y = b.y - py, z = b.z - pz;
        const double reach = b.r + slack + rounding * (std::abs(b.x) + std::abs(b.y) + std::abs(b.z));
        return x * x + y * y + z * z < reach * reach;
    };
    for (std::uint32_t i = 0; i < loose_size_; ++i) {
        if (near(ball_[loose_[i]]) && n < out.size()) out[n++] = loose_[i];
    }
    if (nodes_.empty()) return n;
    const Eigen::Vector3d from = p - origin_;
    const float at[3] = {static_cast<float>(from.x()), static_cast<float>(from.y()),
                         static_cast<float>(from.z())};
    // Adds the error of p in float and the error of the arithmetic in float.
    const double far = (slack + rounding * origin_.lpNorm<1>() + 1e-6 * from.lpNorm<1>()) * (1 + 1e-5);
    const auto square = static_cast<float>(far * far * (1 + 1e-6));
    std::uint32_t stack[(fan - 1) * 11 + 1];  // slot numbers suffice for fewer than 11 levels
    std::uint32_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        for (std::uint32_t bits = near_children(node, at, square); bits != 0; bits &= bits - 1) {
            const std::uint32_t child = node.child[std::countr_zero(bits)];
            if (child == nowhere) break;  // all entries behind it are empty too
            if (node.bottom == 0) {
                stack[depth++] = child;
                for (std::size_t line = 0; line < sizeof(Node); line += 64)
                    __builtin_prefetch(reinterpret_cast<const std::byte*>(&nodes_[child]) + line);
            } else if (near(item_balls_[child]) && in_tree_[items_[child]] && n < out.size()) {
                out[n++] = items_[child];
            }
        }
    }
    return n;
}

BoundingTree::Coming BoundingTree::collect_moving(const Eigen::Vector3d& p, double within,
                                                  const SceneTime& now,
                                                  std::span<std::uint32_t> out) const noexcept {
    Coming coming{.count = 0, .lasts = std::numeric_limits<double>::infinity()};
    // A ball that has moved away by then leaves the list.
    constexpr double looked_at_again = 0.1;  // s
    for (std::uint32_t i = 0; i < moving_size_; ++i) {
        const Moving& m = moving_[i];
        const double time = std::max(0.0, now.of(m.holds) - m.since);
        const Eigen::Vector3d at(m.ball.x + time * m.vx, m.ball.y + time * m.vy, m.ball.z + time * m.vz);
        const double lost = rounding * (at.lpNorm<1>() + p.lpNorm<1>() + time * m.speed);
        const double away = away_for((at - p).norm() - m.ball.r - within - lost, m.speed);
        coming.lasts = std::min(coming.lasts, away > 0 ? away : looked_at_again);
        if (!(away > 0) && coming.count < out.size()) out[coming.count++] = m.slot;
    }
    return coming;
}

}  // namespace knurl::detail
