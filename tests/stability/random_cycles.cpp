// knurl_random_cycles: random scenes of every kind of representation, random changes in every cycle, random
// hands.
//
//   knurl_random_cycles [--cycles 10000000] [--seed 1] [--threads 2]
//
// In no cycle may a wrench be anything but finite, or larger than the parts allow; a mass that a hand holds
// may not gather energy, and comes to rest on surfaces once nothing changes any more. Kinds, parameters and
// ranges come from the list of all.hpp and its tables of fields: a new kind is in here without a line. A
// failure prints the seed of its scene, which alone replays it.

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>

#include "../reps/scene_tools.hpp"

namespace {

using namespace knurl;
using namespace knurl::test;
using Eigen::Vector3d;

constexpr int scene_cycles = 2000, quiet_cycles = 1500;  // cycles with changes; then without, with a mass
                                                         // attached
constexpr std::uint32_t slots = 24;                      // at most

struct Params {
    alignas(16) std::array<std::byte, 512> bytes;
    std::size_t size;
};

template <class R>
Params random_of(Rng& rng, bool extreme) {
    const R params = random_params<R>(rng, extreme);
    Params out{.bytes = {}, .size = sizeof(R)};
    std::memcpy(out.bytes.data(), &params, sizeof params);
    return out;
}

/// Representations that may move for ever by themselves: a moving surface, planes that sum to any stiffness,
/// relief stiffer than its surface, a friction law that is not passive.
template <class R>
void calm(Params& params) {
    for (const Field& field : Describe<R>::fields) {
        if (field.name == "velocity")
            for (int i = 0; i < 3; ++i) set_real(params.bytes.data(), field, 0, i);
        if (field.name == "texture.amplitude") set_real(params.bytes.data(), field, 0);
        if (field.name == "combine" || field.name == "snag.law") set_whole(params.bytes.data(), field, 0);
    }
}

using Make = Params (*)(Rng&, bool);
using Calm = void (*)(Params&);
template <class... R>
constexpr auto makers(TypeList<R...>) {
    return std::array<Make, sizeof...(R)>{random_of<R>...};
}
template <class... R>
constexpr auto calmers(TypeList<R...>) {
    return std::array<Calm, sizeof...(R)>{calm<R>...};
}

bool finite_all(const Vector3d& v) {
    return v.allFinite();
}

Kind next_kind(Kind kind) {
    return static_cast<Kind>((kind + 1) % Representations::size);
}

/// One scene's life.
class Life {
  public:
    explicit Life(std::uint64_t seed)
        : rng_(seed),
          closed_(between(rng_, 0, 1) == 1),
          extreme_(!closed_ && between(rng_, 0, 1) == 1),
          surfaces_only_(closed_ && between(rng_, 0, 1) == 1),
          one_kind_(between(rng_, 0, 3) == 0),
          probes_(surfaces_only_ ? 1 : static_cast<std::uint32_t>(between(rng_, 1, 4))),
          limits_(random_limits()),
          scene_({.representations = slots, .probes = probes_}, limits_) {
        only_ = static_cast<Kind>(between(rng_, 0, static_cast<int>(Representations::size) - 1));
        while (surfaces_only_ && !kinds()[only_].surface) only_ = next_kind(only_);
        used_ = static_cast<int>(scale(rng_, 1, surfaces_only_ ? 4 : slots + 0.99));
        scene_.set_fade(
            {.automatic = 0.01, .rise_speed = surfaces_only_ || between(rng_, 0, 1) ? infinity : 0.1});
    }

