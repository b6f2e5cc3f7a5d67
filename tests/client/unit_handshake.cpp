// Another program answers on the socket, but it is no servo of this version: each case is refused with one
// line, nothing hangs, and no descriptor is kept.

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

#include "../temp_folder.hpp"
#include "refusal.hpp"

namespace unit_handshake_tests {
namespace {

using namespace knurl;
using namespace std::chrono_literals;

template <class Message>
std::span<const std::byte> bytes_of(const Message& message) {
    return std::as_bytes(std::span(&message, 1));
}

/// Answers each connection's first message as told.
class Impostor {
  public:
    using Answer = std::function<void(const shm::UniqueFd&)>;

    explicit Impostor(Answer answer) : answer_(std::move(answer)) {
        ::setenv("KNURL_RUNTIME_DIR", folder_.path().c_str(), 1);
        listener_ = shm::listen_at(protocol::socket_path("default"), 0600, 4);
        thread_ = std::thread([this] { serve(); });
    }
    ~Impostor() {
        const std::uint64_t one = 1;
        EXPECT_EQ(::write(ended_.get(), &one, sizeof one), static_cast<ssize_t>(sizeof one));
        thread_.join();
    }

  private:
    void serve() {
        for (;;) {
            std::array<pollfd, 2> either{pollfd{.fd = listener_.get(), .events = POLLIN, .revents = 0},
                                         pollfd{.fd = ended_.get(), .events = POLLIN, .revents = 0}};
            ::poll(either.data(), either.size(), -1);
            if (either[1].revents != 0) return;
            const shm::UniqueFd peer = shm::accept_from(listener_);
            if (!peer) continue;
            std::array<std::byte, 4096> buffer;
            shm::receive_message(peer, buffer);
            answer_(peer);
        }
    }

    Answer answer_;
    knurl::test::TempFolder folder_;
    shm::UniqueFd listener_, ended_{::eventfd(0, EFD_CLOEXEC)};
    std::thread thread_;
};

Error refusal_by(const Impostor::Answer& answer) {
    const Impostor impostor(answer);
    return client_test::refusal([] { Client::connect("knurl:default", {.wait = 0ms}); });
}

/// A welcome with one device whose memory is `segment`.
void welcome(const shm::UniqueFd& peer, int segment) {
    protocol::Welcome message;
    message.devices = 1;
    shm::send_message(peer, bytes_of(message), std::array{segment});
}

shm::Segment device_memory(std::uint64_t layout) {
    shm::Segment segment = shm::Segment::create("impostor", protocol::device_layout().total);
    protocol::DeviceInfo info;
    info.magic = protocol::segment_magic;
    info.layout_hash = layout;
    std::memcpy(segment.data(), &info, sizeof info);
    segment.seal_against_new_writers();
    return segment;
}

TEST(Handshake, a_servo_of_another_version_says_so_itself) {
    const Error error = refusal_by([](const shm::UniqueFd& peer) {
        protocol::Refused refused;
        std::string("build mismatch: version 2 here").copy(refused.text, sizeof refused.text - 1);
        shm::send_message(peer, bytes_of(refused));
    });
    EXPECT_EQ(error.kind, Error::Kind::incompatible);
    EXPECT_NE(std::string(error.what()).find("version 2 here"), std::string::npos);
}

TEST(Handshake, a_servo_that_is_full_is_asked_again_until_somebody_leaves) {
    int asked = 0;
    const Impostor full_twice([&](const shm::UniqueFd& peer) {
        if (++asked == 3) {
            protocol::Welcome message;
            shm::send_message(peer, bytes_of(message));
            return;
        }
        protocol::Refused refused{.full = 1};
        std::string("no place").copy(refused.text, sizeof refused.text - 1);
        shm::send_message(peer, bytes_of(refused));
    });
    const Error error = client_test::refusal([] { Client::connect("knurl:default", {.wait = 0ms}); });
    EXPECT_EQ(error.kind, Error::Kind::refused);
    EXPECT_NE(std::string(error.what()).find("no place"), std::string::npos) << error.what();
    Client::connect("knurl:default", {.wait = 20s, .reattach = false});
    EXPECT_EQ(asked, 3);
}

TEST(Handshake, whatever_is_not_a_welcome_is_no_servo_of_this_version) {
    for (const std::size_t size :
         {std::size_t{1}, std::size_t{7}, sizeof(protocol::Welcome), std::size_t{4096}}) {
        const Error error = refusal_by([=](const shm::UniqueFd& peer) {
            shm::send_message(peer, std::vector<std::byte>(size, std::byte{0x41}));
        });
        EXPECT_EQ(error.kind, Error::Kind::incompatible) << size << " bytes: " << error.what();
    }
    const Error error = refusal_by([](const shm::UniqueFd& peer) {
        protocol::Welcome message;
        message.devices = 3;  // without any descriptor
        shm::send_message(peer, bytes_of(message));
    });
    EXPECT_EQ(error.kind, Error::Kind::incompatible);
}

TEST(Handshake, report_memory_of_another_size_layout_or_without_seals_is_refused) {
    const Error layout =
        refusal_by([memory = std::make_shared<shm::Segment>(device_memory(protocol::wire_hash() + 1))](
                       const shm::UniqueFd& peer) { welcome(peer, memory->fd()); });
    EXPECT_EQ(layout.kind, Error::Kind::incompatible) << layout.what();
    const Error size = refusal_by([](const shm::UniqueFd& peer) {
        const shm::Segment small = shm::Segment::create("impostor", 4096);
        welcome(peer, small.fd());
    });
    EXPECT_EQ(size.kind, Error::Kind::incompatible) << size.what();
    const Error unsealed = refusal_by([](const shm::UniqueFd& peer) {
        const shm::UniqueFd open(::memfd_create("impostor", MFD_CLOEXEC));
        ASSERT_EQ(::ftruncate(open.get(), static_cast<off_t>(protocol::device_layout().total)), 0);
        welcome(peer, open.get());
    });
    EXPECT_EQ(unsealed.kind, Error::Kind::incompatible) << unsealed.what();
}

TEST(Handshake, one_that_hangs_up_counts_as_still_starting) {
    const Error error = refusal_by([](const shm::UniqueFd&) {});
    EXPECT_EQ(error.kind, Error::Kind::disconnected) << error.what();
    EXPECT_NE(std::string(error.what()).find("waited 0 ms"), std::string::npos) << error.what();
}

TEST(Handshake, refusals_leak_no_descriptor) {
    const auto open_now = [] {
        return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                             std::filesystem::directory_iterator());
    };
    const auto memory = std::make_shared<shm::Segment>(device_memory(1));
    const auto before = open_now();
    for (int i = 0; i < 50; ++i) refusal_by([=](const shm::UniqueFd& peer) { welcome(peer, memory->fd()); });
    EXPECT_EQ(open_now(), before);
}

}  // namespace

}  // namespace unit_handshake_tests
