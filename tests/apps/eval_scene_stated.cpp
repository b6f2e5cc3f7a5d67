// One representation's keys without a file, for tables of other formats.

#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include <knurl/reps/all.hpp>
#include <knurl/scenefile/scene_file.hpp>

namespace {

using namespace knurl;
using scenefile::read_stated;

template <class R>
R params_of(const scenefile::Stated& stated) {
    R params;
    EXPECT_EQ(stated.params.size(), sizeof params);
    std::memcpy(&params, stated.params.data(), sizeof params);
    return params;
}

std::string refusal(Kind kind, const std::string& keys) {
    try {
        read_stated(kind, keys);
    } catch (const scenefile::SceneError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Stated, keys_are_read_as_a_scene_file_reads_them) {
    const auto stated = read_stated(kind_of<Plane>,
                                    "id = \"floor\"\nmaterial = \"ice\"\nstiffness = 800\nnormal = [0, 0, "
                                    "2]\nfriction = {dynamic = 0.5}\n");
    const auto plane = params_of<Plane>(stated);
    EXPECT_EQ(stated.id, "floor");
    EXPECT_FALSE(stated.options);
    EXPECT_EQ(plane.stiffness, 800);
    EXPECT_EQ(plane.normal, (Vec3{0, 0, 2}));
    EXPECT_EQ(plane.friction.dynamic, 0.5);
    const auto same = scenefile::parse_scene(
        "[[plane]]\nmaterial = \"ice\"\nstiffness = 800\nnormal = [0, 0, 2]\nfriction.dynamic = 0.5\n", "s");
    EXPECT_EQ(stated.params, same.changes.at(0).params);
}

TEST(Stated, a_change_inherits_all_but_what_describes_a_change) {
    const auto first = read_stated(kind_of<Plane>, "stiffness = 800\nrecovery = 3\non_silence = \"hold\"\n");
    ASSERT_TRUE(first.options);
    EXPECT_EQ(first.options->on_silence, OnSilence::hold);
    const auto plane = params_of<Plane>(read_stated(kind_of<Plane>, "offset = 0.01\n", first.params));
    EXPECT_EQ(plane.stiffness, 800);
    EXPECT_EQ(plane.offset, 0.01);
    EXPECT_EQ(plane.recovery, automatic);
}

TEST(Stated, a_mistake_is_one_line_without_a_place) {
    EXPECT_EQ(refusal(kind_of<Plane>, "id = \"a:b\"\nstifness = 1\n"),
              "unknown key 'stifness' in plane 'a:b'; did you mean 'stiffness'?");
    EXPECT_EQ(refusal(kind_of<Plane>, "at = 1\n"), "'at' is a key of scene files alone");
    EXPECT_NE(refusal(kind_of<Plane>, "id = \"f\"\nstiffness = -1\n").find("-1"), std::string::npos);
    for (const char* wrong :
         {"stiffness = -1", "normal = [0, 0, 0]", "x", "= 1", "stiffness = \"1\"", "[a]\nb = 1"}) {
        const std::string text = refusal(kind_of<Plane>, wrong);
        EXPECT_EQ(text.find("-:"), std::string::npos) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        EXPECT_NE(text, "accepted") << wrong;
    }
}

}  // namespace
