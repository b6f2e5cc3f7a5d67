#pragma once
// Shared by the scene tests: wide numbers, probes, steps of 1 ms, random legal parameters of any kind.

#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include <knurl/reps/all.hpp>
#include <knurl/reps/scene.hpp>

#include "random_polygon.hpp"
#include "scene_pair.hpp"

namespace knurl::test {

using Vector = Eigen::Vector3d;

inline RealVector wide(const Vec3& v) {
    return {v.x, v.y, v.z};
}
inline RealVector wide(const Eigen::Vector3d& v) {
    return v.cast<Real>();
}

inline constexpr double dt = 1e-3;  // s
inline constexpr double infinity = std::numeric_limits<double>::infinity();

inline Scene make_scene(const Limits& limits = {}, FadePolicy fade = test_fade) {
    Scene scene({.representations = 64, .probes = 16}, limits);
    scene.set_fade(fade);
    return scene;
}

inline Probe at(const Vector& position, const Vector& velocity = Vector::Zero()) {
    Probe probe;
    probe.position = position;
    probe.velocity = probe.smooth_velocity = velocity;
    return probe;
}

/// The wrench after all changes have arrived.
inline Wrench settled(Scene& scene, const Probe& probe) {
    scene.settle();
    return scene.evaluate(probe, dt);
}

inline bool same_bits(const Wrench& a, const Wrench& b) {
    return std::memcmp(a.force.data(), b.force.data(), 3 * sizeof(double)) == 0 &&
           std::memcmp(a.torque.data(), b.torque.data(), 3 * sizeof(double)) == 0;
}

inline bool finite(const Wrench& w) {
    return w.force.allFinite() && w.torque.allFinite();
}

inline double get_real(const void* params, const Field& field) {
    double value;
    std::memcpy(&value, static_cast<const char*>(params) + field.offset, sizeof value);
    return value;
}
inline void set_real(void* params, const Field& field, double value, int component = 0) {
    std::memcpy(
        static_cast<char*>(params) + field.offset + sizeof value * static_cast<std::size_t>(component),
        &value, sizeof value);
}
/// A choice, an integer, or the number of points in use.
inline void set_whole(void* params, const Field& field, std::uint32_t value) {
    std::memcpy(static_cast<char*>(params) + field.offset + field.reals() * sizeof(double), &value,
                sizeof value);
}

/// Makes random parameters consistent where a kind requires more than ranges. Specialised by kinds whose
/// legal parameters are too rare for random search.
template <class R>
struct Agreeing {
    static void make([[maybe_unused]] Rng& rng, R& params) {
        if constexpr (requires { params.friction.static_; }) {
            if (params.friction.static_ != automatic)
                params.friction.static_ = std::max(params.friction.static_, params.friction.dynamic);
        }
        if constexpr (requires { params.asset; }) params.asset = 0;  // nothing was sent
        if constexpr (std::is_same_v<R, Polygon>) {  // a convex one of that size, at that distance
            const Vec3 any = params.vertices.at[0];
            const double most = 4e8;  // m: all corners stay within the range
            params.vertices =
                random_polygon(rng, std::min(std::abs(any.x), most), std::min(std::abs(any.y), most))
                    .vertices;
        }
    }
};

/// Values within the ranges of any kind's table of fields. `extreme`: up to their limits.
template <class R>
R random_values(Rng& rng, bool extreme) {
    R params{};
    for (const Field& field : Describe<R>::fields) {
        const auto number = [&] {
            if (extreme) {
                const int edge = between(rng, 0, 9);
                if (edge == 0 && std::isfinite(field.minimum)) return field.minimum;
                if (edge == 1 && std::isfinite(field.maximum)) return field.maximum;
                if (edge == 2 && field.infinity_allowed) return infinity;
                if (edge == 3 && field.automatic_allowed) return automatic;
            }
            double value = extreme ? scale(rng, 1e-9, 1e9) : scale(rng, 1e-3, field.unit == "s" ? 0.3 : 1.0);
            if (!extreme && field.unit == "N/m") value *= 2000;
            if (field.minimum < 0 && between(rng, 0, 1)) value = -value;
            return std::clamp(value, field.minimum, field.maximum);
        };
        using Type = Field::Type;
        const auto some = [&](std::uint32_t from, std::uint32_t to) {
            return static_cast<std::uint32_t>(between(rng, static_cast<int>(from), static_cast<int>(to)));
        };
        double square = 0;
        for (int i = 0; i < static_cast<int>(field.reals()); ++i) {
            const double value = number();
            set_real(&params, field, value, i);
            square += value * value;
        }
        if ((field.nonzero || field.type == Type::quaternion) && !(square >= 1e-12))
            set_real(&params, field, 1, 2);
        if (field.type == Type::choice)
            set_whole(&params, field, some(0, static_cast<std::uint32_t>(field.choices.size()) - 1));
        if (field.type == Type::integer)
            set_whole(&params, field,
                      static_cast<std::uint32_t>(
                          std::clamp<double>(some(0, 1u << 30), field.minimum, field.maximum)));
        if (field.type == Type::points) set_whole(&params, field, some(field.least, field.count));
    }
    return params;
}

/// Legal parameters of any kind.
template <class R>
R random_params(Rng& rng, bool extreme) {
    for (int tries = 0; tries < 10'000; ++tries) {
        R params = random_values<R>(rng, extreme);
        Agreeing<R>::make(rng, params);
        if (kinds()[kind_of<R>].validate(&params)) return params;
    }
    throw std::runtime_error("no legal parameters by chance; specialise Agreeing for " +
                             std::string(Describe<R>::name));
}

/// Every time in the parameters (recovery, duration) set to `seconds`, every choice to its first.
template <class R>
void set_times(R& params, double seconds) {
    for (const Field& field : Describe<R>::fields) {
        if (field.unit == "s") set_real(&params, field, seconds);
        if (field.type == Field::Type::choice) set_whole(&params, field, 0);
    }
}

}  // namespace knurl::test
