#include "latency_udp.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <span>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <unistd.h>

namespace knurl::cli {

namespace {

constexpr Nanoseconds pace = 1'000'000;
constexpr std::size_t cold_datagrams = 2;
constexpr int most_calls = 20;  // until an answer arrives
constexpr Nanoseconds call_interval = 100'000'000;

/// Echoes one datagram. An empty one asks to check for the end.
void echo_one(int fd) {
    char bytes[2048];
    sockaddr_storage from{};
    socklen_t length = sizeof from;
    const ssize_t got = ::recvfrom(fd, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&from), &length);
    if (got > 0)
        ::sendto(fd, bytes, static_cast<std::size_t>(got), 0, reinterpret_cast<sockaddr*>(&from), length);
}

/// One caller of an echo.
class Caller {
  public:
    explicit Caller(const bridge::Endpoint& echo)
        : fd_(::socket(echo.family(), SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        if (!fd_ || ::connect(fd_.get(), echo.get(), echo.length) != 0)
            throw std::runtime_error(
                fmt::format("cannot reach the echo at {}: {}", echo.text, std::strerror(errno)));
    }

    /// False: it did not return in time.
    bool call(std::span<char> datagram, Nanoseconds until) {
        ++number_;
        std::memcpy(datagram.data(), &number_, sizeof number_);
        ::send(fd_.get(), datagram.data(), datagram.size(), MSG_NOSIGNAL);
        for (std::uint64_t got = 0; got != number_;) {  // an earlier one may arrive late
            if (!ready(fd_.get(), POLLIN, until)) return false;
            if (::recv(fd_.get(), &got, sizeof got, MSG_TRUNC) < static_cast<ssize_t>(sizeof got))
                return false;
        }
        return true;
    }

  private:
    shm::UniqueFd fd_;
    std::uint64_t number_ = 0;
};

}  // namespace

shm::UniqueFd udp_echo_socket(const bridge::Endpoint& at) {
    shm::UniqueFd fd(::socket(at.family(), SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (!fd || ::bind(fd.get(), at.get(), at.length) != 0)
        throw std::runtime_error(fmt::format("cannot echo at {}: {}", at.text, std::strerror(errno)));
    return fd;
}

struct UdpEcho::Impl {
    bridge::Endpoint at = bridge::resolve("127.0.0.1:0");
    shm::UniqueFd fd = udp_echo_socket(at);
    std::atomic<bool> done = false;
    std::thread thread;
};

UdpEcho::UdpEcho(const Placement& placement) : impl_(std::make_unique<Impl>()) {
    impl_->at.length = sizeof impl_->at.address;
    ::getsockname(impl_->fd.get(), impl_->at.get(), &impl_->at.length);
    impl_->thread = std::thread([this, placement] {
        settle_on(placement.servo_cpu, placement.priority);
        while (!impl_->done) echo_one(impl_->fd.get());
    });
}

UdpEcho::~UdpEcho() {
    impl_->done = true;
    const shm::UniqueFd wake(::socket(impl_->at.family(), SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ::sendto(wake.get(), "", 0, 0, impl_->at.get(), impl_->at.length);
    impl_->thread.join();
}

const bridge::Endpoint& UdpEcho::at() const {
    return impl_->at;
}

void serve_udp_echo(shm::UniqueFd socket) {
    for (;;) echo_one(socket.get());
}

bool udp_echoes(const bridge::Endpoint& echo) {
    Caller caller(echo);
    char datagram[8] = {};
    for (int i = 0; i < most_calls; ++i) {
        const Nanoseconds next = now_ns() + call_interval;
        if (caller.call(datagram, next)) return true;
        sleep_until(next);
    }
    return false;
}

void udp_echo_block(const bridge::Endpoint& echo, std::size_t bytes, Nanoseconds length,
                    std::vector<double>& samples) {
    Caller caller(echo);
    std::vector<char> datagram(bytes);
    const Nanoseconds begin = now_ns(), end = begin + length;
    std::size_t answered = 0;
    for (Nanoseconds at = begin + pace; at < end; at = std::max(at + pace, now_ns())) {
        sleep_until(at);
        const Nanoseconds sent = now_ns();
        if (!caller.call(datagram, end) || answered++ < cold_datagrams) continue;
        // Samples that were due in the meantime would have waited from their own due times on.
        for (Nanoseconds took = now_ns() - sent; took > 0; took -= pace)
            samples.push_back(static_cast<double>(took) / 2);
    }
}

}  // namespace knurl::cli
