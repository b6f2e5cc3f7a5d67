// What is sent to a peer: which reports, when, and with which content.

#include "feedback_assembly.hpp"
#include "net_stream.hpp"

namespace knurl::bridge::test {
namespace {

struct Reports : Stream {
    /// The numbers of the cycles whose reports arrived.
    std::vector<std::int64_t> reported(double rate, std::int64_t cycles) {
        PeerStream stream(stream_id, attachment(), rate);
        bind(stream);
        std::vector<std::int64_t> numbers;
        for (std::int64_t i = 0; i < cycles; ++i) {
            EXPECT_TRUE(cycle(stream, i)) << why;
            for (const Came& came : datagrams())
                if (came.report) numbers.push_back(static_cast<std::int64_t>(came.report->cycle));
        }
        return numbers;
    }
};

TEST_F(Reports, KeepToTheGridOfTheRateAskedFor) {
    const auto every = [](std::int64_t step, std::int64_t cycles) {
        std::vector<std::int64_t> numbers;
        for (std::int64_t i = 0; i < cycles; i += step) numbers.push_back(i);
        return numbers;
    };
    EXPECT_EQ(reported(0, 100), every(1, 100));
    EXPECT_EQ(reported(1000, 100), every(1, 100)) << "the servo's own rate";
    EXPECT_EQ(reported(500, 100), every(2, 100));
    EXPECT_EQ(reported(5000, 100), every(1, 100)) << "more than there are";
    // A rate that does not divide the servo's is right on average.
    EXPECT_EQ(reported(300, 1000).size(), 300u);
    EXPECT_EQ(reported(700, 1000).size(), 700u);
}

TEST_F(Reports, ThatWereDueWhileTheServoStoodStillAreNotMadeUpFor) {
    PeerStream stream(stream_id, attachment(), 100);
    bind(stream);
    std::vector<std::uint64_t> came;
    for (const std::int64_t i : {0, 5, 10, 1000, 1001, 1005, 1010, 1020}) {
        ASSERT_TRUE(cycle(stream, i));
        for (const Came& one : datagrams()) came.push_back(one.report.value().cycle);
    }
    EXPECT_EQ(came, (std::vector<std::uint64_t>{0, 10, 1000, 1010, 1020}));
}

TEST_F(Reports, ThatTheBridgeItselfMissedTakeTheirNumbers) {
    const auto numbers = [&](double rate, std::int64_t behind, std::uint64_t unseen) {
        PeerStream stream(stream_id, attachment(), rate);
        bind(stream);
        EXPECT_TRUE(cycle(stream, 0) && cycle(stream, behind, unseen));
        const std::vector<Came> came = datagrams();
        return came.size() == 2 ? came[1].piece.number - came[0].piece.number : 0;
    };
    EXPECT_EQ(numbers(0, 6, 5), 6u);
    EXPECT_EQ(numbers(0, 6, 0), 1u) << "the servo stood still";
    EXPECT_EQ(numbers(100, 36, 35), 3u) << "those of 10, 20 and 30 ms";
    EXPECT_EQ(numbers(100, 12, 11), 1u) << "the one that is due, late";
    EXPECT_EQ(numbers(100, 1000, 0), 1u) << "the servo stood still";
    EXPECT_EQ(numbers(100, 1000, 20), 21u) << "at most as many as there were";
}

TEST_F(Stream, AnAcknowledgementComesAtOnceHoweverSeldomReportsDo) {
    PeerStream stream(stream_id, attachment(), 1);
    bind(stream);
    ASSERT_TRUE(cycle(stream, 0));
    EXPECT_EQ(datagrams().size(), 1u) << "the first report";
    ASSERT_TRUE(cycle(stream, 1));
    EXPECT_TRUE(datagrams().empty());
    servo.feedback.batch = 7;
    ASSERT_TRUE(cycle(stream, 2));
    auto all = datagrams();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_FALSE(all[0].report);
    EXPECT_EQ(all[0].feedback.value().batch, 7u);
    servo.feedback.refused_batch = 8;
    ASSERT_TRUE(cycle(stream, 3));
    all = datagrams();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].feedback.value().refused_batch, 8u);
    ASSERT_TRUE(cycle(stream, 4));
    EXPECT_TRUE(datagrams().empty()) << "once";
}

