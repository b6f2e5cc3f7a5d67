#pragma once
// What the scene tests share: probes, steps of 1 ms, random legal parameters of any kind.

#include <cstring>
#include <limits>

#include <knurl/reps/scene.hpp>

#include "random_planes.hpp"

namespace knurl::test {

using Vector = Eigen::Vector3d;

inline constexpr double dt = 1e-3;  // s
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// No rise rule and automatic = 10 ms, unless a test says otherwise.
inline Scene make_scene(const Limits& limits = {},
                        FadePolicy fade = {.automatic = 0.01, .rise_speed = infinity}) {
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

/// The wrench after everything has arrived.
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
inline void set_choice(void* params, const Field& field, std::uint32_t value) {
    std::memcpy(static_cast<char*>(params) + field.offset, &value, sizeof value);
}

/// Legal parameters of any kind, from its table of fields alone. `extreme`: up to the ends of every range.
template <class R>
R random_params(Rng& rng, bool extreme) {
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
        if (field.type == Field::Type::real) set_real(&params, field, number());
        if (field.type == Field::Type::vector) {
            for (int i = 0; i < 3; ++i) set_real(&params, field, number(), i);
            double v[3];
            std::memcpy(v, reinterpret_cast<const char*>(&params) + field.offset, sizeof v);
            if (field.nonzero && std::hypot(v[0], v[1], v[2]) < 1e-6) set_real(&params, field, 1, 2);
        }
        if (field.type == Field::Type::choice) {
            set_choice(
                &params, field,
                static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(field.choices.size()) - 1)));
        }
    }
    return params;
}

/// Every time in the parameters (recovery, duration) set to `seconds`, every choice to its first.
template <class R>
void set_times(R& params, double seconds) {
    for (const Field& field : Describe<R>::fields) {
        if (field.unit == "s") set_real(&params, field, seconds);
        if (field.type == Field::Type::choice) set_choice(&params, field, 0);
    }
}

}  // namespace knurl::test
