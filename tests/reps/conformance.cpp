// The contract of every representation. A new one is tested when it is in the list knurl::Representations.

#include <array>
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include <knurl/reps/describe.hpp>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

template <class List>
struct Enrol;
template <class... R>
struct Enrol<TypeList<R...>> {
    using Types = testing::Types<R...>;
};

template <class R>
struct Conformance : testing::Test {
    static constexpr std::uint64_t seed = 12345;
    Rng rng{seed};
    static constexpr RepresentationId id{3, 9};
};
TYPED_TEST_SUITE(Conformance, Enrol<Representations>::Types);

// A probe that wanders about the origin.
Probe wander(Rng& rng, double size = 0.02) {
    Probe probe = at(size * direction(rng), 0.2 * direction(rng));
    probe.angular_velocity = direction(rng);
    probe.orientation =
        Eigen::Quaterniond(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1), 1).normalized();
    return probe;
}

}  // namespace

TYPED_TEST(Conformance, IsPlainDataThatMayCrossAProcessBoundary) {
    static_assert(std::is_trivially_copyable_v<TypeParam> && std::is_standard_layout_v<TypeParam>);
    static_assert(sizeof(TypeParam) <= max_parameter_bytes &&
                  sizeof(typename TypeParam::State) <= max_state_bytes);
    static_assert(Surface<TypeParam> != Effect<TypeParam>);
}

TYPED_TEST(Conformance, IsListedUnderItsName) {
    const KindInfo& kind = kinds()[kind_of<TypeParam>];
    EXPECT_EQ(kind.name, Describe<TypeParam>::name);
    EXPECT_EQ(kind.size, sizeof(TypeParam));
    EXPECT_EQ(kind.surface, Surface<TypeParam>);
}

TYPED_TEST(Conformance, ItsFieldsHaveNamesMeaningsAndPlacesOfTheirOwn) {
    std::set<std::string_view> names;
    std::set<std::size_t> offsets;
    for (const Field& field : Describe<TypeParam>::fields) {
        EXPECT_TRUE(names.insert(field.name).second) << field.name;
        EXPECT_TRUE(offsets.insert(field.offset).second) << field.name;
        EXPECT_FALSE(field.meaning.empty()) << field.name;
        EXPECT_LE(field.minimum, field.maximum) << field.name;
        if (field.type == Field::Type::choice) {
            EXPECT_FALSE(field.choices.empty()) << field.name;
        } else if (field.reals() > 0) {
            EXPECT_FALSE(field.unit.empty()) << field.name;
            EXPECT_TRUE(std::isfinite(field.minimum) && std::isfinite(field.maximum)) << field.name;
        }
    }
}

TYPED_TEST(Conformance, ItsDefaultsAreLegal) {
    const TypeParam defaults{};
    const Verdict verdict = kinds()[kind_of<TypeParam>].validate(&defaults);
    EXPECT_TRUE(verdict) << describe(verdict, kind_of<TypeParam>, "");
}

