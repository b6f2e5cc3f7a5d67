// Materials by name: legal, distinguishable by hand, and with effect only on how a surface feels.

#include <gtest/gtest.h>

#include <knurl/reps/all.hpp>
#include <knurl/reps/presets.hpp>

#include "friction_tools.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

struct Feel {
    double mean = 0, most = 0;  // N at 1 N, drawn 40 mm at 5 cm/s
    int knocks = 0;             // number of releases
};

Feel drawn_over(const Material& material) {
    Tip tip{friction_law(material.friction, material.snag, material.stiffness, {.max_stiffness = 3000})};
    Feel feel;
    bool sliding = false;
    for (int i = 0; i < 800; ++i) {
        const double force = -tip.go(5e-5 * i);
        feel.mean += force / 800;
        feel.most = std::max(feel.most, force);
        feel.knocks += tip.state.sliding && !sliding;
        sliding = tip.state.sliding;
    }
    return feel;
}

}  // namespace

TEST(Presets, AreAllThereAndLegalOnASurface) {
    ASSERT_EQ(preset_names().size(), 7u);
    for (const std::string_view name : preset_names()) {
        ASSERT_NE(preset(name), nullptr) << name;
        const Plane plane = made_of(*preset(name), Plane{});
        EXPECT_TRUE(validate_fields(Describe<Plane>::fields, &plane)) << name;
        EXPECT_TRUE(check_material(plane)) << name;
        EXPECT_GT(plane.stiffness, 0) << name;
    }
    for (const char* name : {"concrete", "sand", "rubber", "skin", "cloth", "ice", "sandpaper"})
        EXPECT_NE(preset(name), nullptr) << name;
    EXPECT_EQ(preset("Rubber"), nullptr);
    EXPECT_EQ(preset(""), nullptr);
}

TEST(Presets, SayHowASurfaceFeelsAndNotWhereItIs) {
    Plane plane{.normal = {1, 0, 0}, .offset = 0.2, .velocity = {0, 0.1, 0}, .recovery = 0.03};
    plane.snag.seed = 77;
    plane.texture.origin = {1, 2, 3};
    plane.texture.direction = {0, 1, 0};
    const Plane cloth = made_of(*preset("cloth"), plane);
    EXPECT_EQ(cloth.normal, plane.normal);
    EXPECT_EQ(cloth.offset, 0.2);
    EXPECT_EQ(cloth.recovery, 0.03);
    EXPECT_EQ(cloth.velocity, plane.velocity);
    EXPECT_EQ(cloth.snag.seed, 77u);
    EXPECT_EQ(cloth.texture.origin, plane.texture.origin);
    EXPECT_EQ(cloth.texture.direction, plane.texture.direction);
    EXPECT_EQ(cloth.texture.amplitude, preset("cloth")->texture.amplitude);
    EXPECT_EQ(cloth.friction.dynamic, preset("cloth")->friction.dynamic);
}

TEST(Presets, FeelDifferent) {
    const auto feel = [](std::string_view name) { return drawn_over(*preset(name)); };
    const Feel concrete = feel("concrete"), sand = feel("sand"), rubber = feel("rubber"), skin = feel("skin"),
               cloth = feel("cloth"), ice = feel("ice"), sandpaper = feel("sandpaper");
    EXPECT_LT(ice.most, 0.1);
    EXPECT_LT(ice.mean, cloth.mean / 5);
    EXPECT_LT(cloth.mean, skin.mean / 1.5);
    EXPECT_GT(rubber.most, 1);
    EXPECT_GT(rubber.mean, skin.mean * 1.2);
    // Grains: concrete knocks, sand crunches, sandpaper buzzes; a smooth material lets go once.
    EXPECT_NEAR(concrete.knocks, 20, 8);
    EXPECT_GT(sand.knocks, 1.5 * concrete.knocks);
    EXPECT_GT(sandpaper.knocks, 1.5 * sand.knocks);
    for (const Feel& smooth : {rubber, skin, cloth, ice}) EXPECT_EQ(smooth.knocks, 1);
    EXPECT_GT(sandpaper.mean, sand.mean);
}
