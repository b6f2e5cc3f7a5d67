// Field tables: what a refusal says, and that two builds that differ know it.

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

TEST(Fields, EveryVerdictOfEveryKindIsOneLine) {
    for (Kind kind = 0; kind <= kinds().size(); ++kind) {
        for (std::uint32_t code = 0; code <= static_cast<std::uint32_t>(Verdict::Code::refused); ++code) {
            for (const std::uint32_t field : {0u, 1u, Verdict::no_field}) {
                const std::string text = describe({static_cast<Verdict::Code>(code), field, 3}, kind, "");
                EXPECT_FALSE(text.empty());
                EXPECT_EQ(text.find('\n'), std::string::npos) << text;
            }
        }
    }
}

TEST(Fields, TheManualListsEveryRepresentationAndEachOfItsKeysWithItsUnit) {
    std::ifstream file(KNURL_REPS_README);
    const std::string manual((std::istreambuf_iterator<char>(file)), {});
    ASSERT_FALSE(manual.empty()) << KNURL_REPS_README;
    for (const KindInfo& kind : kinds()) {
        const std::size_t begin = manual.find("### `" + std::string(kind.name) + "`");
        ASSERT_NE(begin, std::string::npos) << kind.name;
        const std::string chapter = manual.substr(begin, manual.find("\n##", begin + 1) - begin);
        for (const Field& field : kind.fields) {
            const std::string row = "| `" + std::string(field.name) + "` | " + std::string(field.unit);
            EXPECT_NE(chapter.find(row), std::string::npos)
                << kind.name << ": no row that starts with " << row;
        }
    }
}

TEST(Fields, TheLayoutHashIsTheSameInEveryRunOfABuild) {
    EXPECT_EQ(layout_hash(), layout_hash());
    EXPECT_NE(layout_hash(), 0u);
}
