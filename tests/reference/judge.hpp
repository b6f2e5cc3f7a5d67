#pragma once
// Runs cases and keeps the worst. A case is a function of its seed alone: KNURL_SEED=n runs one again (with
// --gtest_filter for the kind), KNURL_LONG=1 runs a million of each kind, KNURL_FIRST=n begins at another
// seed.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/reps/scene.hpp>

#include "parameters.hpp"

namespace judge {

using exact::real;
using exact::Real;
using exact::tip_of;
using knurl::Limits;
using knurl::Probe;
using knurl::RepresentationId;
using knurl::Scene;
using knurl::Vec3;
using knurl::Wrench;
using Vector = Eigen::Vector3d;

inline exact::Device device_of(const Limits& limits) {
    return {limits.max_stiffness, limits.max_torsion, limits.mass, limits.lag, limits.period};
}

/// N s/m: the damping of a surface as applied, which is at most the device's bound.
inline double bounded(double damping, const Limits& limits) {
    return static_cast<double>(std::min(Real(damping), device_of(limits).damping()));
}

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// SplitMix64 (Steele, Lea & Flood, OOPSLA 2014): the same numbers with every standard library.
class Rng {
  public:
    explicit Rng(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53);
    }
    /// Uniform in the logarithm.
    double scale(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
    int between(int low, int high) {
        return low + static_cast<int>(bits() % static_cast<std::uint64_t>(high - low + 1));
    }
    bool one_in(int n) { return between(1, n) == 1; }
    template <class... T>
    double of(T... values) {
        const double all[] = {static_cast<double>(values)...};
        return all[between(0, sizeof...(T) - 1)];
    }
    Vector direction() {
        for (;;) {
            const Vector v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            const double n = v.norm();
            if (n > 0.1 && n <= 1) return v / n;
        }
    }
    Vector across(const Vector& n) {
        for (;;) {
            const Vector v = n.cross(direction());
            if (v.norm() > 0.1) return v.normalized();
        }
    }
    Eigen::Quaterniond orientation() {
        const Vector a = direction();
        const double half = uniform(-M_PI, M_PI) / 2, s = std::sin(half);
        return {std::cos(half), s * a.x(), s * a.y(), s * a.z()};
    }

  private:
    std::uint64_t state_;
};

/// What one case found, while it runs.
class Case {
  public:
    Case(const std::string& kind, std::uint64_t seed, bool replayed)
        : rng(mix(kind, seed)), replayed_(replayed) {}

    Rng rng;

    /// Compares |got - want| with the largest magnitude that enters; the bound is 1e-12. `width` (1 or less)
    /// is the sine of the sharpest corner: below 0.04 degrees the rounding of its planes (7e-16 together)
    /// moves the corner by more than the bound.
    void compare(const Vector& got, const exact::V& want, Real scale, Real width = 1) {
        compare_within(got, want, 0, scale, width);
    }
    void compare_within(const Vector& got, const exact::V& want, Real slack, Real scale, Real width = 1) {
        constexpr Real sharp = exact::pi / 180 * 0.04L;
        const Real allowed = scale * std::max(Real(1), sharp / width);
        const Real error = exact::length(real(got) - want) - slack;
        const Real relative = error <= 0 ? 0 : error / allowed;
        note(std::isfinite(relative) ? relative : INFINITY);
        if (replayed_) {
            std::printf(
                "  got  %.17g %.17g %.17g\n  want %.17Lg %.17Lg %.17Lg\n  relative %.3Lg of %.3Lg, width "
                "%.3Lg\n",
                got.x(), got.y(), got.z(), want.x, want.y, want.z, relative, allowed, width);
        }
    }
    void require(bool holds, const char* what) {
        if (holds) return;
        note(INFINITY);
        why_ = what;
        if (replayed_) std::printf("  violated: %s\n", what);
    }
    template <class... T>
    void say(const char* format, T... values) const {
        if (replayed_) std::printf(format, values...);
    }
    void skip() { counts_ = false; }

    bool replayed() const { return replayed_; }
    Real worst() const { return worst_; }
    bool counts() const { return counts_; }
    const std::string& why() const { return why_; }

  private:
    static std::uint64_t mix(const std::string& kind, std::uint64_t seed) {
        std::uint64_t h = 0xcbf29ce484222325u;  // FNV-1a
        for (const char c : kind) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
        return Rng(h ^ (seed * 0xd1342543de82ef95u)).bits();
    }
    void note(Real relative) { worst_ = std::max(worst_, relative); }

    bool replayed_, counts_ = true;
    Real worst_ = 0;
    std::string why_;
};

inline bool long_form() {
    return std::getenv("KNURL_LONG") != nullptr;
}

inline constexpr Real bound = 1e-12L;

/// Runs `share` cases of one kind (a million in the long form), prints the worst and fails if it exceeds the
/// bound.
inline void run(const std::string& kind, std::uint64_t share, const std::function<void(Case&)>& one,
                Real allowed = bound, std::uint64_t million = 1'000'000) {
    const auto number = [](const char* name) -> std::uint64_t {
        const char* text = std::getenv(name);
        return text ? std::strtoull(text, nullptr, 10) : 0;
    };
    const std::uint64_t only = number("KNURL_SEED");
    const std::uint64_t first = only ? only : std::max<std::uint64_t>(1, number("KNURL_FIRST"));
    const std::uint64_t many = only ? 1 : (long_form() ? million : share);
    std::uint64_t cases = 0, failures = 0, worst_seed = 0;
    Real worst = 0;
    for (std::uint64_t seed = first; seed < first + many; ++seed) {
        Case c(kind, seed, only != 0);
        one(c);
        if (!c.counts()) continue;
        ++cases;
        if (c.worst() > worst || worst_seed == 0) worst = c.worst(), worst_seed = seed;
        if (!(c.worst() <= allowed) && ++failures <= 5) {
            ADD_FAILURE() << kind << ": relative error " << static_cast<double>(c.worst()) << " " << c.why()
                          << "; again with KNURL_SEED=" << seed;
        }
    }
    std::printf("%-34s %9llu cases, worst relative error %8.2Lg (seed %llu)%s\n", kind.c_str(),
                static_cast<unsigned long long>(cases), worst, static_cast<unsigned long long>(worst_seed),
                failures ? "  FAILED" : "");
    if (failures) ADD_FAILURE() << kind << ": " << failures << " of " << cases << " cases";
}

inline Probe at(const Vector& position, const Vector& velocity = Vector::Zero()) {
    Probe p;
    p.position = position;
    p.velocity = p.smooth_velocity = velocity;
    return p;
}

/// Steps of the servo: none, tiny, usual, the longest.
inline double any_step(Rng& rng) {
    return rng.of(0.0, 1e-6, 1e-3, 1e-3, 0.05);
}

inline bool finite(const Wrench& w) {
    return w.force.allFinite() && w.torque.allFinite();
}

}  // namespace judge
