// knurl-feel as a person runs it.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <generators.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace {

using knurl::test::Background;
using knurl::test::Folder;
using knurl::test::run;
using testing::HasSubstr;

class FeelProgram : public testing::Test {
  protected:
    void SetUp() override {
        std::ostringstream obj;
        obj.precision(17);
        // In mm, which the file does not state.
        const knurl::test::MadeMesh ball = knurl::test::icosphere(4, 40);
        for (const auto& v : ball.vertices) obj << "v " << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
        for (const auto& t : ball.triangles)
            obj << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
        mesh_ = folder_.file("ball.obj", obj.str());
    }
    const Folder folder_;
    std::string mesh_;
};

TEST_F(FeelProgram, FeelsWithoutADeviceAndDrawsWhatItFelt) {
    const std::string picture = folder_.path("ball.png"), csv = folder_.path("ball.csv");
    const std::filesystem::path temporary = folder_.path("tmp");
    std::filesystem::create_directory(temporary);
    ::setenv("TMPDIR", temporary.c_str(), 1);
    const auto felt =
        run({KNURL_FEEL_PROGRAM, mesh_, "--demo", "--seconds", "1.5", "--picture", picture, "--csv", csv});
    ASSERT_EQ(felt.code, 0) << felt.err;
    EXPECT_THAT(felt.out, HasSubstr("5120 triangles"));
    EXPECT_THAT(felt.out, HasSubstr("the unit mm is a guess"));
    EXPECT_THAT(felt.out, HasSubstr("5120 faces"));
    EXPECT_THAT(felt.out, HasSubstr("0 contacts lost"));
    std::ifstream png(picture, std::ios::binary);
    std::string head(8, ' ');
    png.read(head.data(), 8);
    EXPECT_EQ(head, "\x89PNG\r\n\x1a\n");
    std::ifstream rows(csv);
    std::size_t count = 0;
    for (std::string line; std::getline(rows, line);) ++count;
    EXPECT_THAT(felt.out, HasSubstr("\n  " + std::to_string(count - 1) + " cycles, "))
        << "a row each, and a title";
    EXPECT_TRUE(std::filesystem::is_empty(temporary)) << "it leaves nothing behind";
    ::unsetenv("TMPDIR");
}

TEST_F(FeelProgram, AMaterialOfTheFileIsFeltAsSoftAsItIsWished) {
    folder_.file("m.mtl", "newmtl felt\nKd 1 0 0\n");
    const std::string soft =
        folder_.file("soft.obj", "mtllib m.mtl\nusemtl felt\n" + knurl::test::text_of_file(mesh_));
    const auto peak = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words = {KNURL_FEEL_PROGRAM, soft, "--demo", "--seconds", "1.5"};
        words.insert(words.end(), more.begin(), more.end());
        const auto felt = run(words);
        EXPECT_EQ(felt.code, 0) << felt.err;
        EXPECT_THAT(felt.out, testing::ContainsRegex("at most [0-9.e-]+e-1[0-9] N off"));
        const auto at = felt.out.find("peak ");
        return at == std::string::npos ? 0 : std::stod(felt.out.substr(at + 5));
    };
    const double hard = peak({});
    EXPECT_GT(hard, 0.5);
    const double softened = peak({"--material", "felt=0.25"});
    EXPECT_GT(softened, 0);
    // The hand is a spring too, so it goes deeper into the softer surface.
    EXPECT_LT(softened, 0.6 * hard);
}

TEST_F(FeelProgram, SaysWhatIsWrong) {
    ::setenv("KNURL_RUNTIME_DIR", folder_.path("").c_str(), 1);
    EXPECT_THAT(run({KNURL_FEEL_PROGRAM, mesh_, "--unit", "furlong"}).err, HasSubstr("furlong"));
    EXPECT_EQ(run({KNURL_FEEL_PROGRAM}).code, 2);
    EXPECT_EQ(run({KNURL_FEEL_PROGRAM, mesh_, "--servo", "a b"}).code, 2);
    EXPECT_THAT(run({KNURL_FEEL_PROGRAM, folder_.path("none.stl")}).err, HasSubstr("none.stl"));
    const auto alone = run({KNURL_FEEL_PROGRAM, mesh_, "--wait", "0"});
    EXPECT_EQ(alone.code, 1);
    EXPECT_THAT(alone.err, HasSubstr("knurld"));
    EXPECT_THAT(run({KNURL_FEEL_PROGRAM, mesh_, "--unit", "m", "--wait", "0"}).out,
                HasSubstr("is the unit right?"));
    EXPECT_THAT(run({KNURL_FEEL_PROGRAM, mesh_, "--demo", "--picture", "/nowhere/p.png"}).err,
                HasSubstr("/nowhere"));
}

}  // namespace
