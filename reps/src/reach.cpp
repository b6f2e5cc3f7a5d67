#include "reach.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knurl::detail {

namespace {

// Rounding of a difference of coordinates: a ball is tested a little larger than it is.
constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();

}  // namespace

Reach::Reach(std::uint32_t capacity)
    : ball_(capacity), loose_(capacity), place_(capacity, nowhere), in_tree_(capacity, 0) {}

void Reach::drop(std::uint32_t slot) noexcept {
    if (place_[slot] != nowhere) {
        const std::uint32_t last = loose_[--loose_size_];
        loose_[place_[slot]] = last;
        place_[last] = place_[slot];
        place_[slot] = nowhere;
    } else if (in_tree_[slot]) {
        in_tree_[slot] = 0;
    } else {
        return;
    }
    radii_ = --size_ > 0 ? radii_ - ball_[slot].r : 0;
}

void Reach::put(std::uint32_t slot, const Eigen::Vector3d& center, double radius) noexcept {
    drop(slot);
    ball_[slot] = {center.x(), center.y(), center.z(), radius};
    place_[slot] = loose_size_;
    loose_[loose_size_++] = slot;
    ++size_;
    radii_ += radius;
}

void Reach::clear() noexcept {
    std::fill(place_.begin(), place_.end(), nowhere);
    std::fill(in_tree_.begin(), in_tree_.end(), std::uint8_t{0});
    loose_size_ = size_ = 0;
    radii_ = 0;
    nodes_.clear();
    items_.clear();
    item_balls_.clear();
}

void Reach::index() {
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
    nodes_.reserve(2 * items_.size() / leaf_size + 2);
    build(0, static_cast<std::uint32_t>(items_.size()));
    item_balls_.resize(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) item_balls_[i] = ball_[items_[i]];
}

// Halves by the median of the longest side: balanced, so the stack of `collect` is bounded.
std::uint32_t Reach::build(std::uint32_t begin, std::uint32_t end) {
    Node node{};
    for (int axis = 0; axis < 3; ++axis) {
        node.low[axis] = std::numeric_limits<double>::infinity();
        node.high[axis] = -node.low[axis];
    }
    for (std::uint32_t i = begin; i < end; ++i) {
        const Ball& b = ball_[items_[i]];
        const double at[3] = {b.x, b.y, b.z};
        for (int axis = 0; axis < 3; ++axis) {
            node.low[axis] = std::min(node.low[axis], at[axis] - b.r);
            node.high[axis] = std::max(node.high[axis], at[axis] + b.r);
        }
    }
    double size = 0;
    for (int axis = 0; axis < 3; ++axis) size += std::abs(node.low[axis]) + std::abs(node.high[axis]);
    for (int axis = 0; axis < 3; ++axis) {
        node.low[axis] -= rounding * size;
        node.high[axis] += rounding * size;
    }
    const auto me = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
    if (end - begin <= leaf_size) {
        nodes_[me].begin = begin;
        nodes_[me].end = end;
        return me;
    }
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
        if (node.high[a] - node.low[a] > node.high[axis] - node.low[axis]) axis = a;
    }
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                         const auto along = [&](const Ball& ball) {
                             return axis == 0 ? ball.x : axis == 1 ? ball.y : ball.z;
                         };
                         return along(ball_[a]) < along(ball_[b]);
                     });
    build(begin, middle);
    const std::uint32_t second = build(middle, end);
    nodes_[me].second = second;
    return me;
}

std::uint32_t Reach::collect(const Eigen::Vector3d& p, double within,
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
    std::uint32_t stack[64];
    std::uint32_t depth = 0;
    stack[depth++] = 0;
    const double limit = slack * slack;
    while (depth > 0) {
        const std::uint32_t at = stack[--depth];
        const Node& node = nodes_[at];
        const double x = std::max(std::max(node.low[0] - px, px - node.high[0]), 0.0);
        const double y = std::max(std::max(node.low[1] - py, py - node.high[1]), 0.0);
        const double z = std::max(std::max(node.low[2] - pz, pz - node.high[2]), 0.0);
        if (!(x * x + y * y + z * z < limit)) continue;
        if (node.end > node.begin) {
            for (std::uint32_t i = node.begin; i < node.end; ++i) {
                if (near(item_balls_[i]) && in_tree_[items_[i]] && n < out.size()) out[n++] = items_[i];
            }
        } else {
            stack[depth++] = at + 1;
            stack[depth++] = node.second;
        }
    }
    return n;
}

}  // namespace knurl::detail
