// One session, seen from its own end: how it begins, what it may request, how it ends.

#include <future>
#include <limits>

#include "relay_stranger.hpp"

namespace knurl::bridge::test {
namespace {

struct Sessions : testing::Test {
    ServoUp servo;
    BridgeProcess bridge;

    Error::Kind refused(FrameStream& stream, const std::string& words) {
        const Refused message = await<Refused>(stream, FrameType::refused);
        says(text_of(message.text), words);
        return static_cast<Error::Kind>(message.kind);
    }
};

TEST_F(Sessions, of_another_version_are_told_what_to_do) {
    Hello magic = hello(), version = hello(), layout = hello();
    ++magic.magic;
    ++version.version;
    ++layout.layout;
    for (const Hello& other : {magic, version, layout}) {
        FrameStream stream(dial(bridge), false);
        send(stream, FrameType::hello, other);
        EXPECT_EQ(refused(stream, "rebuild the one and restart the other"), Error::Kind::incompatible);
        EXPECT_TRUE(ended(stream));
    }
}

TEST_F(Sessions, have_a_name_that_is_fit_for_a_log) {
    FrameStream stream(dial(bridge), false);
    Hello named = hello();
    put_text(named.client, "a\nb\033[2J\xff");
    send(stream, FrameType::hello, named);
    await<Welcome>(stream, FrameType::welcome);
    says(bridge.line(), "a?b?[2J?@127.0.0.1:");
}

TEST_F(Sessions, have_an_address_that_is_whole_however_long_their_name_is) {
    Client remote = Client::connect(bridge.address(), {.name = std::string(63, 'n'), .wait = 10s}),
           local = Client::connect("knurl:default", {.wait = 10s});
    const std::string said = bridge.line();  // "nnn~@127.0.0.1:40112: in, role control"
    const std::string address =
        said.substr(said.find("127.0.0.1:"), said.find(": in") - said.find("127.0.0.1:"));
    Claim held = remote.claim();
    const Error error = refusal([&] { local.claim(); });
    EXPECT_EQ(error.kind, Error::Kind::device_held);
    says(error.what(), "nnn~@" + address);
}

TEST_F(Sessions, that_ask_for_what_there_is_not_are_told_and_go_on) {
    FrameStream stream(dial(bridge), false);
    greet(stream);
    Attach attach;
    attach.request.observe = 1;
    attach.request.device = 1;
    send(stream, FrameType::attach, attach);
    EXPECT_EQ(refused(stream, "device 1 of 1"), Error::Kind::no_such_device);
    attach.request.device = 0;
    for (const double rate : {-1.0, 2e6, std::numeric_limits<double>::quiet_NaN()}) {
        attach.report_rate = rate;
        send(stream, FrameType::attach, attach);
        EXPECT_EQ(refused(stream, "report_rate = "), Error::Kind::bad_parameters) << rate;
    }
    EXPECT_EQ(attach_observer(stream).stream, 1u);
}

TEST_F(Sessions, get_a_stream_s_number_back_last) {
    // Data that arrives late for an ended stream must not reach another one.
    FrameStream stream(dial(bridge), false);
    greet(stream);
    for (std::uint32_t i = 1; i <= max_streams; ++i) {
        EXPECT_EQ(attach_observer(stream).stream, i);
        send(stream, FrameType::release, Nothing{}, static_cast<std::uint16_t>(i));
    }
    EXPECT_EQ(attach_observer(stream).stream, 1u);
}

TEST_F(Sessions, with_too_many_streams_are_told_and_go_on) {
    FrameStream stream(dial(bridge), false);
    greet(stream);
    std::string refusal;
    for (std::uint32_t i = 0; i <= max_streams && refusal.empty(); ++i) {
        try {
            attach_observer(stream);
        } catch (const std::runtime_error& error) {
            refusal = error.what();
        }
    }
    says(refusal, "connect once more");
    send(stream, FrameType::release, Nothing{}, 1);
    attach_observer(stream);
}

TEST_F(Sessions, hear_that_the_servo_has_gone) {
    FrameStream stream(dial(bridge), false);
    greet(stream);
    servo.end(SIGKILL);
    const std::vector<std::byte> gone = await(stream, FrameType::gone);
    says({reinterpret_cast<const char*>(gone.data()), gone.size()}, "servo");
    EXPECT_TRUE(ended(stream));
}

TEST_F(Sessions, are_as_many_as_stated_and_one_that_ends_makes_room) {
    constexpr int most = 128;
    std::vector<std::unique_ptr<FrameStream>> streams;
    for (int i = 0; i < most; ++i) {
        streams.push_back(std::make_unique<FrameStream>(dial(bridge), false));
        greet(*streams.back());
    }
    std::future<bool> connected =
        std::async(std::launch::async, [&] { return connect_to(bridge).connected(); });
    says(bridge.line_with("there are too many"), "127.0.0.1");  // it has called, and goes on trying
    const Error error = refused_by(bridge);
    EXPECT_EQ(error.kind, Error::Kind::refused);
    says(error.what(), "the bridge has 128 sessions");
    streams.clear();
    EXPECT_TRUE(connected.get());
}

}  // namespace
}  // namespace knurl::bridge::test
