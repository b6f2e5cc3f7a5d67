// Effects that are out of reach, or whose force is zero, are not evaluated. The wrench equals, to the last
// bit, that of a model that evaluates all of them in every cycle.

#include <functional>

#include <gtest/gtest.h>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace evaluated_effects_tests {
namespace {

constexpr std::uint32_t slots = 24;
const Limits limits{.max_stiffness = 2000, .max_force = 4, .max_torque = 0.3};

struct Held {
    alignas(16) std::array<std::byte, max_parameter_bytes> params{};
    alignas(16) std::array<std::byte, max_state_bytes> state{};
    double weight = 1;
};

/// The model's table of a kind.
struct Effects {
    std::size_t size = 0;
    double (*time)(const Held&) = nullptr;                    // s, of its fade
    bool (*unchanged)(const void* raw, Held& now) = nullptr;  // except for another recovery
    void (*adopt)(const void* raw, Held& now, const Held* previous) = nullptr;
    Wrench (*evaluate)(Held&, const Probe&, double dt) = nullptr;
    bool (*carry)(Held& old, const Held& next) = nullptr;
    bool (*arrived)(const Held&) = nullptr;
};

template <class R>
R& params_of(Held& held) {
    return *reinterpret_cast<R*>(held.params.data());
}
template <class R>
const R& params_of(const Held& held) {
    return *reinterpret_cast<const R*>(held.params.data());
}
template <class R>
typename R::State& state_of(Held& held) {
    return *reinterpret_cast<typename R::State*>(held.state.data());
}
template <class R>
const typename R::State& state_of(const Held& held) {
    return *reinterpret_cast<const typename R::State*>(held.state.data());
}

template <class R>
Effects effects_of() {
    Effects e{.size = sizeof(R)};
    if constexpr (Effect<R>) {
        e.time = [](const Held& held) {
            const R& p = params_of<R>(held);
            double time = automatic;
            if constexpr (requires { p.recovery; }) time = p.recovery;
            if constexpr (requires { p.duration; }) time = p.duration;
            return time == automatic ? 0.01 : time;
        };
        e.unchanged = [](const void* raw, Held& now) {
            R params;
            std::memcpy(&params, raw, sizeof params);
            params = prepared(params, limits);
            [[maybe_unused]] const R evaluated = params;
            if constexpr (requires { params.recovery; }) params.recovery = params_of<R>(now).recovery;
            if (std::memcmp(&params, now.params.data(), sizeof params) != 0) return false;
            if constexpr (requires { params.recovery; }) params_of<R>(now).recovery = evaluated.recovery;
            return true;
        };
        e.adopt = [](const void* raw, Held& now, const Held* previous) {
            R params;
            std::memcpy(&params, raw, sizeof params);
            if (!previous) new (now.state.data()) typename R::State{};
            params = prepared(params, limits);
            std::memcpy(now.params.data(), &params, sizeof params);
            adopt(params_of<R>(now), previous ? &params_of<R>(*previous) : nullptr, state_of<R>(now),
                  Probe{});
        };
        e.evaluate = [](Held& held, const Probe& probe, double step) {
            return evaluate(params_of<R>(held), state_of<R>(held), probe, step);
        };
        e.carry = [](Held& old, const Held& next) {
            if constexpr (requires { carried(params_of<R>(old), params_of<R>(next)); }) {
                const R params = carried(params_of<R>(old), params_of<R>(next));
                std::memcpy(old.params.data(), &params, sizeof params);
                old.state = next.state;
            }
            return std::memcmp(old.params.data(), next.params.data(), sizeof(R)) == 0;
        };
        e.arrived = [](const Held& held) {
            if constexpr (requires { arrived(params_of<R>(held), state_of<R>(held)); })
                return arrived(params_of<R>(held), state_of<R>(held));
            return true;
        };
    }
    return e;
}
template <class... R>
std::vector<Effects> effects_in(TypeList<R...>) {
    return {effects_of<R>()...};
}
const std::vector<Effects> kinds_of_effects = effects_in(Representations{});

/// Evaluates all of them, in the scene's order: those that fade, then kind by kind.
class Exhaustive {
  public:
    struct Slot {
        bool felt = false, listed = false, carries = false;
        Kind kind = 0, old_kind = 0;
        AddOptions options;
        Held now, old;
        enum class From { none, nothing, record, frozen } from = From::none;
        double elapsed = 0, time = 0, gain = 1;
        Wrench frozen, remnant, last;
    };
    std::array<Slot, slots> slot;
    double silence = 0;