TYPED_TEST(Conformance, EveryIllegalValueIsRefusedByFieldAndChangesNothing) {
    Scene scene = make_scene();
    const TypeParam good = random_params<TypeParam>(this->rng, false);
    ASSERT_TRUE(scene.add(this->id, good));
    const Probe probe = at({0.001, 0.002, -0.003});
    settled(scene, probe);
    const Wrench before = scene.evaluate(probe, 0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::uint32_t f = 0; f < std::size(Describe<TypeParam>::fields); ++f) {
        const Field& field = Describe<TypeParam>::fields[f];
        const auto refused = [&](const TypeParam& params, const auto& value) {
            const Verdict verdict = scene.update(this->id, params);
            EXPECT_FALSE(verdict) << field.name << " = " << value;
            EXPECT_EQ(verdict.field, f) << field.name << " = " << value;
            EXPECT_FALSE(scene.add({7, 1}, params)) << field.name << " = " << value;
            return verdict.code;
        };
        if (field.reals() > 0) {
            std::vector<double> bad = {nan, -infinity};
            if (!field.infinity_allowed) bad.push_back(infinity);
            bad.push_back(std::nextafter(field.maximum, infinity));
            if (!(field.automatic_allowed && field.minimum == 0))
                bad.push_back(std::nextafter(field.minimum, -infinity));
            if (field.automatic_allowed) bad.push_back(-0.5);
            const std::size_t used = field.type == Field::Type::points ? 3 * field.least : field.reals();
            for (const double value : bad) {
                TypeParam params = good;
                set_real(&params, field, value, static_cast<int>(used) - 1);
                refused(params, value);
            }
        }
        std::vector<std::uint32_t> bad;
        if (field.type == Field::Type::choice) bad = {static_cast<std::uint32_t>(field.choices.size())};
        if (field.type == Field::Type::points) bad = {field.least - 1, field.count + 1};
        if (field.type == Field::Type::integer && std::isfinite(field.maximum))
            bad = {static_cast<std::uint32_t>(field.maximum) + 1};
        for (const std::uint32_t value : bad) {
            TypeParam params = good;
            set_whole(&params, field, value);
            const Verdict::Code code = refused(params, value);
            if (field.type == Field::Type::points) {
                EXPECT_EQ(code, Verdict::Code::count);
            }
        }
        if (field.nonzero || field.type == Field::Type::quaternion) {
            TypeParam params = good;
            for (int i = 0; i < static_cast<int>(field.reals()); ++i) set_real(&params, field, 1e-7 / 2, i);
            EXPECT_EQ(refused(params, "1e-7"), Verdict::Code::zero_vector);
        }
    }
    EXPECT_TRUE(same_bits(before, scene.evaluate(probe, 0)));
    EXPECT_EQ(scene.size(), 1u);
}

TYPED_TEST(Conformance, AChangeIsJudgedAsAllOfItWouldBe) {
    const KindInfo& kind = kinds()[kind_of<TypeParam>];
    const std::array<double, 8> odd = {
        std::numeric_limits<double>::quiet_NaN(), infinity, 1e300, -1, 0, 1e-9, 0.5, 5};
    Scene scene = make_scene();
    ASSERT_TRUE(scene.add(this->id, random_params<TypeParam>(this->rng, false)));
    int refused = 0;
    for (int round = 0; round < 5000; ++round) {
        TypeParam params = random_params<TypeParam>(this->rng, false);
        ASSERT_TRUE(scene.update(this->id, params));
        const TypeParam there = params, other = random_params<TypeParam>(this->rng, true);
        for (int changes = 0; changes < 1 + round % 3; ++changes) {
            const std::size_t word = this->rng() % (sizeof(TypeParam) / 8);
            const void* from = round % 2 ? static_cast<const void*>(&odd[this->rng() % odd.size()])
                                         : reinterpret_cast<const std::byte*>(&other) + 8 * word;
            std::memcpy(reinterpret_cast<std::byte*>(&params) + 8 * word, from, 8);
        }
        const Verdict whole = kind.validate(&params),
                      change = scene.check_update(this->id, kind_of<TypeParam>, &params, sizeof params);
        ASSERT_EQ(whole.code, change.code) << "seed " << this->seed << ", round " << round;
        ASSERT_EQ(whole.field, change.field);
        TypeParam moved = there;
        std::memcpy(static_cast<void*>(&moved), &params, geometry_bytes<TypeParam>());
        const Verdict moved_whole = kind.validate(&moved),
                      alone = scene.check_update(this->id, kind_of<TypeParam>, &params,
                                                 geometry_bytes<TypeParam>());
        ASSERT_EQ(moved_whole.code, alone.code) << "seed " << this->seed << ", round " << round;
        ASSERT_EQ(moved_whole.field, alone.field);
        refused += !whole;
    }
    EXPECT_GT(refused, 500);
}