    /// The error, or nothing. Adds its cycles to `cycles`.
    std::optional<std::string> run(std::uint64_t& cycles) {
        for (int i = 0; i < scene_cycles; ++i, ++cycles) {
            change();
            if (auto wrong = step(i)) return wrong;
        }
        if (!closed_) return {};
        // No more changes. Contradictory surfaces give bounded forces but need not come to rest; on one
        // surface, and on planes, a mass comes to rest. Curved surfaces that are solved with others act as
        // their tangent planes at the hand. Where these are nearly opposed the hand may be thrown back and
        // forth: bounded, so counted, not a failure.
        scene_.settle();
        scene_.set_silence(0);
        double fastest = 0;
        bool calm = surfaces_only_;
        for (int i = 0; i < quiet_cycles; ++i, ++cycles) {
            if (auto wrong = step(scene_cycles + i)) return wrong;
            if (i < quiet_cycles - 200) continue;
            fastest = std::max(fastest, velocity_.norm());
            const std::size_t count = scene_.feedback(feedback_);
            for (std::size_t f = 0; f < count; ++f)
                calm = calm && (feedback_[f].flags & (Feedback::fading | Feedback::infeasible)) == 0;
        }
        if (!calm) return {};
        rest_ = fastest <= 0.02 ? Rest::rests : Rest::restless;
        if (rest_ == Rest::restless && (scene_.size() == 1 || scene_.count(kind_of<Plane>) == scene_.size()))
            return fmt::format("nothing changes any more, and the mass still moves at {:.3f} m/s", fastest);
        return {};
    }

    /// The mass in the end: not tested; at rest; or still moving, between surfaces wedged against each other.
    enum class Rest { unasked, rests, restless };
    Rest rest() const { return rest_; }

    std::string kinds_present() const {
        std::string text;
        for (Kind k = 0; k < Representations::size; ++k)
            if (const auto n = scene_.count(k))
                text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, kinds()[k].name);
        return text + (closed_ ? "; a mass on it" : extreme_ ? "; extreme parameters" : "");
    }

  private:
    Limits random_limits() {
        if (closed_)  // the device of the stroke: half its k_max, to leave a margin for chance
            return {.max_stiffness = 1500,
                    .max_force = 8.5,
                    .max_torque = 0.3,
                    .damping = 0.2,
                    .mass = 0.1,
                    .lag = 0.53e-3};
        Limits limits{.max_force = scale(rng_, 0.1, 1e3), .max_torque = scale(rng_, 0.01, 10)};
        if (between(rng_, 0, 1))
            limits.max_stiffness = scale(rng_, 1, 1e6), limits.max_torsion = scale(rng_, 0.01, 10);
        if (between(rng_, 0, 1)) limits.damping = 0.2, limits.mass = scale(rng_, 0.01, 1), limits.lag = 1e-3;
        return limits;
    }

    Params make(Kind kind) {
        static constexpr auto make = makers(Representations{});
        static constexpr auto calm = calmers(Representations{});
        Params params = make[kind](rng_, extreme_);
        if (surfaces_only_) calm[kind](params);
        return params;
    }

    void change() {
        const auto slot = static_cast<std::uint32_t>(between(rng_, 0, used_ - 1));
        Kind kind = one_kind_
                        ? only_
                        : static_cast<Kind>(between(rng_, 0, static_cast<int>(Representations::size) - 1));
        while (surfaces_only_ && !kinds()[kind].surface) kind = next_kind(kind);
        const int what = between(rng_, 0, 99);
        Present& present = present_[slot];
        if (what < 60 && present.is) {
            const Params params = make(present.kind);
            (void)scene_.update({slot, present.generation}, present.kind, params.bytes.data(), params.size);
        } else if (what < 80) {
            const Params params = make(kind);
            const AddOptions use{
                .probe = static_cast<std::uint32_t>(between(rng_, 0, static_cast<int>(probes_) - 1)),
                .on_silence = static_cast<OnSilence>(between(rng_, 0, 2))};
            if (scene_.add({slot, present.generation + 1}, kind, params.bytes.data(), params.size, use))
                present = {true, present.generation + 1, kind};
        } else if (what < 90) {
            if (present.is && scene_.remove({slot, present.generation})) present.is = false;
        } else if (what < 93 && !surfaces_only_) {
            const auto probe = static_cast<std::uint32_t>(between(rng_, 0, static_cast<int>(probes_) - 1));
            (void)scene_.place_probe(probe, {.offset = {0.02 * uniform(rng_, -1, 1), 0, 0.01},
                                             .radius = between(rng_, 0, 1) ? 0.004 : 0});
        } else if (what < 95 && !closed_) {
            limits_ = random_limits();
            scene_.set_limits(limits_);
            largest_force_ = std::max(largest_force_, limits_.max_force);
        } else if (what < 97) {
            scene_.set_silence(between(rng_, 0, 2) ? 0 : 0.3);
        } else if (what == 97) {
            scene_.settle();
        } else if (what == 98 && between(rng_, 0, 20) == 0) {
            scene_.clear();
            for (Present& p : present_) p.is = false;
        }
    }

