// The validity of a change: one answer and one sentence, for every caller.

#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <knurl/reps/all.hpp>
#include <knurl/reps/check.hpp>
#include <knurl/reps/describe.hpp>

using namespace knurl;
using Code = Verdict::Code;

namespace {

std::string refusal(const AddOptions& options) {
    return describe(check_options(options), kind_of<Plane>, "floor");
}
std::string refusal(std::uint32_t probe, const ProbePlacement& placement) {
    return describe(check_placement(probe, placement), kind_of<Plane>, "");
}

const double not_a_number = std::nan("");
constexpr double inf = std::numeric_limits<double>::infinity();

}  // namespace

TEST(Check, ARefusedUseIsNamedAsAFieldIs) {
    EXPECT_EQ(refusal(AddOptions{.probe = 16}),
              "floor: plane.probe = 16: there is no such probe; give 0 to 15");
    EXPECT_EQ(refusal(AddOptions{.on_silence = static_cast<OnSilence>(7)}),
              "floor: plane.on_silence = 7 is none of its choices; give one of fade hold move");
    EXPECT_EQ(refusal(AddOptions{.silence_time = -1}),
              "floor: plane.silence_time = -1 s is out of range; give a value of 0 s or more");
    EXPECT_EQ(refusal(AddOptions{.silence_time = not_a_number}),
              "floor: plane.silence_time = nan is not a finite number; give a value of 0 s or more");
    EXPECT_EQ(describe(check_options({.probe = 2}, 2), Representations::size, ""),
              "representation.probe = 2: there is no such probe; give 0 to 1");
}

TEST(Check, ARefusedPlacementIsOfTheProbe) {
    EXPECT_EQ(refusal(16, {}), "probe = 16: there is no such probe; give 0 to 15");
    EXPECT_EQ(
        refusal(0, {.offset = {0, 2e9, 0}}),
        "probe.offset = 2000000000 m is out of range; give components from -1000000000 to 1000000000 m");
    EXPECT_EQ(refusal(0, {.offset = {}, .radius = -1}),
              "probe.radius = -1 m is out of range; give a value from 0 to 1000000000 m");
    EXPECT_EQ(refusal(0, {.offset = {}, .radius = inf}),
              "probe.radius = inf is not a finite number; give a value from 0 to 1000000000 m");
}

TEST(Check, WhatIsAddedIsCheckedWhole) {
    Plane plane{.stiffness = 100};
    const auto check = [&](Kind kind, std::size_t bytes, const AddOptions& options) {
        return check_added(kind, &plane, bytes, options);
    };
    EXPECT_TRUE(check(kind_of<Plane>, sizeof plane, {}));
    EXPECT_EQ(check(kind_of<Plane>, sizeof plane, {.silence_time = -1}).code, Code::out_of_range);
    EXPECT_EQ(check(kind_of<Plane>, sizeof plane - 8, {}).code, Code::wrong_size);
    EXPECT_EQ(check(Representations::size, sizeof plane, {}).code, Code::unknown_kind);
    plane.stiffness = -5;
    const Verdict verdict = check(kind_of<Plane>, sizeof plane, {});
    EXPECT_EQ(verdict.code, Code::out_of_range);
    EXPECT_EQ(Describe<Plane>::fields[verdict.field].name, "stiffness");
}

/// The same rules, written out, at their limits and far beyond; and a scene's answer equals the check's.
TEST(Check, IsTheRuleSpelledOut) {
    constexpr std::uint64_t seed = 26;
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const auto any = [&] {
        const double few[] = {0, -0.0, 1, -1, 1e9, -1e9, 1e308, -1e308, inf, -inf, not_a_number, 0.1};
        const double one = few[random() % std::size(few)];
        return random() % 8 == 0 ? std::nextafter(one, random() % 2 == 0 ? inf : -inf) : one;
    };
    const auto within = [](double value, double least, double most) {
        return !std::isfinite(value)           ? Code::not_finite
               : value < least || value > most ? Code::out_of_range
                                               : Code::ok;
    };
    Scene scene({.representations = 1, .probes = 5}, {});
    int accepted = 0;
    for (int i = 0; i < 20'000; ++i) {
        const AddOptions options{.probe = static_cast<std::uint32_t>(random() % 7),
                                 .on_silence = static_cast<OnSilence>(random() % 4),
                                 .silence_time = any()};
        Code code = options.probe >= 5 ? Code::no_such_probe
                    : static_cast<std::uint32_t>(options.on_silence) >= 3
                        ? Code::no_such_choice
                        : within(options.silence_time, 0, inf);
        ASSERT_EQ(check_options(options, 5).code, code) << options.silence_time;
        const Verdict added = scene.add({0, 1}, Plane{}, options);
        ASSERT_EQ(added.code, code);
        if (added) {
            ASSERT_TRUE(scene.remove({0, 1}));
        }

        const auto probe = static_cast<std::uint32_t>(random() % 7);
        const ProbePlacement placement{.offset = {any(), any(), any()}, .radius = any()};
        code = probe >= 5 ? Code::no_such_probe : Code::ok;
        for (const double value : {placement.offset.x, placement.offset.y, placement.offset.z})
            if (code == Code::ok) code = within(value, -1e9, 1e9);
        if (code == Code::ok) code = within(placement.radius, 0, 1e9);
        ASSERT_EQ(check_placement(probe, placement, 5).code, code);
        ASSERT_EQ(scene.place_probe(probe, placement).code, code);
        accepted += added && code == Code::ok;
    }
    EXPECT_GT(accepted, 20) << "both of them";
}

TEST(Check, ASlotIsVacantOrNamedOrNeither) {
    struct Slot {
        bool present;
        std::uint32_t generation;
    };
    const std::array<Slot, 3> slots{Slot{true, 4}, Slot{false, 4}, Slot{true, 1}};
    for (std::uint32_t slot = 0; slot < 5; ++slot)
        for (std::uint32_t generation = 0; generation < 6; ++generation) {
            const RepresentationId id{slot, generation};
            const bool inside = slot < 3;
            EXPECT_EQ(check_vacant(id, slots).code, !inside               ? Code::too_many
                                                    : slots[slot].present ? Code::slot_in_use
                                                                          : Code::ok);
            const bool named = inside && slots[slot].present && slots[slot].generation == generation;
            EXPECT_EQ(check_named(id, slots).code, named ? Code::ok : Code::no_such_slot);
        }
    EXPECT_EQ(check_vacant({7, 1}, slots).value, 3) << "so many there are";
}
