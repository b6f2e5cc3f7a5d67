#pragma once
// A peer that can send any bytes.

#include <algorithm>
#include <optional>
#include <vector>

#include <poll.h>
#include <sys/socket.h>

#include <knurl/reps/constant_force.hpp>

#include "frame_stream.hpp"
#include "loopback.hpp"
#include "relay_support.hpp"
#include "wire.hpp"

namespace knurl::bridge::test {

/// A servo that already listens, since a stranger does not try again.
struct ServoUp : ServoProcess {
    explicit ServoUp(std::vector<std::string> arguments = {"--device", "sim:cartesian3"})
        : ServoProcess(std::move(arguments)) {
        Client::connect("knurl:default", {.wait = 20s});
    }
};

inline shm::UniqueFd dial(const BridgeProcess& bridge, int type = SOCK_STREAM) {
    return dial(bridge.port(), type);
}

/// Waits until the other end has disconnected. False: it has not in that time.
inline bool hung_up(const shm::UniqueFd& fd, int patience_ms = 20'000) {
    char buffer[4096];
    for (;;) {
        pollfd one{.fd = fd.get(), .events = POLLIN, .revents = 0};
        if (::poll(&one, 1, patience_ms) <= 0) return false;
        const ssize_t got = ::recv(fd.get(), buffer, sizeof buffer, 0);
        if (got <= 0) return true;
    }
}

inline void put(const shm::UniqueFd& fd, const std::vector<std::byte>& bytes) {
    [[maybe_unused]] const ssize_t sent = ::send(fd.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

template <class T>
std::vector<std::byte> frame(FrameType type, std::uint16_t stream, const T& body,
                             std::uint32_t bytes = sizeof(T)) {
    const FrameHeader header{.bytes = bytes, .type = static_cast<std::uint16_t>(type), .stream = stream};
    std::vector<std::byte> result(sizeof header + sizeof body);
    std::memcpy(result.data(), &header, sizeof header);
    std::memcpy(result.data() + sizeof header, &body, sizeof body);
    return result;
}

inline Hello hello() {
    Hello message;
    message.layout = wire_hash();
    put_text(message.client, "stranger");
    return message;
}

/// The next frame of that type. Frames of other types are skipped, but a refusal is thrown with its text.
/// Empty: the connection ended first.
inline std::vector<std::byte> await(FrameStream& stream, FrameType type) {
    while (stream.state() != FrameStream::State::closed) {
        stream.pump();
        while (const Frame* frame = stream.next()) {
            if (frame->type == static_cast<std::uint16_t>(type))
                return {frame->payload.begin(), frame->payload.end()};
            Refused refused;
            std::span<const std::byte> payload = frame->payload;
            if (frame->type == static_cast<std::uint16_t>(FrameType::refused) && take(payload, refused))
                throw std::runtime_error(text_of(refused.text));
        }
        pollfd one{.fd = stream.fd(), .events = POLLIN, .revents = 0};
        if (::poll(&one, 1, 20'000) != 1) break;
    }
    return {};
}
/// The same, with the payload as a T.
template <class T>
T await(FrameStream& stream, FrameType type) {
    const std::vector<std::byte> payload = await(stream, type);
    std::span<const std::byte> bytes = payload;
    T message;
    if (!take(bytes, message)) throw std::runtime_error("that frame did not come");
    return message;
}
/// Reads until the other end has closed the stream. False: nothing has come for 20 s.
inline bool ended(FrameStream& stream) {
    while (stream.state() != FrameStream::State::closed) {
        pollfd one{.fd = stream.fd(), .events = POLLIN, .revents = 0};
        if (::poll(&one, 1, 20'000) != 1) return false;
        stream.pump();
        while (stream.next() != nullptr) {
        }
    }
    return true;
}
template <class T>
void send(FrameStream& stream, FrameType type, const T& body, std::uint16_t id = 0) {
    stream.send(static_cast<std::uint16_t>(type), id, bytes_of(body));
}

/// Sends the greeting; returns the session's number.
inline std::uint64_t greet(FrameStream& stream) {
    send(stream, FrameType::hello, hello());
    return await<Welcome>(stream, FrameType::welcome).session;
}

inline Attached attach_observer(FrameStream& stream) {
    Attach attach;
    attach.request.observe = 1;
    send(stream, FrameType::attach, attach);
    return await<Attached>(stream, FrameType::attached);
}

/// Sends datagrams of a session that has no key.
class Pinger {
  public:
    Pinger(std::uint64_t session, shm::UniqueFd socket) : session_(session), socket_(std::move(socket)) {}

    std::vector<std::byte> ping(std::uint16_t port, std::uint64_t counter) {
        const DatagramHeader header{.session = session_, .counter = counter, .kind = DatagramKind::ping};
        std::vector<std::byte> bytes(sizeof header + sizeof(PingBody));
        std::memcpy(bytes.data(), &header, sizeof header);
        send(port, bytes);
        return bytes;
    }
    void send(std::uint16_t port, const std::vector<std::byte>& bytes) {
        const sockaddr_in to = loopback(port);
        ::sendto(socket_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                 sizeof to);
    }
    /// Takes one answer.
    bool answered(std::chrono::milliseconds patience = 10s) {
        pollfd one{.fd = socket_.get(), .events = POLLIN, .revents = 0};
        char nothing;
        return ::poll(&one, 1, static_cast<int>(patience.count())) == 1 &&
               ::recv(socket_.get(), &nothing, 1, 0) > 0;
    }

  private:
    std::uint64_t session_;
    shm::UniqueFd socket_;
};

/// A good application beside the bad ones: its reports come, its updates take effect, and its session is
/// still the first one. The delay is counted in the servo's cycles, and judged for most updates only, since
/// on a busy machine each process has to wait sometimes.
class Bystander {
  public:
    explicit Bystander(const BridgeProcess& bridge, const std::string& key = {})
        : client_(connect_to(bridge, key)), hand_(client_.claim("", {.shared = true})) {
        force_.emplace(hand_.add(at_once({})));
    }
    void expect_well() {
        std::vector<std::uint64_t> cycles;
        for (int i = 0; i < 21; ++i) {
            ASSERT_TRUE(hand_.next_report(10s));
            const std::uint64_t before = hand_.latest()->cycle;
            force_->set(at_once({1e-3 * ++count_, 0, 0}));
            ASSERT_TRUE(hand_.wait_applied(hand_.commit(), 10s));
            cycles.push_back(hand_.latest()->cycle - before);
        }
        std::ranges::nth_element(cycles, cycles.begin() + 10);
        EXPECT_LE(cycles[10], most_cycles) << "until an update is known to have taken effect, the median";
        EXPECT_EQ(hand_.reattachments(), 0u);
    }

  private:
    // An application that commits every 20 ms, like the README's, gets the answer before its next commit.
    static constexpr std::uint64_t most_cycles = 20;

    Client client_;
    Claim hand_;
    std::optional<Handle<ConstantForce>> force_;
    int count_ = 0;
};

}  // namespace knurl::bridge::test