    std::optional<std::string> step(int cycle) {
        double dt = 1e-3;
        Probe hand;
        if (closed_) {
            hand.position = position_;
            hand.velocity = hand.smooth_velocity = filtered_;
        } else {
            dt = std::array{
                0.0, 1e-6, 1e-4, 1e-3, 1e-3, 2e-3, 0.05}[static_cast<std::size_t>(between(rng_, 0, 6))];
            if (between(rng_, 0, 49) == 0)
                position_ = scale(rng_, 1e-9, between(rng_, 0, 3) ? 0.1 : 1e12) * direction(rng_);
            position_ += 1e-3 * direction(rng_);
            hand.position = position_;
            hand.velocity = scale(rng_, 1e-6, 10) * direction(rng_);
            hand.smooth_velocity = scale(rng_, 1e-6, 10) * direction(rng_);
            hand.angular_velocity = direction(rng_);
            hand.orientation =
                Eigen::Quaterniond(uniform(rng_, -1, 1), uniform(rng_, -1, 1), uniform(rng_, -1, 1), 1)
                    .normalized();
        }
        const Wrench w = scene_.evaluate(hand, dt);
        if (!finite(w)) return fmt::format("cycle {}: the wrench is not finite", cycle);
        // Each probe's set and each effect is clamped; a fade started under larger limits may still hold
        // their force.
        const double allowed = largest_force_ * (probes_ + (surfaces_only_ ? 0 : slots));
        if (w.force.norm() > allowed * (1 + 1e-9))
            return fmt::format("cycle {}: {:g} N, where the clamps leave {:g} N", cycle, w.force.norm(),
                               allowed);
        if (cycle % 16 == 0) {
            const std::size_t count = scene_.feedback(feedback_);
            for (std::size_t i = 0; i < count; ++i)
                if (!finite(feedback_[i].wrench) || !finite_all(feedback_[i].contact_point) ||
                    !std::isfinite(feedback_[i].stiffness))
                    return fmt::format(
                        "cycle {}: the feedback of a {} is not finite: force {:g} {:g} {:g}, contact point "
                        "{:g} {:g} {:g}, stiffness {:g}",
                        cycle, kinds()[present_[feedback_[i].id.slot].kind].name,
                        feedback_[i].wrench.force.x(), feedback_[i].wrench.force.y(),
                        feedback_[i].wrench.force.z(), feedback_[i].contact_point.x(),
                        feedback_[i].contact_point.y(), feedback_[i].contact_point.z(),
                        feedback_[i].stiffness);
            if (!finite_all(scene_.contact_point()))
                return fmt::format("cycle {}: the contact point is not finite", cycle);
        }
        if (closed_) {
            Vector3d force = w.force;  // the supervisor's norm clamp
            if (force.norm() > limits_.max_force) force *= limits_.max_force / force.norm();
            move(force);
            const double energy = 0.5 * mass * velocity_.squaredNorm();
            // A hand of 200 N/m and 3.2 N s/m, driven at its resonance by 8.5 N to and fro: 3.4 m/s.
            if (!(energy < 1.0)) return fmt::format("cycle {}: the mass has {:g} J", cycle, energy);
        }
        return {};
    }

