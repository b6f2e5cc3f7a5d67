#pragma once
// Takes an input apart, and moves hands on the shape that was made of it: every cycle is within its limits,
// and the contact is finite and on that shape.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include <knurl/geometry/asset.hpp>
#include <knurl/geometry/proxy.hpp>

#include "../../fuzz/require.hpp"

namespace knurl::fuzz {

/// After the end of the input it continues with random values, so that a few bytes make a mesh of many
/// vertices.
class Input {
  public:
    explicit Input(std::span<const std::uint8_t> bytes) : rest_(bytes) {
        for (const std::uint8_t byte : bytes) chance_ = (chance_ ^ byte) * 0x100000001b3;
    }
    template <class T>
    T next() {
        std::uint8_t bytes[sizeof(T)];
        for (std::uint8_t& byte : bytes) {
            if (rest_.empty()) {
                chance_ = chance_ * 6364136223846793005 + 1442695040888963407;
                byte = static_cast<std::uint8_t>(chance_ >> 56);
            } else {
                byte = rest_.front();
                rest_ = rest_.subspan(1);
            }
        }
        T value;
        std::memcpy(&value, bytes, sizeof value);
        return value;
    }

  private:
    std::span<const std::uint8_t> rest_;
    std::uint64_t chance_ = 0xcbf29ce484222325;
};

/// Maps a byte to a count that is mostly small: building n triangles that all cross takes n^2 or more, and a
/// fault among a hundred also shows among twenty.
inline unsigned count_of(std::uint8_t byte) {
    return byte < 252 ? byte % 20u : byte;
}

enum Form : unsigned { any_double, any_float, steps, far_steps };  // of a coordinate

inline double coordinate(Input& input, unsigned form) {
    switch (form) {
        case any_double:
            return input.next<double>();
        case any_float:
            return input.next<float>();
        // Few places, so that many vertices meet, and many triangles have no area or lie on each other.
        case steps:
            return input.next<std::int8_t>() / 8 * 0.01;
        default:
            return 1e6 + input.next<std::int8_t>() * 1e-5;
    }
}

inline void check(const Foot& foot, const Asset& asset, std::size_t triangles) {
    require(foot.point.allFinite() && foot.normal.allFinite() && std::isfinite(foot.depth),
            "a foot is finite");
    require(foot.depth >= 0, "a depth is not negative");
    require(std::fabs(foot.normal.norm() - 1) < 1e-6, "a normal has length 1");
    require(foot.face < asset.faces() && foot.triangle < triangles, "a foot is of the shape");
    require(shaded_normal(asset, foot).allFinite(), "a shaded normal is finite");
    const double slack = 1e-6 * (asset.high - asset.low).norm() + 1e-9 * asset.high.cwiseAbs().maxCoeff();
    require(((foot.point - asset.low).array() >= -slack).all() &&
                ((asset.high - foot.point).array() >= -slack).all(),
            "a foot lies in the shape's box");
}

inline void move_about(const Asset& asset, Input& input, double radius, std::size_t triangles) {
    const Eigen::Vector3d middle = (asset.low + asset.high) / 2, half = (asset.high - asset.low) / 2;
    const double size = half.norm();
    Proxy proxy;
    Eigen::Vector3d hand = asset.high + 0.1 * half;
    for (int cycle = 0; cycle < 60; ++cycle) {
        const auto how = input.next<std::uint8_t>();
        Eigen::Vector3d by;
        for (double& x : by) x = input.next<std::int8_t>() / 128.0;
        if (how < 8) {
            hand = middle + 1.5 * half.cwiseProduct(by);  // elsewhere at once
        } else if (how == 8) {
            hand[cycle % 3] = std::numeric_limits<double>::quiet_NaN();
        } else if (how == 9) {
            hand[cycle % 3] = std::numeric_limits<double>::infinity();
        } else if (how == 10) {
            hand *= 1e200;
        } else {
            hand += 0.05 * size * by;
        }
        Foot foot;
        Work work;
        if (how == 11) adopt(asset, proxy, hand, work);
        const bool touches = follow(asset, proxy, hand, radius, foot, work);
        require(work.faces <= max_walk_faces && work.sweeps <= max_sweeps &&
                    work.pieces <= max_pieces * max_sweeps && work.nodes <= max_nodes &&
                    work.fans <= max_fans && work.tangles <= max_tangles,
                "a cycle's work is bounded");
        if (touches) check(foot, asset, triangles);
        if (!hand.allFinite() || hand.cwiseAbs().maxCoeff() > 1e100) hand = middle + 0.6 * half;
    }
}

}  // namespace knurl::fuzz
