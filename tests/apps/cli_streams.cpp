// Exit codes and files, in any state of the three standard streams.

#include <csignal>

#include <gtest/gtest.h>
#include <unistd.h>

#include "program.hpp"

namespace knurl::test {
namespace {

/// sh -c 'exec "$0" "$@" REDIRECTIONS'
Outcome redirected(std::vector<std::string> words, const std::string& redirections) {
    words.insert(words.begin(), {"/bin/sh", "-c", "exec \"$0\" \"$@\" " + redirections});
    return run(words);
}

std::vector<std::vector<std::string>> that_say_something() {
    return {{knurl_program(), "--help"},
            {knurl_program(), "--version"},
            {knurl_program(), "ls"},
            {knurl_program(), "ls", "--json"},
            {knurl_program(), "devices"},
            {knurl_program(), "device", "check", "omni"},
            {knurl_program(), "record", "--help"},
            {knurld_program(), "--help"},
            {knurld_program(), "--version"}};
}

std::string joined(const std::vector<std::string>& words) {
    std::string all;
    for (const std::string& word : words) all += word + " ";
    return all;
}

TEST(Streams, WhatCannotBeSaidIsAFailureThatSaysWhy) {
    const Home home;
    for (const auto& words : that_say_something()) {
        const Outcome full = redirected(words, ">/dev/full");
        EXPECT_EQ(full.code, 1) << joined(words);
        EXPECT_NE(full.err.find("standard output cannot be written: No space left on device"),
                  std::string::npos)
            << joined(words) << full.err;
        const Outcome closed = redirected(words, ">&-");
        EXPECT_EQ(closed.code, 1) << joined(words);
        EXPECT_NE(closed.err.find("standard output is closed"), std::string::npos)
            << joined(words) << closed.err;
        EXPECT_EQ(redirected(words, ">/dev/null").code, 0) << joined(words);
    }
}

TEST(Streams, WhoeverReadsNoFurtherEndsTheProgramWithoutAWord) {
    const Home home;
    const Outcome outcome =
        run({"/bin/sh", "-c", "{ sleep 0.1; \"$0\" --help; echo code $? >&2; } | :", knurl_program()});
    EXPECT_EQ(outcome.err, "code 141\n");
}

TEST(Streams, AWrongCommandLineIsTwoWhateverTheStreamsAre) {
    for (const char* streams : {"", ">/dev/full", ">&-", "2>&-", "2>/dev/full", "<&- >&- 2>&-"})
        EXPECT_EQ(redirected({knurl_program(), "frobnicate"}, streams).code, 2) << streams;
}

/// The recording is complete: it has its index, and replays.
void expect_whole(const std::string& file) {
    const Outcome replayed = knurl({"replay", file});
    EXPECT_EQ(replayed.code, 0) << replayed.err;
    EXPECT_NE(replayed.out.find("equal to the last bit"), std::string::npos) << replayed.out;
    EXPECT_EQ(replayed.err, "");
}

TEST(Streams, ARecordingIsWholeWhateverTheStreamsAre) {
    const Home home;
    Servo servo({"--device", "sim:cartesian3", "--priority", "0"});
    // The recording's file must not get the number of a standard stream.
    for (const char* streams : {"<&- >&- 2>&-", "2>&-", "<&-", "2>/dev/full", ">/dev/full 2>/dev/full"}) {
        const std::string file = home.path("r.mcap");
        ::unlink(file.c_str());
        const Outcome outcome = redirected({knurl_program(), "record", file, "--for", "0.3"}, streams);
        const bool can_say = std::string(streams).find(">&- ") == std::string::npos &&
                             std::string(streams).find(">/dev/full 2") == std::string::npos;
        EXPECT_EQ(outcome.code, can_say ? 0 : 1) << streams << outcome.err;
        expect_whole(file);
    }
}

TEST(Streams, AServoWithNoStreamsServes) {
    const Home home;
    Background servo(
        {"/bin/sh", "-c", "exec \"$0\" --device sim:cartesian3 --priority 0 <&- 2>&-", knurld_program()});
    ASSERT_TRUE(servo.says("knurld: ready")) << servo.said();
    EXPECT_NE(knurl({"ls"}).out.find("knurl:default"), std::string::npos);
    EXPECT_EQ(servo.end(SIGTERM), 0);
}

}  // namespace
}  // namespace knurl::test