    static constexpr double mass = 0.15;  // kg

    /// 1 ms of the stroke's device and hand, held at the origin.
    void move(const Vector3d& force) {
        constexpr double h = 1e-4, follow = 0.1717;  // s; of a 300 Hz lag in 0.1 ms
        const Vector3d before = position_;
        for (int i = 0; i < 10; ++i) {
            exerted_ += follow * (force - exerted_);
            velocity_ += h / mass * (exerted_ - 200 * position_ - 3.2 * velocity_);
            position_ += h * velocity_;
        }
        filtered_ += 0.4665 * ((position_ - before) / 1e-3 - filtered_);  // first order 100 Hz
    }

    struct Present {
        bool is = false;
        std::uint32_t generation = 0;
        Kind kind = 0;
    };

    Rng rng_;
    bool closed_, extreme_, surfaces_only_, one_kind_;
    std::uint32_t probes_;
    Limits limits_;
    Scene scene_;
    double largest_force_ = limits_.max_force;
    Kind only_ = 0;
    int used_ = 1;  // slots
    Rest rest_ = Rest::unasked;
    std::array<Present, slots> present_{};
    std::vector<Feedback> feedback_{slots};
    Vector3d position_ = Vector3d::Zero(), velocity_ = Vector3d::Zero(), exerted_ = Vector3d::Zero(),
             filtered_ = Vector3d::Zero();
};

}  // namespace

int main(int argc, char** argv) {
    knurl::commandline::Command app(
        "knurl_random_cycles",
        "Random scenes, random changes in every cycle: never a NaN, never more force than the clamps leave.");
    std::uint64_t cycles = 10'000'000, seed = 1;
    int threads = 2;
    bool verbose = false;
    app.option("--cycles", cycles, "how many, in scenes of a few thousand");
    app.option("--seed", seed, "of the first scene; the next has the next");
    app.option("--threads", threads, "that live side by side").within(1, 256);
    app.flag("--verbose", verbose, "name the scenes in which the mass did not come to rest");
    app.action([&] {
        const auto begun = std::chrono::steady_clock::now();
        std::atomic<std::uint64_t> next = seed, done = 0;
        std::atomic<int> failures = 0, rested = 0, restless = 0;
        std::mutex mutex;
        const auto work = [&] {
            while (done < cycles && failures < 10) {
                const std::uint64_t mine = next++;
                Life life(mine);
                std::uint64_t lived = 0;
                const auto wrong = life.run(lived);
                done += lived;
                rested += life.rest() == Life::Rest::rests;
                restless += life.rest() == Life::Rest::restless;
                if (life.rest() == Life::Rest::restless && verbose) {
                    const std::lock_guard lock(mutex);
                    fmt::print("restless: {}: --seed {} --cycles 1\n", life.kinds_present(), mine);
                }
                if (!wrong) continue;
                ++failures;
                const std::lock_guard lock(mutex);
                fmt::print("FAILED: {}\n  scene: {}\n  replay: knurl_random_cycles --seed {} --cycles 1\n",
                           *wrong, life.kinds_present(), mine);
            }
        };
        std::vector<std::thread> others;
        for (int i = 1; i < threads; ++i) others.emplace_back(work);
        work();
        for (std::thread& thread : others) thread.join();
        const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        fmt::print("{} random cycles over {} scenes from seed {}, {} kinds: {} failures, {:.0f} s\n",
                   done.load(), next.load() - seed, seed, Representations::size, failures.load(), took);
        fmt::print(
            "masses on surfaces that no longer change: {} came to rest, {} were thrown to and fro between "
            "wedged "
            "ones\n",
            rested.load(), restless.load());
        return failures == 0 ? 0 : 1;
    });
    return knurl::commandline::run(app, argc, argv);
}
