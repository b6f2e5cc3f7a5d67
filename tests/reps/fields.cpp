// Field tables: the text of a refusal, and the detection of different builds.

#include <algorithm>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include <knurl/reps/describe.hpp>

#include "scene_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {
std::string refusal(const Plane& plane) {
    return describe(validate_fields(Describe<Plane>::fields, &plane), kind_of<Plane>, "floor");
}
}  // namespace

TEST(Fields, TheFirstOffendingFieldIsNamed) {
    const Plane plane{.offset = infinity, .stiffness = -1};
    const Verdict verdict = validate_fields(Describe<Plane>::fields, &plane);
    EXPECT_EQ(verdict.code, Verdict::Code::not_finite);
    EXPECT_EQ(verdict.field, 1u);
    EXPECT_EQ(verdict.value, infinity);
}

TEST(Fields, InfiniteStiffnessAndAutomaticRecoveryAreLegal) {
    const Plane plane{.stiffness = infinity, .recovery = automatic};
    EXPECT_TRUE(validate_fields(Describe<Plane>::fields, &plane));
}

TEST(Fields, ARefusalIsOneLineWithWhereWhatTheRangeAndTheRemedy) {
    EXPECT_EQ(refusal({.stiffness = -5}),
              "floor: plane.stiffness = -5 N/m is out of range; give a value from 0 to 1000000000 N/m, or "
              "infinity for "
              "as stiff as the device allows");
    EXPECT_EQ(refusal({.normal = {0, 0, 0}}),
              "floor: plane.normal has length 0 and so no direction; give a length of 1e-06 or more");
    EXPECT_EQ(
        refusal({.recovery = -2}),
        "floor: plane.recovery = -2 s is out of range; give a value from 0 to 1000 s, or leave it out for "
        "automatic");
    EXPECT_EQ(refusal({.update = static_cast<PlaneUpdate>(7)}),
              "floor: plane.update = 7 is none of its choices; give one of fade paper last_depth");
    EXPECT_NE(refusal({.offset = std::nan("")}).find("plane.offset = nan is not a finite number"),
              std::string::npos);
}

TEST(Fields, AContradictionSaysItsReasonAfterTheValue) {
    const Plane plane{.stiffness = 1, .friction = {.static_ = 0.2, .dynamic = 0.3}};
    const KindInfo& kind = kinds()[kind_of<Plane>];
    const Verdict verdict = kind.validate(&plane);
    EXPECT_EQ(verdict.code, Verdict::Code::contradiction);
    ASSERT_LT(verdict.reason, kind.contradictions.size());
    EXPECT_EQ(describe(verdict, kind_of<Plane>, "floor"),
              "floor: plane.friction.static = 0.2 is below friction.dynamic; give at least as much");
}

namespace {
// A kind with a field of every type.
struct Sample {
    Mat3 matrix = {};
    Quat turn = {};
    Vec3 corners[5] = {};
    std::uint32_t used = 3;
    std::uint32_t seed = 1;
    std::uint32_t dots = 3;
    std::uint32_t reserved = 0;
};
constexpr Field sample_fields[] = {
    {.name = "matrix",
     .type = Field::Type::matrix,
     .offset = offsetof(Sample, matrix),
     .unit = "N/m",
     .minimum = -100,
     .maximum = 100,
     .count = 3},
    {.name = "turn",
     .type = Field::Type::quaternion,
     .offset = offsetof(Sample, turn),
     .unit = "1",
     .minimum = -10,
     .maximum = 10},
    {.name = "corners",
     .type = Field::Type::points,
     .offset = offsetof(Sample, corners),
     .unit = "m",
     .minimum = -2,
     .maximum = 2,
     .count = 5,
     .least = 3},
    {.name = "seed", .type = Field::Type::integer, .offset = offsetof(Sample, seed)},
    {.name = "dots",
     .type = Field::Type::integer,
     .offset = offsetof(Sample, dots),
     .minimum = 1,
     .maximum = 9},
};

std::string refusal(const Sample& sample) {
    const KindInfo kind{.name = "sample",
                        .fields = sample_fields,
                        .size = sizeof(Sample),
                        .geometry_bytes = sizeof(Sample),
                        .surface = false,
                        .validate = nullptr,
                        .contradictions = {}};
    return describe(validate_fields(sample_fields, &sample), &kind, "");
}

template <class Change>
std::string refusal_after(Change change) {
    Sample sample;
    change(sample);
    return refusal(sample);
}
}  // namespace

TEST(Fields, EachEntryOfAMatrixIsChecked) {
    for (int i = 0; i < 9; ++i) {
        EXPECT_EQ(refusal_after([&](Sample& s) { s.matrix.at[i] = -100.5; }),
                  "sample.matrix = -100.5 N/m is out of range; give entries from -100 to 100 N/m");
    }
    EXPECT_EQ(refusal_after([](Sample& s) { s.matrix.at[8] = -100; }), "sample: accepted");
}

TEST(Fields, AQuaternionMayHaveAnyLengthButNone) {
    EXPECT_EQ(refusal_after([](Sample& s) { s.turn = {0, 0, 0, 3}; }), "sample: accepted");
    EXPECT_EQ(refusal_after([](Sample& s) {
                  s.turn = {0, 0, 0, 0};
              }),
              "sample.turn has length 0 and so no orientation; give a length of 1e-06 or more");
    EXPECT_EQ(refusal_after([](Sample& s) { s.turn.z = infinity; }),
              "sample.turn = inf is not a finite number; give components from -10 to 10");
}

