// `knurl trace` of a running servo, and of one that has died.

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <trace_flight.hpp>

#include <knurl/client/client.hpp>
#include <knurl/json/json.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using json = knurl::Json;
using testing::HasSubstr;

TEST(TraceProgram, DrawsAServoAtWork) {
    const Home home;
    const Servo servo({"--device", "right=sim:cartesian3", "--rate", "500"});
    json trace;
    // The parts of a stamped cycle can be read until the next one is stamped. In 0.3 s there are few, and a
    // busy machine may miss all of them.
    const auto has_a_stamped_cycle = [&] {
        const Outcome outcome =
            knurl({"trace", "--out", home.path("T.json"), "--for", "0.3", "--cycles", "20"});
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("cycles of right around cycle "));
        trace = json::parse(text_of_file(home.path("T.json")));
        return trace.at("otherData").at("stamped_cycle").is_number();
    };
    ASSERT_TRUE(eventually(has_a_stamped_cycle));
    const auto& about = trace.at("otherData");
    EXPECT_EQ(about.at("device"), "right");
    EXPECT_EQ(about.at("stamped_cycle").get<std::uint64_t>() % 64, 0u);
    EXPECT_EQ(about.at("about_cycle"), about.at("stamped_cycle"));
    std::size_t cycles = 0, scenes = 0;
    for (const json& event : trace.at("traceEvents")) {
        const auto name = event.at("name").get<std::string>();
        cycles += event.at("ph") == "X" && name.starts_with("cycle ") ? 1 : 0;
        scenes += name == "scenes" ? 1 : 0;
    }
    EXPECT_GE(cycles, 21u);
    EXPECT_GE(scenes, 1u);
}

TEST(TraceProgram, SaysInOneLineWhyThereIsNone) {
    const Home home;
    const auto says = [&](std::vector<std::string> words, const char* what) {
        words.insert(words.begin(), {"trace", "--out", home.path("T.json")});
        const Outcome outcome = knurl(words);
        EXPECT_NE(outcome.code, 0);
        EXPECT_THAT(outcome.err, HasSubstr(what));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(home.path("T.json")));
    };
    says({"--servo", "nobody"}, "nobody");
    says({"--from", home.path("none.csv")}, "none.csv: cannot be read");
    says({"--from", home.file("other.csv", "a,b\n1,2\n")}, "other.csv:1: this is no flight record");
    says({"--cycles", "0"}, "--cycles is 0; give 1 to 2000");
    says({"--for", "0"}, "--for is 0 s");
    says({"--around", "noon"}, "--around");
    const Servo servo({"--device", "a=sim:cartesian3", "--device", "b=sim:cartesian3"});
    says({}, "has 2 devices; say which one: a, b");
    says({"--device", "c"}, "has no device 'c'; it has: a, b");
}

const std::string heading =
    "# Knurl flight recorder: the last reports of a servo that died\n# cause: killed by signal 9\n"
    "# servo: mine pid 17\n# device: right sim:premium15 1000 Hz\n"
    "cycle,deadline_ns,read_ns,write_ns,scene_fx,scene_fy,scene_fz,sent_fx,sent_fy,sent_fz,state,faults,"
    "flags,"
    "late_count\n";

TEST(FlightRecord, IsReadUpToWhereItWasCut) {
    const Folder folder;
    bool cut = true;
    const std::string whole =
        heading + "7,100,130,150,0,0,3,0,0,2.5,4,0,8,1\n8,1100,1130,1150,0,0,0,0,0,0,4,0,8,2\n";
    const auto timeline = cli::read_flight_record(folder.file("whole.csv", whole), cut);
    EXPECT_FALSE(cut);
    ASSERT_EQ(timeline.reports.size(), 2u);
    EXPECT_EQ(timeline.servo, "mine");
    EXPECT_EQ(timeline.device, "right");
    EXPECT_EQ(timeline.cause, "killed by signal 9");
    EXPECT_EQ(timeline.rate, 1000);
    EXPECT_EQ(timeline.reports[0].cycle, 7u);
    EXPECT_EQ(timeline.reports[0].write_ns, 150);
    EXPECT_EQ(timeline.reports[0].sent_force.z, 2.5);
    EXPECT_EQ(timeline.reports[1].late_count, 2u);
    // A file that is cut anywhere gives the same reports up to there, or a line that says what is wrong.
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::string path = folder.file("cut.csv", whole.substr(0, size));
        try {
            const auto part = cli::read_flight_record(path, cut);
            EXPECT_LT(part.reports.size(), 2u) << size;
            EXPECT_EQ(part.reports[0].write_ns, 150) << size;
            EXPECT_EQ(cut, size > whole.find("8,1100")) << size;
        } catch (const std::runtime_error& error) {
            EXPECT_LT(size, whole.find("8,1100")) << error.what();
            EXPECT_THAT(error.what(), HasSubstr("cut.csv:1: "));
        }
    }
}

TEST(FlightRecord, SaysWhichLineIsWrong) {
    const Folder folder;
    const auto says = [&](const std::string& text, const char* what) {
        bool cut = false;
        try {
            cli::read_flight_record(folder.file("bad.csv", text), cut);
            ADD_FAILURE() << "taken: " << text;
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), HasSubstr(what));
        }
    };
    const std::string row = "7,100,130,150,0,0,3,0,0,2.5,4,0,8,1\n",
                      next = "8,1100,1130,1150,0,0,0,0,0,0,4,0,8,2\n";
    says(heading + "7,100,x,150,0,0,3,0,0,2.5,4,0,8,1\n" + next, "bad.csv:6: this is no report");
    says(heading + "7,100\n" + next, "bad.csv:6: this is no report");
    says(heading + next + row, "bad.csv:7: this cycle is not after the one above");
    says(heading, "there is no report in it");
    says("# Knurl flight recorder\ncycle,deadline_ns,read_ns\n1,2,3\n",
         "has no column write_ns; it is of another");
}

TEST(TraceProgram, DrawsWhatTheGuardianSaved) {
    const Home home;
    const Servo servo({"--device", "right=sim:cartesian3"});
    ASSERT_TRUE(eventually([&] { return knurl({"trace", "--out", "-", "--for", "0.1"}).code == 0; }));
    ASSERT_EQ(::kill(servo.pid(), SIGKILL), 0);
    std::string record;
    ASSERT_TRUE(eventually([&] {
        for (const auto& file : std::filesystem::directory_iterator(home.path("")))
            if (file.path().extension() == ".csv") record = file.path().string();
        return !record.empty();
    }));
    const Outcome outcome =
        knurl({"trace", "--from", record, "--out", home.path("T.json"), "--around", "late"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json trace = json::parse(text_of_file(home.path("T.json")));
    EXPECT_EQ(trace.at("otherData").at("device"), "right");
    EXPECT_TRUE(trace.at("otherData").at("stamped_cycle").is_null());
    EXPECT_FALSE(trace.at("otherData").at("cause").get<std::string>().empty());
}

}  // namespace
}  // namespace knurl::test
