// WebSockets: who may open one, what they carry, and how they end.

#include "../eventually.hpp"
#include "served.hpp"

namespace knurl::gateway {

namespace {

using namespace std::chrono_literals;

TEST(GatewayUpgrade, OfThePageNeedsSession) {
    Served served;
    const std::string ask = "Sec-WebSocket-Protocol: knurl.live.v1\r\n";
    EXPECT_EQ(served.ask(served.upgrade("/live", ask)).status, 403);
    Caller caller(served.port);
    caller.send(served.upgrade("/live", ask + served.cookie() + "Origin: " + served.origin() + "\r\n"));
    const Answer answer = read_answer(caller);
    EXPECT_EQ(answer.status, 101);
    EXPECT_EQ(answer.header("Sec-WebSocket-Accept"), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");  // RFC 6455, 1.3
    EXPECT_EQ(answer.header("Sec-WebSocket-Protocol"), "knurl.live.v1");
    EXPECT_EQ(read_message(caller).payload, "hello knurl.live.v1 control 1");
}

TEST(GatewayUpgrade, Subprotocol) {
    Served served;
    EXPECT_EQ(served.ask(served.upgrade("/two")).status, 400);
    EXPECT_EQ(served.ask(served.upgrade("/two", "Sec-WebSocket-Protocol: three\r\n")).status, 400);
    for (const char* wanted : {"two, one", "three,two , one", "three\r\nSec-WebSocket-Protocol: two"}) {
        Caller caller(served.port);
        caller.send(served.upgrade("/two", std::string("Sec-WebSocket-Protocol: ") + wanted + "\r\n"));
        EXPECT_EQ(read_answer(caller).header("Sec-WebSocket-Protocol"), "two") << wanted;
    }
    Caller caller(served.port);
    caller.send(served.upgrade("/open"));
    const Answer answer = read_answer(caller);
    EXPECT_EQ(answer.status, 101);
    EXPECT_EQ(answer.header("Sec-WebSocket-Protocol"), "");
    EXPECT_EQ(read_message(caller).payload, "hello  observe ");
}

TEST(GatewayUpgrade, OriginAndHost) {
    Served served;
    for (const std::string& good : {served.origin(), std::string("https://app.example")})
        EXPECT_EQ(served.ask(served.upgrade("/open", "Origin: " + good + "\r\n")).status, 101) << good;
    for (const std::string& bad :
         {std::string("http://evil.example"), std::string("null"), std::string("https://app.example.evil"),
          std::string("http://localhost:") + std::to_string(served.port)})  // of another name than Host says
        EXPECT_EQ(served.ask(served.upgrade("/open", "Origin: " + bad + "\r\n")).status, 403) << bad;
    EXPECT_EQ(served.said("Origin 'http://evil.example' may not use /open"), 1);
    std::string other = served.upgrade("/open");
    other.replace(other.find(served.host()), served.host().size(), "evil.example");
    EXPECT_EQ(served.ask(other).status, 403);
    // A page that is allowed elsewhere may not use what takes none.
    EXPECT_EQ(served
                  .ask(served.upgrade("/live",
                                      "Sec-WebSocket-Protocol: knurl.live.v1\r\nOrigin: "
                                      "https://app.example\r\n" +
                                          served.cookie()))
                  .status,
              403);
}

TEST(GatewayUpgrade, WhatIsNone) {
    Served served;
    EXPECT_EQ(served.ask(served.upgrade("/nothing")).status, 404);
    const auto changed = [&](const std::string& what, const std::string& with) {
        std::string request = served.upgrade("/open");
        request.replace(request.find(what), what.size(), with);
        return served.ask(request).status;
    };
    EXPECT_EQ(changed("Version: 13", "Version: 12"), 400);
    EXPECT_EQ(changed("Key: dGhlIHNhbXBsZSBub25jZQ==", "Key: short"), 400);
    EXPECT_EQ(changed("Key: dGhlIHNhbXBsZSBub25jZQ==", "Key: " + std::string(1000, 'x')), 400);
    EXPECT_EQ(changed("Connection: Upgrade", "Connection: close"), 400);
    EXPECT_EQ(changed("Upgrade: websocket", "Upgrade: h2c"), 400);
    EXPECT_EQ(changed("GET ", "POST "), 400);
    EXPECT_EQ(served.ask(served.upgrade("/open", "Content-Length: 3\r\n")).status, 400);
}

TEST(GatewayUpgrade, MakerWithoutHandler) {
    Served served;
    for (const auto& [path, code] : {std::pair("/none", 1013U), std::pair("/unborn", 1011U)}) {
        Caller caller(served.port);
        caller.send(served.upgrade(path));
        EXPECT_EQ(read_answer(caller).status, 101);
        const Frame end = read_message(caller);
        EXPECT_EQ(end.opcode, close_frame) << path;
        EXPECT_EQ(end.code(), code) << path;
    }
}

TEST(GatewaySocket, Echoes) {
    Served served;
    Caller caller = served.open();
    for (const std::size_t size : {0U, 1U, 125U, 126U, 65535U, 65536U, 100000U}) {
        const std::string message(size, 'x');
        caller.send(frame(text_frame, message));
        EXPECT_EQ(read_message(caller).payload, message);
        caller.send(frame(binary_frame, message));
        const Frame back = read_message(caller);
        EXPECT_EQ(back.opcode, binary_frame);
        EXPECT_EQ(back.payload, message);
    }
}

TEST(GatewaySocket, FramesBehindTheUpgrade) {
    Served served;
    Caller caller(served.port);
    caller.send(served.upgrade("/open") + frame(text_frame, "at once") + frame(text_frame, "and this"));
    EXPECT_EQ(read_answer(caller).status, 101);
    read_message(caller);
    EXPECT_EQ(read_message(caller).payload, "at once");
    EXPECT_EQ(read_message(caller).payload, "and this");
}

TEST(GatewaySocket, ByteByByteAndInPieces) {
    Served served;
    Caller caller = served.open();
    for (const char c : frame(text_frame, "slowly")) caller.send({&c, 1});
    EXPECT_EQ(read_message(caller).payload, "slowly");
    caller.send(frame(text_frame, "in ", false) + frame(ping_frame, "between") + frame(0, "three ", false) +
                frame(0, "pieces"));
    const Frame pong = read_message(caller);
    EXPECT_EQ(pong.opcode, pong_frame);
    EXPECT_EQ(pong.payload, "between");
    EXPECT_EQ(read_message(caller).payload, "in three pieces");
}

/// The code with which the server closes, after these bytes.
unsigned closes_with(Served& served, const std::string& bytes) {
    Caller caller = served.open();
    caller.send(bytes);
    const Frame end = read_message(caller);
    EXPECT_EQ(end.opcode, close_frame);
    if (end.code() != 0) caller.send(frame(close_frame, end.payload));
    EXPECT_TRUE(caller.at_end());
    return end.code();
}

TEST(GatewaySocket, FramesThatAreNone) {
    Served served;
    EXPECT_EQ(closes_with(served, frame(text_frame, "unmasked", true, false)), 1002U);
    EXPECT_EQ(closes_with(served, frame(3, "reserved")), 1002U);
    EXPECT_EQ(closes_with(served, frame(0, "goes on with nothing")), 1002U);
    EXPECT_EQ(closes_with(served, frame(ping_frame, std::string(126, 'x'))), 1002U) << "a ping is short";
    EXPECT_EQ(closes_with(served, frame(text_frame, "begins", false) + frame(text_frame, "begins again")),
              1002U);
    EXPECT_EQ(closes_with(served, frame(text_frame, "\xc0\x80")), 1007U);
    EXPECT_EQ(closes_with(served, frame(text_frame, "\xed\xa0\x80")), 1007U);
    EXPECT_EQ(closes_with(served, frame(close_frame, std::string("\x03\xed", 2))), 1002U)
        << "1005 is not sent";
    // A reserved bit: nothing was agreed that gives it a meaning.
    std::string compressed = frame(text_frame, "x");
    compressed[0] = static_cast<char>(compressed[0] | 0x40);
    EXPECT_EQ(closes_with(served, compressed), 1002U);
    EXPECT_TRUE(test::eventually([&] { return served.ended == 9; }));
}

TEST(GatewaySocket, TooLongAMessage) {
    Served served;
    EXPECT_EQ(closes_with(served, frame(text_frame, std::string(100001, 'x'))), 1009U);
    EXPECT_EQ(closes_with(served, frame(text_frame, std::string(60000, 'x'), false) +
                                      frame(0, std::string(60000, 'x'))),
              1009U);
    std::string huge = frame(binary_frame, std::string(65536, 'x')).substr(0, 14);
    for (int i = 2; i < 10; ++i) huge[static_cast<std::size_t>(i)] = i == 2 ? '\x7f' : '\xff';
    EXPECT_EQ(closes_with(served, huge), 1009U);
}

TEST(GatewaySocket, ClosesWithItsCode) {
    Served served;
    EXPECT_EQ(closes_with(served, frame(text_frame, "close")), 4001U);
    EXPECT_EQ(closes_with(served, frame(close_frame, std::string("\x03\xe8", 2))), 1000U);
    EXPECT_EQ(closes_with(served, frame(close_frame, "")), 1000U);
    EXPECT_TRUE(test::eventually([&] { return served.ended == 3; }));
}

TEST(GatewaySocket, PeerThatTakesNoPartInClosing) {
    Served served({.request_time = 1h, .silence = 1h, .closing_time = 30ms});
    Caller caller = served.open();
    caller.send(frame(text_frame, "close"));
    EXPECT_EQ(read_message(caller).code(), 4001U);
    EXPECT_TRUE(caller.at_end());  // without an answer
}

TEST(GatewaySocket, PeerWhoHangsUpEndsItsHandler) {
    Served served;
    {
        Caller caller = served.open();
        caller.send(frame(text_frame, "half a fra").substr(0, 7));
    }
    EXPECT_TRUE(test::eventually([&] { return served.ended == 1; }));
}

TEST(GatewaySocket, HandlerThatThrowsLosesItsOwnOnly) {
    Served served;
    Caller other = served.open();
    EXPECT_EQ(closes_with(served, frame(text_frame, "throw")), 1011U);
    EXPECT_EQ(closes_with(served, frame(text_frame, "throw 7")), 1011U);
    {
        Caller caller = served.open();
        caller.send(frame(text_frame, "throw in a tick"));
        EXPECT_EQ(read_message(caller).payload, "throw in a tick");
        EXPECT_EQ(read_message(caller).code(), 1011U);
    }
    EXPECT_EQ(served.ended, 3);
    EXPECT_EQ(served.said("/open failed: asked to"), 1) << "a line a second";
    other.send(frame(text_frame, "still here"));
    EXPECT_EQ(read_message(other).payload, "still here");
}

TEST(GatewaySocket, SlowReaderIsClosedAndOthersGoOn) {
    Served served({.most_waiting = 1 << 20});
    Caller slow = served.open("/open", 4096), other = served.open();
    slow.send(frame(text_frame, "flood"));
    EXPECT_TRUE(test::eventually([&] { return served.said("reads too slowly") == 1; }));
    other.send(frame(text_frame, "still here"));
    EXPECT_EQ(read_message(other).payload, "still here");
    // What was on its way comes, then why it ends.
    Frame next;
    do next = read_message(slow);
    while (next.opcode == binary_frame || next.opcode == text_frame);
    EXPECT_EQ(next.opcode, close_frame);
    EXPECT_EQ(next.code(), 1008U);
    EXPECT_EQ(next.payload.substr(2), "reads too slowly");
}

TEST(GatewaySocket, SlowReaderThatReadsNothingEnds) {
    Served served({.most_waiting = 1 << 20, .request_time = 1h, .silence = 1h, .closing_time = 30ms});
    Caller slow = served.open("/open", 4096);
    slow.send(frame(text_frame, "flood"));
    EXPECT_TRUE(test::eventually([&] { return served.ended == 1; }));
}

TEST(GatewaySocket, SilentPeerIsAskedAndEnds) {
    Served served({.silence = 100ms});
    Caller silent = served.open();
    EXPECT_EQ(read_frame(silent).opcode, ping_frame);
    silent.read_to_the_end();
    EXPECT_TRUE(test::eventually([&] { return served.ended == 1; }));
}

TEST(GatewaySocket, PeerThatAnswersPingsStays) {
    Served served({.silence = 100ms});
    Caller caller = served.open();
    for (int i = 0; i < 10; ++i) {
        const Frame ping = read_frame(caller);
        ASSERT_EQ(ping.opcode, ping_frame);
        caller.send(frame(pong_frame, ping.payload));
    }
    EXPECT_EQ(served.ended, 0);
}

TEST(GatewaySocket, SocketsOfARouteAreBounded) {
    Served served({}, [](Site& site) { site.sockets[1].most_sockets = 2; });
    Caller first = served.open();
    {
        Caller second = served.open();
        EXPECT_EQ(served.ask(served.upgrade("/open")).status, 503);
        EXPECT_EQ(served.ask(served.upgrade("/two", "Sec-WebSocket-Protocol: one\r\n")).status, 101)
            << "another route";
    }
    EXPECT_TRUE(test::eventually([&] { return served.ask(served.upgrade("/open")).status == 101; }));
}

TEST(GatewaySocket, ServerThatEndsEndsItsHandlers) {
    auto served = std::make_unique<Served>();
    Caller caller = served->open();
    std::atomic<int>& ended = served->ended;
    served->stop();
    EXPECT_EQ(ended, 0);
    served->end();
    EXPECT_EQ(ended, 1);
    EXPECT_TRUE(caller.at_end());
}

}  // namespace

}  // namespace knurl::gateway