// Geometry alone for surfaces, all fields for effects. The twin gets all bytes, with a different byte that
// has no meaning, so that it takes the long way.
TYPED_TEST(Conformance, AGeometrySentAloneIsFeltAsAllOfItWouldBe) {
    constexpr std::size_t geometry = geometry_bytes<TypeParam>();
    int touched = 0;
    for (int round = 0; round < 100; ++round) {
        Scene whole = make_scene(), part = make_scene();
        TypeParam params = random_params<TypeParam>(this->rng, false);
        for (Scene* scene : {&whole, &part}) ASSERT_TRUE(scene->add(this->id, params));
        for (int i = 0; i < 60; ++i) {
            const TypeParam other = random_params<TypeParam>(this->rng, false);
            if (i % 4 == 0) std::memcpy(static_cast<void*>(&params), &other, geometry);
            if constexpr (Surface<TypeParam>) {
                if (round % 2) params.velocity = {};
            }
            std::size_t bytes = geometry;
            if (i % 20 == 19) {
                params = other;
                bytes = sizeof params;
            }
            TypeParam anew = params;
            if constexpr (Surface<TypeParam>) anew.texture.reserved = static_cast<std::uint32_t>(i + 1);
            ASSERT_TRUE(whole.update(this->id, anew));
            ASSERT_TRUE(part.update(this->id, kind_of<TypeParam>, &params, bytes));
            const Probe probe = wander(this->rng);
            const Wrench want = whole.evaluate(probe, dt), got = part.evaluate(probe, dt);
            ASSERT_TRUE(same_bits(want, got))
                << "seed " << this->seed << " round " << round << " cycle " << i;
            touched += !want.force.isZero();
        }
    }
    if (!std::is_same_v<TypeParam, Shape>) {  // no mesh was sent: shapes_moving.cpp
        EXPECT_GT(touched, 500);
    }
}

TYPED_TEST(Conformance, ItsGeometryMayNotBeCut) {
    Scene scene = make_scene();
    const TypeParam params = random_params<TypeParam>(this->rng, false);
    ASSERT_TRUE(scene.add(this->id, params));
    std::string said;
    for (std::size_t bytes = 0; bytes <= sizeof params; bytes += 4) {
        const bool known = bytes == geometry_bytes<TypeParam>() || bytes == sizeof params;
        const Verdict verdict = scene.check_update(this->id, kind_of<TypeParam>, &params, bytes);
        ASSERT_EQ(verdict.code, known ? Verdict::Code::ok : Verdict::Code::wrong_size) << bytes << " bytes";
        if (!verdict) said = describe(verdict, kind_of<TypeParam>, "");
    }
    EXPECT_NE(
        said.find(std::to_string(sizeof params - 4) + " bytes instead of " + std::to_string(sizeof params)),
        std::string::npos)
        << said;
    if (Surface<TypeParam>) {
        EXPECT_NE(
            said.find("(or of " + std::to_string(geometry_bytes<TypeParam>()) + ", its geometry alone)"),
            std::string::npos)
            << said;
    }
    EXPECT_EQ(said.find('\n'), std::string::npos);
}

TYPED_TEST(Conformance, TheSameParametersSentAgainChangeNothingToTheBit) {
    for (int round = 0; round < 200; ++round) {
        Scene once = make_scene(), again = make_scene();
        TypeParam params = random_params<TypeParam>(this->rng, false);
        for (Scene* scene : {&once, &again}) ASSERT_TRUE(scene->add(this->id, params));
        for (int i = 0; i < 60; ++i) {
            if (i == 20) {  // also while a real change is still arriving
                params = random_params<TypeParam>(this->rng, false);
                for (Scene* scene : {&once, &again}) ASSERT_TRUE(scene->update(this->id, params));
            }
            ASSERT_TRUE(again.update(this->id, params));
            const Probe probe = wander(this->rng);
            ASSERT_TRUE(same_bits(once.evaluate(probe, dt), again.evaluate(probe, dt)))
                << "seed " << this->seed << " round " << round << " cycle " << i;
        }
    }
}

TYPED_TEST(Conformance, WithNoTimePassedTheWrenchIsTheSameAndNothingAdvances) {
    for (int round = 0; round < 200; ++round) {
        Scene plain = make_scene(), stopped = make_scene();
        for (Scene* scene : {&plain, &stopped}) {
            Rng same(this->seed + static_cast<std::uint64_t>(round));
            ASSERT_TRUE(scene->add(this->id, random_params<TypeParam>(same, false)));
        }
        for (int i = 0; i < 40; ++i) {
            if (i == 15) {
                const TypeParam params = random_params<TypeParam>(this->rng, false);
                for (Scene* scene : {&plain, &stopped}) ASSERT_TRUE(scene->update(this->id, params));
            }
            const Probe probe = wander(this->rng);
            const Wrench w = stopped.evaluate(probe, dt);
            ASSERT_TRUE(same_bits(w, plain.evaluate(probe, dt)))
                << "seed " << this->seed << " round " << round << " cycle " << i;
            for (int k = 0; k < 3; ++k) ASSERT_TRUE(same_bits(w, stopped.evaluate(probe, 0)));
        }
    }
}