TEST(Fields, OnlyThePointsInUseAreChecked) {
    EXPECT_EQ(refusal_after([](Sample& s) { s.corners[2].z = 3; }),
              "sample.corners = 3 m is out of range; give components from -2 to 2 m");
    EXPECT_EQ(refusal_after([](Sample& s) { s.corners[3].x = std::nan(""); }), "sample: accepted");
    EXPECT_EQ(refusal_after([](Sample& s) { s.used = 5, s.corners[4].z = -3; }),
              "sample.corners = -3 m is out of range; give components from -2 to 2 m");
    EXPECT_EQ(refusal_after([](Sample& s) { s.used = 2; }), "sample.corners has 2 points; give from 3 to 5");
    EXPECT_EQ(refusal_after([](Sample& s) { s.used = 0xffffffff; }),
              "sample.corners has 4294967295 points; give from 3 to 5");
}

TEST(Fields, AnIntegerIsAnyUnlessItHasARange) {
    EXPECT_EQ(refusal_after([](Sample& s) { s.seed = 0xffffffff; }), "sample: accepted");
    EXPECT_EQ(refusal_after([](Sample& s) { s.dots = 10; }),
              "sample.dots = 10 is out of range; give a whole number from 1 to 9");
}

TEST(Fields, TheLayoutKnowsHowManyBytesAFieldHas) {
    const std::size_t expected[] = {72, 32, 5 * 24 + 4, 4, 4};
    for (std::size_t i = 0; i < std::size(sample_fields); ++i)
        EXPECT_EQ(sample_fields[i].bytes(), expected[i]) << sample_fields[i].name;
}

TEST(Fields, EveryVerdictOfEveryKindIsOneLine) {
    for (Kind kind = 0; kind <= kinds().size(); ++kind) {
        for (std::uint32_t code = 0; code <= static_cast<std::uint32_t>(Verdict::Code::count); ++code) {
            for (const std::uint32_t field :
                 {0u, 1u, Verdict::of_options, Verdict::of_options + 2, Verdict::of_options + 3,
                  Verdict::of_placement, Verdict::of_placement + 2, Verdict::no_field}) {
                const std::string text = describe({static_cast<Verdict::Code>(code), field, 3}, kind, "");
                EXPECT_FALSE(text.empty());
                EXPECT_EQ(text.find('\n'), std::string::npos) << text;
            }
        }
    }
}

namespace {

std::string manual() {
    std::ifstream file(KNURL_REPS_README);
    return std::string((std::istreambuf_iterator<char>(file)), {});
}

/// The section with a heading that begins so, up to the next heading.
std::string section(const std::string& manual, const std::string& heading) {
    const std::size_t begin = manual.find("\n### " + heading);
    if (begin == std::string::npos) return {};
    return manual.substr(begin, manual.find("\n##", begin + 1) - begin);
}

std::string kind_section(const std::string& manual, const KindInfo& kind) {
    return section(manual, std::string("`").append(kind.name) + "`");
}

/// The keys in the first column of its table.
std::vector<std::string> keys_of(const std::string& section) {
    std::vector<std::string> keys;
    for (std::size_t at = section.find("\n| `"); at != std::string::npos; at = section.find("\n| `", at + 1))
        keys.push_back(section.substr(at + 4, section.find('`', at + 4) - at - 4));
    return keys;
}

bool has_key(const KindInfo& kind, const std::string& key) {
    return std::any_of(kind.fields.begin(), kind.fields.end(),
                       [&](const Field& field) { return field.name == key; });
}

}  // namespace

TEST(Fields, TheManualListsEveryRepresentationAndEachOfItsKeysWithItsUnit) {
    const std::string text = manual();
    ASSERT_FALSE(text.empty()) << KNURL_REPS_README;
    const std::string every_surface = section(text, "Every surface");
    for (const KindInfo& kind : kinds()) {
        const std::string own = kind_section(text, kind);
        EXPECT_FALSE(own.empty()) << kind.name << ": no section";
        for (const Field& field : kind.fields) {
            const std::string row = std::string("\n| `").append(field.name).append("` | ").append(field.unit);
            EXPECT_TRUE(own.find(row) != std::string::npos ||
                        (kind.surface && every_surface.find(row) != std::string::npos))
                << kind.name << ": no row that starts with " << row;
        }
    }
}

TEST(Fields, TheManualListsNoKeyThatIsNotThere) {
    const std::string text = manual();
    for (const KindInfo& kind : kinds()) {
        for (const std::string& key : keys_of(kind_section(text, kind)))
            EXPECT_TRUE(has_key(kind, key)) << kind.name << " has no " << key;
        if (!kind.surface) continue;
        for (const std::string& key : keys_of(section(text, "Every surface")))
            EXPECT_TRUE(has_key(kind, key)) << kind.name << " lacks " << key;
    }
}

TEST(Fields, TheLayoutHashIsTheSameInEveryRunOfABuild) {
    EXPECT_EQ(layout_hash(), layout_hash());
    EXPECT_NE(layout_hash(), 0u);
}
