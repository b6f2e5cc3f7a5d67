// `knurl as`: a program that knows nothing of Knurl, started by a person.

#include "../apps/program.hpp"
#include "served.hpp"

namespace lookalike_test {
namespace {

using knurl::test::Background;
using knurl::test::knurl_program;
using knurl::test::Outcome;

class As : public Served {};

std::vector<std::string> as_dhd(std::vector<std::string> options, std::vector<std::string> words) {
    std::vector<std::string> all{knurl_program(), "as", "dhd"};
    all.insert(all.end(), options.begin(), options.end());
    all.emplace_back("--");
    all.insert(all.end(), words.begin(), words.end());
    return all;
}

TEST_F(As, a_program_in_c_springs_and_is_killed) {
    Background program(as_dhd({"--device", "right"}, {KNURL_LOOKALIKE_SPRING}));
    ASSERT_TRUE(program.says("opened Knurl cartesian3")) << program.said();
    // The hand is 2.3 cm away from the centre: 3.4 N, less what it yields.
    ASSERT_TRUE(until(
        *right_, [](const HandReport& r) { return is_active(r) && r.sent_force.y > 0.3; }, [] {}));
    EXPECT_EQ(program.end(SIGKILL), 128 + SIGKILL);
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return no_force(r) && r.state == DeviceState::idle; }, [] {}));
}

TEST_F(As, the_device_that_is_named_is_the_one_that_is_found) {
    Background program(as_dhd({"--device", "second=left", "--device", "right"}, {KNURL_LOOKALIKE_SPRING}));
    ASSERT_TRUE(program.says("opened Knurl premium15")) << program.said();
}

TEST_F(As, the_words_of_the_program_are_its_own) {
    const Outcome outcome =
        knurl::test::run(as_dhd({}, {"/bin/sh", "-c", "echo \"$@\"; exit 5", "sh", "--servo", "--help"}));
    EXPECT_EQ(outcome.code, 5);
    EXPECT_EQ(outcome.out, "--servo --help\n");
    EXPECT_EQ(outcome.err, "");
}

TEST_F(As, the_search_path_begins_with_the_look_alike) {
    ::setenv("LD_LIBRARY_PATH", "/opt/vendor/lib", 1);
    const Outcome outcome = knurl::test::run(
        as_dhd({}, {"/bin/sh", "-c", "echo $LD_LIBRARY_PATH; ls $FDSDK/lib/release/*/libdrd.so.3"}));
    ::unsetenv("LD_LIBRARY_PATH");
    EXPECT_EQ(outcome.out.find(KNURL_AS_DHD ":/opt/vendor/lib\n"), 0u) << outcome.out;
    EXPECT_NE(outcome.out.find("/libdrd.so.3"), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST_F(As, mistakes_are_told_in_one_line) {
    const auto line = [](const std::vector<std::string>& words, int code) {
        const Outcome outcome = knurl::test::run(words);
        EXPECT_EQ(outcome.code, code) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        return outcome.err;
    };
    EXPECT_NE(line(as_dhd({}, {"/no/such/program"}), 127).find("/no/such/program"), std::string::npos);
    EXPECT_NE(line(as_dhd({}, {"/etc/passwd"}), 126).find("cannot be started"), std::string::npos);
    EXPECT_NE(line(as_dhd({"--device", "rihgt"}, {"true"}), 1).find("right"), std::string::npos);
    EXPECT_NE(line(as_dhd({"--servo", "nobody"}, {"true"}), 1).find("nobody"), std::string::npos);
    EXPECT_NE(line(as_dhd({}, {}), 2).find("-- PROGRAM"), std::string::npos);
    EXPECT_NE(line({knurl_program(), "as", "dhd", "program"}, 2).find("program"), std::string::npos);
    EXPECT_NE(line({knurl_program(), "as"}, 2).find("dhd, hd"), std::string::npos);
}

}  // namespace
}  // namespace lookalike_test