    void put(std::uint32_t i, Kind kind, const void* raw, const AddOptions& options) {
        Slot& s = slot[i];
        const Effects& e = kinds_of_effects[kind];
        const bool same = s.felt;
        if (same && e.unchanged(raw, s.now)) return;
        Held previous = s.now;
        const Kind previous_kind = s.kind;
        s.kind = kind;
        s.options = options;
        if (!same) s.now = Held{};
        e.adopt(raw, s.now, same ? &previous : nullptr);
        if (!same) list_.push_back(i);
        s.felt = true;
        if (same && e.carry(previous, s.now)) {
            if (s.from == Slot::From::record && s.carries) e.carry(s.old, s.now);
            return;
        }
        change(s, i, same, same, previous, previous_kind, e.time(s.now));
    }
    void remove(std::uint32_t i) {
        Slot& s = slot[i];
        s.felt = false;
        const auto at = std::find(list_.begin(), list_.end(), i);
        *at = list_.back();
        list_.pop_back();
        change(s, i, true, false, s.now, s.kind, kinds_of_effects[s.kind].time(s.now));
    }
    Wrench evaluate(const Probe& hand, double step) {
        if (step > 0) {
            for (const std::uint32_t i : list_) advance(slot[i].now, slot[i].options, step);
            for (const std::uint32_t i : fading_) {
                if (slot[i].from == Slot::From::record) advance(slot[i].old, slot[i].options, step);
            }
        }
        Wrench sum;
        for (std::size_t f = 0; f < fading_.size();) {
            Slot& s = slot[fading_[f]];
            s.elapsed += step;
            if (s.elapsed >= s.time * (1 - 1e-9)) {
                s.from = Slot::From::none;
                s.gain = 1;
                s.remnant = s.last = Wrench{};
                fading_[f] = fading_.back();
                fading_.pop_back();
                continue;
            }
            s.gain = s.elapsed / s.time;
            s.remnant = Wrench{};
            if (s.from == Slot::From::record) {
                s.remnant = ((1 - s.gain) * s.old.weight) *
                            bounded(kinds_of_effects[s.old_kind].evaluate(
                                s.old, hand, own_step(s.old, s.options, kinds_of_effects[s.old_kind], step)));
            } else if (s.from == Slot::From::frozen) {
                s.remnant = (1 - s.gain) * s.frozen;
            }
            s.last = s.remnant;
            sum += s.remnant;
            ++f;
        }
        for (Kind kind = 0; kind < kinds_of_effects.size(); ++kind) {
            for (const std::uint32_t i : list_) {
                Slot& s = slot[i];
                if (s.kind != kind) continue;
                const Effects& e = kinds_of_effects[kind];
                s.last = (s.gain * s.now.weight) *
                         bounded(e.evaluate(s.now, hand, own_step(s.now, s.options, e, step)));
                sum += s.last;
                if (s.from != Slot::From::none) s.last += s.remnant;
            }
        }
        return sum;
    }
    const std::vector<std::uint32_t>& list() const { return list_; }

