// What each mistake is answered with, at the end that can mend it.

#include <thread>

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include "relay_support.hpp"

namespace knurl::bridge::test {
namespace {

TEST(Mistakes, of_who_connects) {
    const Error nobody = refusal([] { Client::connect("knurl://127.0.0.1:1", {.wait = 0ms}); });
    EXPECT_EQ(nobody.kind, Error::Kind::no_servo);
    says(nobody.what(), "no bridge listens at 127.0.0.1:1");
    const Error unknown = refusal([] { Client::connect("knurl://no-such-host.invalid", {.wait = 5s}); });
    EXPECT_EQ(unknown.kind, Error::Kind::no_servo);
    says(unknown.what(), "'no-such-host.invalid' is not known here");
}

TEST(Mistakes, of_who_starts_a_bridge) {
    const auto refused = [](const std::vector<std::string>& arguments, const std::string& listen,
                            const std::string& words) {
        BridgeProcess bridge(arguments, listen);
        says(bridge.first_line(), words);
        EXPECT_TRUE(bridge.line().empty()) << "one line";
        EXPECT_NE(bridge.status(), 0);
    };
    refused({}, "0.0.0.0:0", "needs keys");
    refused({}, "[::]:0", "needs keys");
    refused({}, "192.0.2.1:4096", "needs keys");
    refused({}, "127.0.0.1:x", "the port is a number");
    refused({"--keys", "/no/such/file"}, "127.0.0.1:0", "/no/such/file");

    KeyRing ring;
    ring.add("anna", Role::control);
    refused({"--keys", ring.file()}, "192.0.2.1:4096", "an address that this host has");
    ::chmod(ring.file().c_str(), 0644);
    refused({"--keys", ring.file()}, "127.0.0.1:0", "600");

    BridgeProcess first;
    refused({}, first.host_and_port(), "another program has this port");
}

TEST(Mistakes, a_bridge_without_a_servo_says_so_to_its_peers_and_takes_them_when_there_is_one) {
    ServoProcess servo;
    servo.end(SIGKILL);
    BridgeProcess bridge;
    const Error error = refused_by(bridge);
    EXPECT_EQ(error.kind, Error::Kind::no_servo);
    says(error.what(), "no servo 'default' listens");
    servo.start();
    EXPECT_EQ(connect_to(bridge).servo_pid(), servo.pid());
}

TEST(Mistakes, something_else_that_listens_there_is_no_bridge) {
    const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in at{
        .sin_family = AF_INET, .sin_port = 0, .sin_addr = {htonl(INADDR_LOOPBACK)}, .sin_zero = {}};
    socklen_t length = sizeof at;
    ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&at), sizeof at), 0);
    ASSERT_EQ(::listen(listener, 4), 0);
    ::getsockname(listener, reinterpret_cast<sockaddr*>(&at), &length);
    const std::string address = "knurl://127.0.0.1:" + std::to_string(ntohs(at.sin_port));
    std::thread other([&] {
        const int peer = ::accept(listener, nullptr, nullptr);
        const std::string text = "HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n";
        [[maybe_unused]] const ssize_t sent = ::write(peer, text.data(), text.size());
        char answer[256];
        while (::read(peer, answer, sizeof answer) > 0) {
        }
        ::close(peer);
    });
    const Error error = refusal([&] { Client::connect(address, {.wait = 0ms}); });
    EXPECT_NE(std::string(error.what()).size(), 0u);
    other.join();
    // One that accepts and says nothing is waited for, and not for ever.
    const Error mute = refusal([&] { Client::connect(address, {.wait = 0ms}); });
    EXPECT_EQ(mute.kind, Error::Kind::no_servo);
    says(mute.what(), "does not answer");
    ::close(listener);
}

}  // namespace
}  // namespace knurl::bridge::test
