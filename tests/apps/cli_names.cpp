// How a servo is named: every option accepts every form that a program prints.

#include <algorithm>
#include <csignal>

#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/client/client.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

class Names : public testing::Test {
  protected:
    const Home home_;
    Servo servo_{{"--name", "lab", "--device", "sim:cartesian3", "--priority", "0"}};
};

TEST_F(Names, EveryFormIsTakenByEveryOption) {
    for (const std::string& name : {std::string("lab"), std::string("knurl:lab"), home_.path("lab.sock")}) {
        const auto works = [&](std::vector<std::string> words) {
            const Outcome outcome = knurl(words);
            EXPECT_EQ(outcome.code, 0) << words.front() << " " << name << ": " << outcome.err;
            return outcome.out + outcome.err;
        };
        EXPECT_NE(works({"top", "--servo", name, "--count", "1", "--rate", "20"}).find("knurl:lab "),
                  std::string::npos);
        EXPECT_NE(works({"top", name, "--count", "1", "--rate", "20"}).find("knurl:lab "), std::string::npos);
        works({"trace", "--servo", name, "--out", home_.path("t.json"), "--for", "0.1"});
        EXPECT_NE(
            works({"record", home_.path("r.mcap"), "--servo", name, "--for", "0.1"}).find("of servo 'lab'"),
            std::string::npos);
        ::unlink(home_.path("r.mcap").c_str());
        works({"latency", "--servo", name, "--updates", "20"});
        works({"latency", "--connect", name, "--updates", "20"});  // the option's former name
        EXPECT_EQ(Client::connect(name).devices().size(), 1u);
    }
}

TEST_F(Names, AnAlmostRightOneIsAnsweredWithTheOneThatRuns) {
    for (const char* verb : {"top", "trace", "record", "latency"}) {
        std::vector<std::string> words{verb, "--servo", "knurl:lba"};
        if (verb == std::string("trace")) words.insert(words.end(), {"--out", home_.path("t.json")});
        if (verb == std::string("record")) words.push_back(home_.path("r.mcap"));
        if (verb == std::string("latency")) words.insert(words.end(), {"--wait", "0"});
        const Outcome outcome = knurl(words);
        EXPECT_EQ(outcome.code, 1) << verb;
        EXPECT_NE(outcome.err.find("did you mean knurl:lab, which runs?"), std::string::npos) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
    EXPECT_NE(knurl({"top", "--servo", "somewhere"}).err.find("there is only knurl:lab"), std::string::npos);
    servo_.end(SIGKILL);  // its socket stays, and names no servo
    EXPECT_EQ(knurl({"top", "--servo", "lba"}).err.find("knurl:lab"), std::string::npos);
}

TEST_F(Names, AnAlmostRightDeviceIsAnsweredWithTheOneThatIsThere) {
    std::vector<std::vector<std::string>> all = {
        {"reset", "cartesain3"},
        {"record", home_.path("r.mcap"), "--device", "cartesain3"},
        {"trace", "--out", home_.path("t.json"), "--device", "cartesain3"},
        {"latency", "--device", "cartesain3"}};
    for (std::vector<std::string>& words : all) {
        words.insert(words.end(), {"--servo", "lab"});
        const Outcome outcome = knurl(words);
        EXPECT_EQ(outcome.code, 1) << words.front();
        EXPECT_NE(outcome.err.find("no device 'cartesain3'; did you mean 'cartesian3'?"), std::string::npos)
            << outcome.err;
    }
}

TEST_F(Names, WhatCanBeNoServosNameIsAWrongCommandLine) {
    for (const char* name : {"", ".lab", "a b", "knurl:", "some/where", "knurl://lab:4096"}) {
        const Outcome outcome = knurl({"record", home_.path("r.mcap"), "--servo", name});
        EXPECT_EQ(outcome.code, 2) << name << ": " << outcome.err;
    }
    for (const char* name : {"", "a b", "knurl:", "some/where", "knurl://", "knurl://lab:port"}) {
        const Outcome outcome = knurl({"latency", "--servo", name});
        EXPECT_EQ(outcome.code, 2) << name << ": " << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
    const Outcome both = knurl({"latency", "--servo", "lab", "--connect", "lab"});
    EXPECT_EQ(both.code, 2);
    EXPECT_NE(both.err.find("--servo"), std::string::npos) << both.err;
}

}  // namespace
}  // namespace knurl::test