  private:
    void change(Slot& s, std::uint32_t i, bool was, bool same, const Held& previous, Kind previous_kind,
                double time) {
        if (s.from != Slot::From::none) {
            s.frozen = s.last;
            start(s, i, Slot::From::frozen, time);
        } else if (was) {
            s.old = previous;
            s.old_kind = previous_kind;
            s.carries = same;
            start(s, i, Slot::From::record, time);
        } else {
            start(s, i, Slot::From::nothing, time);
        }
    }
    void start(Slot& s, std::uint32_t i, Slot::From from, double time) {
        const bool listed = s.from != Slot::From::none;
        if (!(time > 0) && !listed) {
            s.gain = 1;
            return;
        }
        s.from = from;
        s.elapsed = 0;
        s.time = time;
        if (!listed) fading_.push_back(i);
    }
    void advance(Held& held, const AddOptions& options, double step) const {
        if (options.on_silence == OnSilence::hold) return;
        const double delay = options.on_silence == OnSilence::move ? options.silence_time : 0;
        const double to = silence > delay ? std::max(0.0, held.weight - step / 0.1)
                                          : std::min(1.0, held.weight + step / 0.05);
        held.weight = to < 1e-12 ? 0 : to > 1 - 1e-12 ? 1 : to;
    }
    double own_step(const Held& held, const AddOptions& options, const Effects& e, double step) const {
        const bool stands = held.weight == 0 || (silence > 0 && options.on_silence == OnSilence::hold);
        return stands && e.arrived(held) ? 0 : step;
    }
    static Vector bounded(const Vector& v, double largest) {
        const double square = v.squaredNorm();
        return square > largest * largest ? Vector(v * (largest / std::sqrt(square))) : v;
    }
    static Wrench bounded(const Wrench& w) {
        return {bounded(w.force, limits.max_force), bounded(w.torque, limits.max_torque)};
    }
    std::vector<std::uint32_t> list_, fading_;
};

/// Parameters of a kind that is often out of reach, or without force.
template <class R>
R some(Rng& rng) {
    R p = random_params<R>(rng, false);
    const bool nothing = between(rng, 0, 2) == 0;
    const double k = nothing ? 0 : uniform(rng, 10, 300);
    const Vec3 place = to_plain(uniform(rng, 0, 0.06) * direction(rng));
    if constexpr (requires {
                      p.stiffness;
                      p.damping;
                  })
        p.stiffness = k, p.damping = nothing ? 0 : 1;
    if constexpr (requires { p.angular_damping; }) p.damping = k / 100, p.angular_damping = k / 1e4;
    if constexpr (requires { p.amplitude; }) p.amplitude = k / 100;
    if constexpr (requires { p.mass; }) p.mass = k / 1000;
    if constexpr (requires {
                      p.origin;
                      p.radius;
                  })
        p.origin = place, p.radius = uniform(rng, 0.005, 0.02);
    if constexpr (requires { p.max_distance; }) {
        p.position = place;
        p.radius = uniform(rng, 0, 0.005);
        p.max_force = 0.1;
        p.max_distance = 0.1 / std::max(k, 10.0) + uniform(rng, 0.001, 0.01);
    }
    if constexpr (requires { p.force; }) {
        if (nothing) p.force = {};
    }
    if constexpr (requires { p.torque; }) {
        if (nothing) p.torque = {};
    }
    if constexpr (requires { p.jacobian; }) {
        for (double& entry : p.jacobian.at) entry = nothing ? 0 : uniform(rng, -30, 30);
        p.edge = between(rng, 0, 3) ? TaylorEdge::fade : TaylorEdge::hold;
    }
    if constexpr (requires { p.recovery; }) p.recovery = between(rng, 0, 4) ? uniform(rng, 0.001, 0.05) : 0;
    if constexpr (requires { p.duration; }) p.duration = between(rng, 0, 4) ? uniform(rng, 0.001, 0.3) : 0;
    return p;
}

struct Both {
    Scene scene{{.representations = slots, .probes = 1}, limits};
    Exhaustive model;
    std::array<std::uint32_t, slots> generation{};
    std::array<std::function<void(Rng&)>, slots> again;  // another update of it

    template <class R>
    void put(std::uint32_t i, Rng& rng, const AddOptions& options) {
        const R params = some<R>(rng);
        const RepresentationId id{i, generation[i]};
        ASSERT_TRUE(model.slot[i].felt ? scene.update(id, params) : scene.add(id, params, options));
        model.put(i, kind_of<R>, &params, options);
        again[i] = [this, i](Rng& random) { put<R>(i, random, model.slot[i].options); };
    }
    template <class... R>
    void put_any(TypeList<R...>, std::uint32_t i, Rng& rng) {
        const AddOptions options{.on_silence = static_cast<OnSilence>(between(rng, 0, 2)),
                                 .silence_time = 0.03};
        const auto which = static_cast<Kind>(between(rng, 0, static_cast<int>(sizeof...(R)) - 1));
        const auto take = [&]<class T>(std::type_identity<T>) {
            if constexpr (Effect<T>) {
                if (kind_of<T> != which) return;
                ++generation[i];
                put<T>(i, rng, options);
            }
        };
        (take(std::type_identity<R>{}), ...);
    }
    void change(Rng& rng) {
        const auto i = static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(slots) - 1));
        if (!model.slot[i].felt) return put_any(Representations{}, i, rng);
        if (between(rng, 0, 3) != 0) return again[i](rng);
        ASSERT_TRUE(scene.remove({i, generation[i]}));
        model.remove(i);
    }
};