TYPED_TEST(Conformance, NoFiniteParametersGiveAnythingButAFiniteBoundedWrench) {
    const int rounds = long_form() ? 200'000 : 4'000;
    for (int round = 0; round < rounds; ++round) {
        Limits limits;
        const bool limited = between(this->rng, 0, 1);
        if (limited) limits = {.max_stiffness = 3000, .max_force = 8.5, .max_torque = 0.4};
        Scene scene = make_scene(limits);
        ASSERT_TRUE(scene.add(this->id, random_params<TypeParam>(this->rng, true), {.probe = 1}));
        ASSERT_TRUE(scene.place_probe(1, {.offset = {0.01, 0, 0}, .radius = round % 3 ? 0 : 0.005}));
        for (int i = 0; i < 12; ++i) {
            if (i % 4 == 3) {
                ASSERT_TRUE(scene.update(this->id, random_params<TypeParam>(this->rng, true)));
            }
            Probe probe = wander(this->rng, between(this->rng, 0, 3) ? 0.02 : scale(this->rng, 1e-12, 1e11));
            const double step =
                std::array{0.0, 1e-6, 1e-3, 0.05}[static_cast<std::size_t>(between(this->rng, 0, 3))];
            const Wrench w = scene.evaluate(probe, step);
            ASSERT_TRUE(finite(w)) << "seed " << this->seed << " round " << round << " cycle " << i;
            if (limited) {
                ASSERT_LE(w.force.norm(), limits.max_force * (1 + 1e-12)) << "round " << round;
                // The arm of the probe adds its own torque to the clamped one.
                ASSERT_LE(w.torque.norm(), (limits.max_torque + 0.01 * limits.max_force) * (1 + 1e-12));
            }
        }
    }
}

TYPED_TEST(Conformance, AProbeThatIsNowhereFeelsNothingAndLeavesNoTrace) {
    Scene scene = make_scene(), twin = make_scene();
    const TypeParam params = random_params<TypeParam>(this->rng, false);
    for (Scene* s : {&scene, &twin}) ASSERT_TRUE(s->add(this->id, params));
    const Probe probe = at({0.001, 0, -0.001});
    for (int i = 0; i < 30; ++i) {
        ASSERT_TRUE(same_bits(scene.evaluate(probe, dt), twin.evaluate(probe, dt)));
        for (const double nonsense : {std::numeric_limits<double>::quiet_NaN(), infinity, 1e300}) {
            EXPECT_EQ(scene.evaluate(at({nonsense, 0, 0}), dt).force.norm(), 0.0);
            EXPECT_EQ(scene.evaluate(at({0, 0, 0}, {0, nonsense, 0}), dt).force.norm(), 0.0);
        }
    }
}

TYPED_TEST(Conformance, TheSameHistoryGivesTheSameBits) {
    const auto run = [&](std::uint64_t start) {
        Rng random(start);
        Scene scene = make_scene();
        std::vector<Wrench> out;
        EXPECT_TRUE(scene.add(this->id, random_params<TypeParam>(random, false)));
        for (int i = 0; i < 300; ++i) {
            if (i % 37 == 0) {
                EXPECT_TRUE(scene.update(this->id, random_params<TypeParam>(random, false)));
            }
            out.push_back(scene.evaluate(wander(random), dt));
        }
        return out;
    };
    const auto first = run(5), second = run(5);
    for (std::size_t i = 0; i < first.size(); ++i) ASSERT_TRUE(same_bits(first[i], second[i])) << i;
}

TYPED_TEST(Conformance, ComesAndGoesWithoutAJolt) {
    constexpr double time = 0.02;  // s
    for (int round = 0; round < 300; ++round) {
        TypeParam params = random_params<TypeParam>(this->rng, false);
        set_times(params, time);
        // A moving surface drags what holds the tip to it: a force with history, tested in tangential.cpp.
        if constexpr (requires { params.velocity; }) params.velocity = {};
        const Probe probe = wander(this->rng);  // held still
        // the same, there from the start: it moves by itself, too
        Scene reference = make_scene();
        ASSERT_TRUE(reference.add(this->id, params));
        reference.settle();
        Scene scene = make_scene();
        Vector last = Vector::Zero(), last_full = Vector::Zero();
        for (int i = 0; i < 60; ++i) {
            const Vector full = reference.evaluate(probe, dt).force;
            const double motion = i == 0 ? 0 : (full - last_full).norm();
            const double allowed = (full.norm() * dt / time + motion) * (1 + 1e-9) + 1e-12;
            last_full = full;
            if (i == 0) {
                ASSERT_TRUE(scene.add(this->id, params));
            }
            if (i == 30) {
                ASSERT_TRUE(scene.remove(this->id));
            }
            const Vector force = scene.evaluate(probe, dt).force;
            ASSERT_LE((force - last).norm(), allowed)
                << "seed " << this->seed << " round " << round << " cycle " << i;
            last = force;
            if (i == 25) {
                ASSERT_NEAR((force - full).norm(), 0, 1e-9 * full.norm());
            }
        }
        ASSERT_EQ(last.norm(), 0.0);
    }
}

