// More callers than there are places, and a process without descriptors.

#include <deque>

#include <fcntl.h>
#include <sys/resource.h>

#include "../eventually.hpp"
#include "served.hpp"

namespace knurl::gateway {

namespace {

using namespace std::chrono_literals;

TEST(GatewayBounds, TwoHundredCallersWhoSayNothingKeepNobodyOut) {
    Served served({.request_time = 60s});
    const std::string cookie = served.cookie();
    Caller before = served.open();
    std::deque<Caller> idle;
    for (int i = 0; i < 200; ++i) idle.emplace_back(served.port);
    EXPECT_EQ(served.ask(served.request("GET /", cookie)).status, 200);
    Caller after = served.open();
    for (Caller* each : {&before, &after}) {
        each->send(frame(text_frame, "still here"));
        EXPECT_EQ(read_message(*each).payload, "still here");
    }
    // The ones that had waited longest made room.
    EXPECT_TRUE(idle.front().at_end());
}

TEST(GatewayBounds, SocketsAreNotThrownOut) {
    Served served({.most_connections = 6, .most_of_address = 4});
    std::deque<Caller> open;
    for (int i = 0; i < 4; ++i) open.push_back(served.open());
    Caller more(served.port);
    EXPECT_NE(more.read_to_the_end().find("503 Service Unavailable"), std::string::npos);
    EXPECT_TRUE(test::eventually([&] { return served.said("all connections are taken") == 1; }));
    for (Caller& each : open) {
        each.send(frame(text_frame, "still here"));
        EXPECT_EQ(read_message(each).payload, "still here");
    }
    open.pop_front();
    EXPECT_TRUE(test::eventually([&] { return served.ask(served.request("GET /")).status == 403; }));
}

TEST(GatewayBounds, AllConnectionsTogether) {
    Served served({.most_connections = 3, .most_of_address = 64});
    std::deque<Caller> open;
    for (int i = 0; i < 3; ++i) open.push_back(served.open());
    Caller more(served.port);
    EXPECT_NE(more.read_to_the_end().find("503 Service Unavailable"), std::string::npos);
}

/// Takes all descriptors that are left, below a limit that leaves few.
class NoDescriptors {
  public:
    NoDescriptors() {
        ::getrlimit(RLIMIT_NOFILE, &before_);
        const int next = ::dup(0);
        ::close(next);
        rlimit few = before_;
        few.rlim_cur = static_cast<rlim_t>(next) + 4;
        ::setrlimit(RLIMIT_NOFILE, &few);
        for (int fd = 0; (fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0;) taken_.push_back(fd);
    }
    ~NoDescriptors() {
        for (const int fd : taken_) ::close(fd);
        ::setrlimit(RLIMIT_NOFILE, &before_);
    }
    bool complete() const { return !taken_.empty(); }

  private:
    rlimit before_{};
    std::vector<int> taken_;
};

TEST(GatewayBounds, WithoutDescriptorsWhoIsConnectedGoesOn) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP()
        << "UBSan makes a pipe to look whether an object is there, and without one says that it is not";
#endif
    Served served({.request_time = 60s});
    Caller open = served.open(), waits;
    {
        const NoDescriptors none;
        ASSERT_TRUE(none.complete());
        waits.connect(served.port);
        EXPECT_TRUE(test::eventually(
            [&] { return served.said("cannot take another connection: Too many open files") == 1; }));
        open.send(frame(text_frame, "still here"));
        EXPECT_EQ(read_message(open).payload, "still here");
        // It looks again now and then, not without end: its thread sleeps between.
        std::size_t steps = 0;
        served.in_server([&] { steps = served.server().poll(); });
        EXPECT_LE(steps, 4U);
    }
    waits.send(served.request("GET /"));
    EXPECT_EQ(read_answer(waits).status, 403) << "its turn has come";
}

TEST(GatewayBounds, PortThatIsTaken) {
    Served served;
    Server other;
    try {
        other.listen("127.0.0.1", served.port, {.option = "--listen"});
        FAIL();
    } catch (const std::runtime_error& error) {
        const std::string said = error.what();
        EXPECT_NE(said.find("cannot listen at 127.0.0.1:" + std::to_string(served.port)), std::string::npos)
            << said;
        EXPECT_NE(said.find("(pid " + std::to_string(::getpid()) + ") has this port"), std::string::npos)
            << said;
        EXPECT_NE(said.find("another --listen"), std::string::npos) << said;
    }
}

TEST(GatewayBounds, OtherAddressesNeedTlsAndKeys) {
    Server server;
    for (const char* address : {"0.0.0.0", "::", "192.0.2.1"}) {
        try {
            server.listen(address, 0, {});
            FAIL() << address;
        } catch (const std::runtime_error& error) {
            EXPECT_NE(std::string(error.what()).find("--tls-certificate"), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(server.listen("nonsense", 0, {}), std::runtime_error);
    EXPECT_GT(server.listen("localhost", 0, {}), 0);
}

TEST(GatewayBounds, PeerOfAPair) {
    Server server;
    std::array<int, 2> pair{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()), 0);
    server.serve(pair[0], 80,
                 {.http = {{.method = "GET",
                            .path = "/",
                            .access = {.without_key = Role::observe},
                            .answer = [](const Request&) { return Response{.body = "here"}; }}}});
    const std::string request = "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    ASSERT_EQ(::write(pair[1], request.data(), request.size()), static_cast<ssize_t>(request.size()));
    std::string all;
    std::array<char, 4096> bytes{};
    while (all.find("here") == std::string::npos) {
        server.poll();
        const ssize_t got = ::recv(pair[1], bytes.data(), bytes.size(), MSG_DONTWAIT);
        if (got > 0) all.append(bytes.data(), static_cast<std::size_t>(got));
        if (got == 0) break;
    }
    EXPECT_TRUE(all.ends_with("here")) << all;
    ::close(pair[1]);
}

}  // namespace

}  // namespace knurl::gateway
