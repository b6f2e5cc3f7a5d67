#include "paths.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace knurl::test {

using exact::Real;
using exact::V;

namespace {

std::array<double, 3> plain(const V& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
V anywhere(Rng& rng) {
    return {between(rng, -1, 1), between(rng, -1, 1), between(rng, -1, 1)};
}

/// A path through all corners, with one position per cycle, each a step from the last.
Hand along(const std::vector<V>& corners, double step) {
    Hand hand;
    Real left = 0;  // to go before the next place
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
        const V way = corners[i + 1] - corners[i];
        const Real far = exact::length(way);
        Real at = left;
        for (; at < far; at += step) hand.push_back(plain(corners[i] + at / far * way));
        left = at - far;
    }
    hand.push_back(plain(corners.back()));
    return hand;
}

}  // namespace

Hands::Hands(const MadeMesh& shape, std::uint64_t seed) : shape_(&shape), rng_(seed) {
    const std::size_t vertices = shape.vertices.size();
    vertex_normal_.resize(vertices);
    rise_.assign(vertices, -1e9L);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    low_ = high_ = shape.at(shape.triangles[0][0]);
    for (std::size_t i = 0; i < shape.triangles.size(); ++i) {
        const V n = normal(i);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = shape.triangles[i][k], b = shape.triangles[i][(k + 1) % 3];
            vertex_normal_[a] += n;
            ++edges[std::minmax(a, b)];
            const V p = shape.at(a);
            low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
            high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), std::max(high_.z, p.z)};
        }
    }
    unit_ = static_cast<double>(exact::length(high_ - low_)) / 0.2;
    std::vector<std::uint32_t> rim;
    for (const auto& [edge, count] : edges) {
        if (count == 1) rim.push_back(edge.first);
        for (const auto& [from, to] : {edge, std::pair(edge.second, edge.first)}) {
            const V way = shape.at(to) - shape.at(from);
            const V n = vertex_normal_[from];
            if (exact::length(n) > 0) {
                rise_[from] = std::max(rise_[from], dot(exact::unit(way), exact::unit(n)));
            }
        }
    }
    for (std::size_t i = 0; i < shape.triangles.size(); ++i) {
        const auto near = [&](std::uint32_t v) {
            return exact::length(middle(i) - shape.at(v)) < 0.004L * unit_;
        };
        if (std::none_of(rim.begin(), rim.end(), near)) triangles_.push_back(i);
    }
}

V Hands::middle(std::size_t i) const {
    return (1 / Real(3)) * (shape_->corner(i, 0) + shape_->corner(i, 1) + shape_->corner(i, 2));
}
V Hands::normal(std::size_t i) const {
    const V a = shape_->corner(i, 0);
    const V n = cross(shape_->corner(i, 1) - a, shape_->corner(i, 2) - a);
    return exact::length(n) > 0 ? exact::unit(n) : V{};
}
std::size_t Hands::any_triangle() {
    return triangles_[below(rng_, triangles_.size())];
}

Hand Hands::follow_surface(double lowest, double highest) {
    std::vector<std::size_t> over{any_triangle()};
    for (const std::size_t points = 3 + below(rng_, 4); over.size() < points;) {
        std::size_t next = over.back();
        for (int attempt = 0; attempt < 400; ++attempt) {
            const std::size_t i = any_triangle();
            const Real far = exact::length(middle(i) - middle(over.back()));
            if (far > 0.004L * unit_ && far < 0.04L * unit_ && dot(normal(i), normal(over.back())) > 0.2L) {
                next = i;
                break;
            }
        }
        over.push_back(next);
    }
    std::vector<V> corners{middle(over[0]) + 0.0015L * unit_ * normal(over[0])};
    for (const std::size_t i : over) {
        corners.push_back(middle(i) + between(rng_, lowest, highest) * unit_ * normal(i));
    }
    corners.push_back(middle(over.back()) + 0.0015L * unit_ * normal(over.back()));
    return along(corners, between(rng_, 0.0001, 0.0003) * unit_);
}

Hand Hands::poke() {
    const std::size_t i = any_triangle();
    const V way = exact::unit(normal(i) + 0.4L * anywhere(rng_)), across = 0.3L * exact::across(way);
    const double depth = between(rng_, 0.001, 0.003) * unit_, times = between(rng_, 2, 8);
    Hand hand;
    for (int k = 0; k <= 400; ++k) {
        const double phase = 2 * M_PI * times * k / 400;
        hand.push_back(plain(middle(i) + (depth * std::cos(phase) - 0.0002 * unit_) * way +
                             0.001L * unit_ * std::sin(0.37 * phase) * across));
    }
    return hand;
}

Hand Hands::around_an_edge() {
    Real sharpest = 2;
    V at, along_it;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> seen;
    const std::size_t first = below(rng_, triangles_.size());
    for (std::size_t k = 0; k < std::min<std::size_t>(triangles_.size(), 400); ++k) {
        const std::size_t i = triangles_[(first + k) % triangles_.size()];
        for (std::size_t e = 0; e < 3; ++e) {
            const std::uint32_t a = shape_->triangles[i][e], b = shape_->triangles[i][(e + 1) % 3];
            const auto [found, fresh] = seen.try_emplace(std::minmax(a, b), i);
            if (fresh) continue;
            const Real together = dot(normal(i), normal(found->second));
            if (together > sharpest - 0.01L && between(rng_, 0, 1) < 0.5) continue;
            if (together > sharpest + 0.01L) continue;
            sharpest = together;
            at = 0.5L * (shape_->at(a) + shape_->at(b)),
            along_it = exact::unit(shape_->at(b) - shape_->at(a));
        }
    }
    const V x = exact::across(along_it), y = cross(along_it, x);
    const double radius = between(rng_, 0.0005, 0.003) * unit_;
    const V off = 0.5L * radius * anywhere(rng_);
    Hand hand;
    for (int k = 0; k < 900; ++k) {
        const Real angle = 2 * exact::pi * k / 300;
        hand.push_back(plain(at + off + radius * (std::cos(angle) * x + std::sin(angle) * y) +
                             (1e-6L * unit_ * k) * along_it));
    }
    return hand;
}

Hand Hands::into_a_corner() {
    std::uint32_t deepest = shape_->triangles[any_triangle()][0];
    for (int k = 0; k < 200; ++k) {
        const std::uint32_t v = shape_->triangles[any_triangle()][below(rng_, 3)];
        if (rise_[v] > rise_[deepest]) deepest = v;
    }
    const V n = vertex_normal_[deepest];
    const V out = exact::length(n) > 0 ? exact::unit(n) : V{0, 0, 1};
    const V side = exact::unit(exact::across(out) + 0.3L * anywhere(rng_));
    Hand hand;
    for (int k = 0; k <= 600; ++k) {
        const double phase = 2 * M_PI * k / 600;
        hand.push_back(plain(shape_->at(deepest) + (0.002 * unit_ * std::cos(phase) - 0.0008 * unit_) * out +
                             0.0012L * unit_ * std::sin(7 * phase) * side));
    }
    return hand;
}

Hand Hands::teleports(int places, int cycles_each) {
    const V middle_of_all = 0.5L * (low_ + high_), half = 0.6L * (high_ - low_);
    Hand hand;
    for (int place = 0; place < places; ++place) {
        const V u = anywhere(rng_);
        const V at = middle_of_all + V{u.x * half.x, u.y * half.y, u.z * half.z};
        for (int k = 0; k < cycles_each; ++k) hand.push_back(plain(at));
    }
    return hand;
}

}  // namespace knurl::test