TEST(AskedEffects, GiveWhatAllOfThemWouldGiveToTheLastBit) {
    long evaluated = 0, all = 0, felt = 0;
    for (std::uint64_t seed = 1; seed <= (long_form() ? 500u : 30u); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Rng rng(seed);
        Both both;
        both.scene.set_fade({.automatic = 0.01, .rise_speed = infinity});
        std::array<Feedback, slots> kept{}, anew{};
        std::array<std::uint64_t, 1> wholly{}, flags{};
        double silent = 0;
        Vector about = Vector::Zero();
        const double swift = scale(rng, 0.1, 20);
        for (int cycle = 0; cycle < 3000; ++cycle) {
            if (between(rng, 0, 20) == 0) {
                ASSERT_NO_FATAL_FAILURE(both.change(rng));
            }
            if (between(rng, 0, 500) == 0) silent = silent > 0 ? 0 : 1e-3;
            if (silent > 0) silent += 1e-3;
            both.scene.set_silence(silent);
            both.model.silence = silent;
            if (between(rng, 0, 400) == 0) about = uniform(rng, 0, 0.05) * direction(rng);
            const double t = 1e-3 * cycle * swift;
            Probe hand = at(about + 0.02 * Vector(std::sin(3 * t), std::cos(2 * t), std::sin(5 * t)),
                            0.1 * direction(rng));
            hand.orientation = Eigen::AngleAxisd(0.3 * std::sin(t), Vector::UnitX());
            const double step = between(rng, 0, 30) == 0 ? 0 : uniform(rng, 0.5e-3, 1.5e-3);
            const Wrench want = both.model.evaluate(hand, step), got = both.scene.evaluate(hand, step);
            ASSERT_EQ(got.force, want.force) << "cycle " << cycle;
            ASSERT_EQ(got.torque, want.torque) << "cycle " << cycle;
            felt += want.force != Vector::Zero();
            evaluated += both.scene.evaluated();
            all += static_cast<long>(both.model.list().size());
            // Kept feedback equals feedback made anew, for each effect.
            if (between(rng, 0, 5) == 0) continue;
            const std::size_t n = both.scene.feedback(kept, {.wholly = wholly, .flags = flags});
            ASSERT_EQ(n, both.scene.feedback(anew));
            ASSERT_EQ(n, both.model.list().size());
            for (std::size_t i = 0; i < n; ++i) {
                ASSERT_EQ(kept[i].id.slot, both.model.list()[i]);
                ASSERT_EQ(kept[i].wrench.force, both.model.slot[both.model.list()[i]].last.force)
                    << "cycle " << cycle;
                ASSERT_EQ(kept[i].wrench.torque, anew[i].wrench.torque);
                ASSERT_EQ(kept[i].flags, anew[i].flags) << "cycle " << cycle;
                ASSERT_EQ(kept[i].stiffness, anew[i].stiffness);
            }
        }
    }
    EXPECT_GT(felt, all / slots / 2) << "most cycles give a force";
    EXPECT_LT(evaluated, all * 3 / 4) << "and many are not evaluated";
    std::printf("evaluated %ld of %ld\n", evaluated, all);
}

TEST(AskedEffects, OfManyThatAreFarAwayNoneIsEvaluatedAndOfThoseAroundTheHandAFew) {
    Scene scene({.representations = 512, .probes = 1}, {});
    for (std::uint32_t i = 0; i < 512; ++i) {
        const Vec3 place{0.02 * (i % 8), 0.02 * (i / 8 % 8), 0.02 * (i / 64)};
        ASSERT_TRUE(scene.add(
            {i, 1}, Magnet{.position = place, .stiffness = 200, .max_force = 0.5, .max_distance = 0.008}));
    }
    settled(scene, at({-1, 0, 0}));
    for (int indexed = 0; indexed < 2; ++indexed) {
        if (indexed) scene.index();
        scene.evaluate(at({-1, 0, 0}), dt);
        EXPECT_EQ(scene.evaluated(), 0u);
        const double pull = scene.evaluate(at({0.041, 0.04, 0.04}), dt).force.x();
        EXPECT_NEAR(pull, -0.2, 1e-12);
        EXPECT_GE(scene.evaluated(), 1u);
        EXPECT_LE(scene.evaluated(), 8u);
    }
}

TEST(AskedEffects, OneThatReachesFarMakesTheOthersNoNearer) {
    Scene scene({.representations = 64, .probes = 1}, {});
    ASSERT_TRUE(scene.add({0, 1}, Taylor{.force = {1, 0, 0}, .radius = 1000}));
    for (std::uint32_t i = 1; i < 40; ++i)
        ASSERT_TRUE(
            scene.add({i, 1}, Magnet{.position = {0.1 * i, 0, 0}, .stiffness = 200, .max_force = 0.5}));
    settled(scene, {});
    for (int i = 0; i < 10; ++i) scene.evaluate(at({0, 0.05, 0}), dt);
    EXPECT_LE(scene.evaluated(), 8u);
}

TEST(AskedEffects, WhatASilenceHasTakenAwayIsNotEvaluatedUntilTheApplicationSpeaks) {
    Scene scene = make_scene();
    for (std::uint32_t i = 0; i < 8; ++i) ASSERT_TRUE(scene.add({i, 1}, ConstantForce{.force = {1, 0, 0}}));
    settled(scene, {});
    scene.evaluate({}, dt);
    EXPECT_EQ(scene.evaluated(), 8u);
    for (int i = 1; i <= 110; ++i) {
        scene.set_silence(i * dt);
        scene.evaluate({}, dt);
    }
    EXPECT_EQ(scene.evaluated(), 0u);
    scene.set_silence(0);
    EXPECT_NEAR(scene.evaluate({}, dt).force.x(), 8 * dt / 0.05, 1e-12) << "from the first cycle on";
    EXPECT_EQ(scene.evaluated(), 8u);
}

}  // namespace
}  // namespace evaluated_effects_tests
