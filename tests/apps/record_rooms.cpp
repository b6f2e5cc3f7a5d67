// `knurl record --room`: devices of several servos in one file, on one time base.

#include <cstring>
#include <filesystem>
#include <map>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/json/json.hpp>
#include <knurl/messages/cdr.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/recording/mcap.hpp>

#include "program.hpp"

namespace knurl::test::record_rooms_tests {
namespace {

using testing::HasSubstr;

struct Seen {
    std::size_t reports = 0;
    std::int64_t first = 0, last = 0;    // ns of the file's clock
    std::optional<std::int64_t> offset;  // of the file's clock against the servo's, in each message the same
};

TEST(RecordRooms, DevicesOfSeveralServosAreInOneFileOnOneTimeBase) {
    const Home home;
    const Servo attic({"--name", "attic", "--device", "right=sim:premium15"});
    const Servo cellar({"--name", "cellar", "--device", "a=sim:cartesian3", "--device", "b=sim:premium15"});
    const std::string path = home.path("rooms.mcap");
    const Outcome outcome =
        knurl({"record", "--room", "up=knurl:attic", "--room", "down=knurl:cellar,b", "--for", "1", path});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("up: "));
    EXPECT_THAT(outcome.out, HasSubstr("clock within"));

    recording::McapReader file(path);
    std::map<std::uint16_t, Seen> rooms{{file.channel("/up/report"), {}}, {file.channel("/down/report"), {}}};
    ASSERT_EQ(rooms.size(), 2u);
    ASSERT_FALSE(rooms.contains(0)) << "a channel is missing";
    const std::uint16_t clocks = file.channel("/knurl/clocks");
    std::size_t comparisons = 0;
    constexpr std::size_t report_at = std::size(messages::CdrWriter::encapsulation);
    for (recording::McapReader::Message message; file.next(message);) {
        if (message.channel == clocks) {
            const Json said = Json::parse(
                std::string_view(reinterpret_cast<const char*>(message.data.data()), message.data.size()));
            EXPECT_EQ(said.at("clock_offset_ns").get<std::int64_t>(), 0) << "of servos on this host";
            ++comparisons;
        }
        const auto room = rooms.find(message.channel);
        if (room == rooms.end()) continue;
        ASSERT_EQ(message.data.size(), report_at + sizeof(Report));
        Report report;
        std::memcpy(&report, message.data.data() + report_at, sizeof report);
        Seen& seen = room->second;
        if (seen.reports++ == 0) seen.first = message.time_ns;
        EXPECT_GT(message.time_ns, seen.last);
        seen.last = message.time_ns;
        const std::int64_t offset = message.time_ns - report.read_ns;
        EXPECT_EQ(offset, seen.offset.value_or(offset));
        seen.offset = offset;
    }
    EXPECT_GE(comparisons, 2u) << "one of each room at least";
    const Seen& up = rooms.begin()->second;
    const Seen& down = rooms.rbegin()->second;
    EXPECT_GT(up.reports, 100u);
    EXPECT_GT(down.reports, 100u);
    EXPECT_EQ(up.offset, down.offset) << "both clocks are this host's";
    EXPECT_LT(up.first, down.last);
    EXPECT_LT(down.first, up.last);
    for (const char* name : {"knurl room up", "knurl room down", "knurl rooms"})
        EXPECT_NE(file.metadata(name), nullptr) << name;
    EXPECT_EQ(file.metadata("knurl room down")->at("device"), "b");
}

TEST(RecordRooms, WhatMakesNoSenseIsRefusedBeforeThereIsAFile) {
    const Home home;
    const Servo attic({"--name", "attic", "--device", "right=sim:premium15"});
    const Servo cellar({"--name", "cellar", "--device", "a=sim:cartesian3", "--device", "b=sim:premium15"});
    const std::string path = home.path("none.mcap");
    const auto refused = [&](const std::vector<std::string>& rooms, int code, const std::string& why) {
        std::vector<std::string> words{"record", path, "--for", "1"};
        for (const std::string& room : rooms) words.insert(words.end(), {"--room", room});
        const Outcome outcome = knurl(words);
        EXPECT_EQ(outcome.code, code) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(why));
        EXPECT_FALSE(std::filesystem::exists(path));
    };
    refused({"knurl:attic"}, 2, "give NAME=ADDRESS");
    refused({"up-stairs=knurl:attic"}, 2, "letters, digits and _");
    refused({"up=knurl:attic", "up=knurl:attic"}, 2, "another room has that name");
    refused({"up=knurl:attic", "down=knurl:cellar"}, 1, "room down: servo 'cellar' has 2 devices");
    refused({"up=knurl:attic", "down=knurl:nowhere"}, 1, "room down: no servo 'nowhere'");
}

}  // namespace
}  // namespace knurl::test::record_rooms_tests