// held_in_silence.cpp tests surfaces, since the scene moves these.
template <class... Lists>
struct Joined {
    using Type = testing::Types<>;
};
template <class... A, class... B, class... Rest>
struct Joined<testing::Types<A...>, testing::Types<B...>, Rest...> {
    using Type = typename Joined<testing::Types<A..., B...>, Rest...>::Type;
};
template <class... A>
struct Joined<testing::Types<A...>> {
    using Type = testing::Types<A...>;
};
template <class List>
struct EffectsOf;
template <class... R>
struct EffectsOf<TypeList<R...>> {
    using Types =
        typename Joined<std::conditional_t<Effect<R>, testing::Types<R>, testing::Types<>>...>::Type;
};
template <class R>
struct EffectConformance : Conformance<R> {};
TYPED_TEST_SUITE(EffectConformance, EffectsOf<Representations>::Types);

// An effect's own time belongs to the scene. Where a silence holds the effect, its force stays. Where it
// fades, the force is the undisturbed one times its weight, and then zero for ever.
TYPED_TEST(EffectConformance, DoesNotGrowWhileItsApplicationIsSilent) {
    constexpr double wait = 0.03;  // s
    for (int round = 0; round < 100; ++round) {
        const TypeParam params = random_params<TypeParam>(this->rng, false);
        const Probe probe = wander(this->rng);  // held still
        Scene speaking = make_scene(), fades = make_scene(), moves = make_scene(), holds = make_scene();
        const auto add = [&](Scene& scene, OnSilence on_silence) {
            ASSERT_TRUE(scene.add(this->id, params, {.on_silence = on_silence, .silence_time = wait}));
            scene.settle();
        };
        add(speaking, OnSilence::fade);
        add(fades, OnSilence::fade);
        add(moves, OnSilence::move);
        add(holds, OnSilence::hold);
        Wrench last;
        for (int i = 0; i < 37; ++i) {
            last = holds.evaluate(probe, dt);
            for (Scene* scene : {&speaking, &fades, &moves}) scene->evaluate(probe, dt);
        }
        for (int i = 1; i <= 400; ++i) {
            for (Scene* scene : {&fades, &moves, &holds}) scene->set_silence(i * dt);
            const Wrench would = speaking.evaluate(probe, dt);
            const Vector faded = fades.evaluate(probe, dt).force, moved = moves.evaluate(probe, dt).force;
            const double slack = 1e-10 * would.force.norm();
            const double share = std::max(0.0, 1 - i / 100.0),
                         later = std::clamp(1 - (i - wait / dt) / 100.0, 0.0, 1.0);
            ASSERT_LE((faded - share * would.force).norm(), slack)
                << "seed " << this->seed << " round " << round << " cycle " << i;
            ASSERT_LE((moved - later * would.force).norm(), slack)
                << "seed " << this->seed << " round " << round << " cycle " << i;
            ASSERT_TRUE(same_bits(holds.evaluate(probe, dt), last))
                << "seed " << this->seed << " round " << round << " cycle " << i;
        }
        // It continues from there.
        fades.set_silence(0);
        holds.set_silence(0);
        Scene twin = make_scene();
        add(twin, OnSilence::fade);
        for (int i = 0; i < 37; ++i) twin.evaluate(probe, dt);
        for (int i = 0; i < 20; ++i)
            ASSERT_TRUE(same_bits(holds.evaluate(probe, dt), twin.evaluate(probe, dt)))
                << "seed " << this->seed << " round " << round << " cycle " << i;
    }
}
