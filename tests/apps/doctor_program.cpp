// `knurl doctor`: the form of its output. No test depends on the quality of the machine.

#include <cstdint>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/json/json.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using json = knurl::Json;
using testing::HasSubstr;

TEST(Doctor, JudgesFiveRatesByTheServoAndTheBareLoop) {
    const Outcome outcome = knurl({"doctor", "--seconds", "5", "--json"});
    ASSERT_LE(outcome.code, 1) << outcome.err;
    const json all = json::parse(outcome.out);
    std::vector<double> rates;
    for (const json& rate : all.at("rates")) {
        rates.push_back(rate.at("rate"));
        EXPECT_THAT((std::vector<std::string>{"good", "usable", "unfit"}),
                    testing::Contains(rate.at("fitness").get<std::string>()));
        EXPECT_THAT(rate.at("reason").get<std::string>(), HasSubstr("of cycles on time"));
        ASSERT_TRUE(rate.contains("servo_to_bare"));
        if (const json& ratio = rate.at("servo_to_bare"); !ratio.is_null()) {
            EXPECT_LE(ratio.at("low"), ratio.at("ratio"));
            EXPECT_LE(ratio.at("ratio"), ratio.at("high"));
        }
        for (const char* loop : {"servo", "bare_loop"}) {
            EXPECT_GT(rate.at(loop).at("cycles"), 0) << loop;
            EXPECT_GT(rate.at(loop).at("late_max_s"), 0) << loop;
        }
    }
    EXPECT_THAT(rates, testing::ElementsAre(500, 1000, 2000, 4000, 10'000));
    for (const json& finding : all.at("findings"))
        EXPECT_FALSE(finding.at("says").get<std::string>().empty()) << finding;
    EXPECT_EQ(outcome.code, all.at("rates")[1].at("fitness") == "unfit" ? 1 : 0);
}

/// In a user namespace no capability gives a right over the whole machine.
bool in_user_namespace() {
    std::istringstream map(text_of_file("/proc/self/uid_map"));
    std::uint64_t here = 0, there = 0, count = 0;
    map >> here >> there >> count;
    return count < 4'294'967'295;
}

TEST(Doctor, WithoutRightsItSaysWhatIsLostAndMeasuresTheRest) {
#if defined(__SANITIZE_THREAD__)
    // Such a build never asks for a priority, so none can be refused (runtime/servo/src/realtime.cpp).
    GTEST_SKIP() << "knurld asks for no real-time priority in a build with ThreadSanitizer";
#endif
    KNURL_NEEDS(missing_loss_of_rights());
    const Folder folder;
    const Outcome outcome = knurl_without_rights(folder, {"doctor", "--seconds", "5"});
    ASSERT_LE(outcome.code, 1) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("BAD  real-time priority"));
    EXPECT_THAT(outcome.out,
                HasSubstr(in_user_namespace()
                              ? std::string("mend: podman run --ulimit rtprio=")
                              : "mend: sudo setcap cap_sys_nice,cap_ipc_lock=ep " + folder.path("knurld")));
    EXPECT_THAT(outcome.out, HasSubstr("without real-time priority"));
    EXPECT_THAT(outcome.out, HasSubstr("10000 Hz"));
}

TEST(Doctor, InterruptedItKeepsTheVerdictsThatItHas) {
    OnTerminal doctor({knurl_program(), "doctor", "--seconds", "8"}, 200, 60);
    ASSERT_TRUE(doctor.shows("1000 Hz, ")) << doctor.shown;  // the rate before it has been judged
    constexpr char interrupt = 3;                            // Ctrl-C
    doctor.type(interrupt);
    EXPECT_EQ(doctor.end(), 1);
    EXPECT_THAT(doctor.shown, HasSubstr("   500 Hz  "));
    EXPECT_THAT(doctor.shown, HasSubstr("interrupted; "));
    EXPECT_THAT(doctor.shown, HasSubstr(" of 5 rates were judged until then"));
}

TEST(Doctor, BadArgumentsAreRefusedBeforeAnythingIsStarted) {
    EXPECT_THAT(knurl({"doctor", "--seconds", "1"}).err, HasSubstr("--seconds is 1; give 5 to 3600"));
    EXPECT_EQ(knurl({"doctor", "--seconds", "1"}).code, 2);
    EXPECT_THAT(knurl({"doctor", "--servo-cpu", "1023"}).err,
                HasSubstr("which this process may not use; give one of "));
    EXPECT_EQ(knurl({"doctor", "--idle", "deep"}).code, 2);
}

}  // namespace
}  // namespace knurl::test
