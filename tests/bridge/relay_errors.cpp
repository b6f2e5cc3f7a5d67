// The message for each mistake, at the end that can correct it.

#include <thread>

#include <sys/socket.h>
#include <sys/stat.h>

#include "loopback.hpp"
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
    for (const char* listen : {"0.0.0.0:0", "[::]:0", "192.0.2.1:4096"}) {
        refused({}, listen, "needs keys");
        refused({"--anyone"}, listen, "needs keys");
    }
    refused({}, "127.0.0.1:0", "every user of this host could move the hand");
    refused({}, "[::1]:0", "or give --anyone");
    refused({}, "127.0.0.1:x", "the port is a number");
    refused({"--keys", "/no/such/file"}, "127.0.0.1:0", "/no/such/file");
    for (const char* name : {"a/b", ".a", "a b"})
        refused({"--anyone", "--servo", name}, "127.0.0.1:0", "no servo has such a name");

    KeyRing ring;
    ring.add("anna", Role::control);
    refused({"--keys", ring.file()}, "192.0.2.1:4096", "an address that this host has");
    refused({"--keys", ring.file(), "--anyone"}, "127.0.0.1:0", "give one of the two");
    ::chmod(ring.file().c_str(), 0644);
    refused({"--keys", ring.file()}, "127.0.0.1:0", "600");

    BridgeProcess first;
    refused({"--anyone"}, first.host_and_port(), "another program has this port");
}

TEST(Mistakes, a_bridge_without_a_servo_says_so_to_its_peers_and_takes_them_when_there_is_one) {
    ServoProcess servo;
    servo.end(SIGKILL);
    BridgeProcess bridge;
    says(bridge.first_line(), "but no servo 'default' listens");
    says(bridge.first_line(), "clients are told so until then");
    const Error error = refused_by(bridge);
    EXPECT_EQ(error.kind, Error::Kind::no_servo);
    says(error.what(), "no servo 'default' listens");
    servo.start();
    EXPECT_EQ(connect_to(bridge).servo_pid(), servo.pid());
    BridgeProcess late;
    EXPECT_EQ(late.first_line(), "knurl-bridge: servo 'default' is reached at " + late.address());
}

TEST(Mistakes, something_else_that_listens_there_is_no_bridge) {
    const shm::UniqueFd listener = bound(SOCK_STREAM);
    ASSERT_EQ(::listen(listener.get(), 4), 0);
    const std::string address = "knurl://127.0.0.1:" + std::to_string(port_of(listener));
    std::thread other([&] {
        const int peer = ::accept(listener.get(), nullptr, nullptr);
        const std::string text = "HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n";
        [[maybe_unused]] const ssize_t sent = ::write(peer, text.data(), text.size());
        char answer[256];
        while (::read(peer, answer, sizeof answer) > 0) {
        }
        ::close(peer);
    });
    // The client waits for a bridge that may be starting; the other program answers only one call.
    const Error error = refusal([&] { Client::connect(address, {.wait = 20s}); });
    EXPECT_EQ(error.kind, Error::Kind::incompatible) << error.what();
    says(error.what(), "is no knurl-bridge of this version; is that its port (4096");
    other.join();
    // The client waits for a program that accepts and sends nothing, but not without end.
    const Error mute = refusal([&] { Client::connect(address, {.wait = 0ms}); });
    EXPECT_EQ(mute.kind, Error::Kind::no_servo);
    says(mute.what(), "does not answer");
}

}  // namespace
}  // namespace knurl::bridge::test