TEST_F(Stream, FeedbackSaysHowManyAnswersWentBeforeIt) {
    PeerStream stream(stream_id, attachment(), 0);
    bind(stream);
    for (std::uint64_t n = 1; n <= 70; ++n) servo.replies.push_back({.command = n});
    ASSERT_TRUE(cycle(stream, 0));
    std::uint64_t answers = 0;
    for (const Received& frame : frames()) {
        EXPECT_EQ(frame.type, static_cast<std::uint16_t>(FrameType::replies));
        EXPECT_EQ(frame.stream, stream_id);
        answers += frame.payload.size() / sizeof(protocol::Reply);
    }
    EXPECT_EQ(answers, 70u);
    EXPECT_EQ(datagrams().at(0).piece.answers, 70u);
    servo.replies.push_back({.command = 71});
    ASSERT_TRUE(cycle(stream, 1));
    EXPECT_EQ(datagrams().at(0).piece.answers, 71u);
}

TEST_F(Reports, AreCountedFromTheBeginningThoughNobodyIsThereYet) {
    PeerStream stream(stream_id, attachment(), 0);
    Report before;
    before.cycle = 41;
    stream.note(before);
    for (std::int64_t i = 42; i <= 44; ++i) ASSERT_TRUE(cycle(stream, i));
    bind(stream);
    stream.repeat(way);
    out.flush();
    const auto newest = datagrams();
    ASSERT_EQ(newest.size(), 1u);
    EXPECT_EQ(newest[0].piece.number, 4u);
    EXPECT_EQ(newest[0].report.value().cycle, 44u);
    ASSERT_TRUE(cycle(stream, 45));
    EXPECT_EQ(datagrams().at(0).piece.number, 5u) << "its repetition was no new one";
}

TEST_F(Stream, WhatIsFeltArrivesInAsManyDatagramsAsItNeeds) {
    for (const std::size_t count : {1u, 3u, 4u, 10u, 20u, 30u, 36u}) {
        SCOPED_TRACE(count);
        PeerStream stream(stream_id, attachment(), 0);
        bind(stream);
        servo.entries.assign(count, {});
        for (std::size_t i = 0; i < count; ++i) servo.entries[i].force.x = static_cast<double>(i);
        servo.feedback.cycle = 9;
        servo.feedback.entries = static_cast<std::uint32_t>(count);
        ASSERT_TRUE(cycle(stream, 9));
        EXPECT_TRUE(frames().empty()) << "nothing by TCP";
        FeedbackAssembly assembly(300);
        for (const Came& came : datagrams()) {
            if (came.feedback) assembly.header(*came.feedback, 0);
            assembly.piece(came.header, came.piece, came.felt);
        }
        protocol::FeedbackHeader header;
        std::vector<protocol::FeedbackEntry> entries;
        ASSERT_TRUE(assembly.take(0, header, entries));
        ASSERT_EQ(entries.size(), count);
        for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(entries[i].force.x, static_cast<double>(i));
    }
}

TEST_F(Stream, WhatIsFeltOfVeryManyComesByTcpFiftyTimesASecond) {
    PeerStream stream(stream_id, attachment(), 0);
    bind(stream);
    servo.entries.assign(200, {});
    std::size_t came = 0;
    for (std::int64_t i = 0; i < 200; ++i) {
        servo.feedback.cycle = static_cast<std::uint64_t>(i + 1);
        ASSERT_TRUE(cycle(stream, i));
        for (const Received& frame : frames()) {
            EXPECT_EQ(frame.type, static_cast<std::uint16_t>(FrameType::feedback));
            EXPECT_EQ(frame.payload.size(),
                      sizeof(protocol::FeedbackHeader) + 200 * sizeof(protocol::FeedbackEntry));
            ++came;
        }
        const auto all = datagrams();
        ASSERT_EQ(all.size(), 1u);
        EXPECT_TRUE(all[0].feedback) << "what acknowledges is in every datagram";
        EXPECT_TRUE(all[0].felt.empty());
    }
    EXPECT_EQ(came, 10u);
}

}  // namespace
}  // namespace knurl::bridge::test
