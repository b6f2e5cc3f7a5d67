#include "latency_tcp.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace knurl::cli {

namespace {

constexpr Nanoseconds breath = 10'000'000;  // when no connection can be accepted

shm::UniqueFd new_socket(const bridge::Endpoint& at) {
    return shm::UniqueFd(::socket(at.family(), SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

void send_at_once(int fd) {
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

bool later(ssize_t result) {
    return result < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
}

/// Bytes that one peer has sent and not received back yet.
struct Peer {
    shm::UniqueFd fd;
    Nanoseconds heard = 0;
    std::array<char, 4096> bytes;
    std::size_t begin = 0, end = 0;

    // Reads again only after all has been sent back.
    short wanted() const { return begin == end ? POLLIN : POLLOUT; }

    void accept(shm::UniqueFd from) {
        fd = std::move(from);
        send_at_once(fd.get());
        heard = now_ns();
        begin = end = 0;
    }

    void serve() {
        if (begin == end) {
            const ssize_t got = ::recv(fd.get(), bytes.data(), bytes.size(), 0);
            if (later(got)) return;
            if (got <= 0) return fd.reset();
            heard = now_ns();
            begin = 0;
            end = static_cast<std::size_t>(got);
        }
        const ssize_t sent = ::send(fd.get(), bytes.data() + begin, end - begin, MSG_NOSIGNAL);
        if (later(sent)) return;
        if (sent < 0) return fd.reset();
        begin += static_cast<std::size_t>(sent);
    }
};

}  // namespace

struct TcpEcho::Impl {
    bridge::Endpoint at;
    shm::UniqueFd listener, stop{::eventfd(0, EFD_CLOEXEC)};
    std::array<Peer, places> peers;
    std::thread thread;

    /// A free place, or else the place of the peer that has been silent longest.
    Peer& place() {
        return *std::ranges::min_element(peers, {}, [](const Peer& p) { return p.fd ? p.heard : 0; });
    }

    void accept() {
        shm::UniqueFd fd(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        if (fd)
            place().accept(std::move(fd));
        else if (errno != EAGAIN && errno != ECONNABORTED && errno != EINTR)
            sleep_until(now_ns() + breath);  // out of descriptors: the peer waits in the queue
    }

    void run() {
        std::array<pollfd, places + 2> sources{};
        for (;;) {
            sources[0] = {.fd = stop.get(), .events = POLLIN, .revents = 0};
            sources[1] = {.fd = listener.get(), .events = POLLIN, .revents = 0};
            for (std::size_t i = 0; i < places; ++i)  // poll() skips free places: -1
                sources[i + 2] = {.fd = peers[i].fd.get(), .events = peers[i].wanted(), .revents = 0};
            if (::poll(sources.data(), sources.size(), -1) < 0) continue;
            if (sources[0].revents != 0) return;
            for (std::size_t i = 0; i < places; ++i)
                if (sources[i + 2].revents != 0) peers[i].serve();
            if (sources[1].revents != 0) accept();
        }
    }
};

TcpEcho::TcpEcho(const bridge::Endpoint& at, const std::optional<Placement>& placement)
    : impl_(std::make_unique<Impl>()) {
    impl_->at = at;
    impl_->listener = new_socket(at);
    const int fd = impl_->listener.get(), on = 1;
    ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (::bind(fd, at.get(), at.length) != 0 || ::listen(fd, static_cast<int>(places)) != 0)
        throw std::runtime_error(fmt::format("cannot echo at {}: {}", at.text, std::strerror(errno)));
    impl_->at.length = sizeof impl_->at.address;
    ::getsockname(fd, impl_->at.get(), &impl_->at.length);
    impl_->at.text = bridge::numeric(impl_->at.address);
    impl_->thread = std::thread([impl = impl_.get(), placement] {
        if (placement) settle_on(placement->servo_cpu, placement->priority);
        impl->run();
    });
}

TcpEcho::~TcpEcho() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto bytes = ::write(impl_->stop.get(), &one, sizeof one);
    impl_->thread.join();
}

const bridge::Endpoint& TcpEcho::at() const {
    return impl_->at;
}

TcpCaller::TcpCaller(const bridge::Endpoint& echo, std::size_t bytes, Nanoseconds until)
    : fd_(new_socket(echo)), sent_(std::max(bytes, sizeof number_)), came_(sent_.size()) {
    if (!fd_) return;
    send_at_once(fd_.get());
    if (::connect(fd_.get(), echo.get(), echo.length) == 0) return;
    int error = errno;
    if (error == EINPROGRESS && ready(fd_.get(), POLLOUT, until)) {
        socklen_t length = sizeof error;
        ::getsockopt(fd_.get(), SOL_SOCKET, SO_ERROR, &error, &length);
    }
    if (error != 0) fd_.reset();
}

std::optional<double> TcpCaller::round_trip(Nanoseconds until) {
    if (!fd_) return std::nullopt;
    ++number_;
    std::memcpy(sent_.data(), &number_, sizeof number_);
    const Nanoseconds begin = now_ns();
    const ssize_t sent = ::send(fd_.get(), sent_.data(), sent_.size(), MSG_NOSIGNAL);
    if (sent != static_cast<ssize_t>(sent_.size()) || !take(until)) {
        fd_.reset();  // after a partial message nothing can be parsed
        return std::nullopt;
    }
    return static_cast<double>(now_ns() - begin);
}

bool TcpCaller::take(Nanoseconds until) {
    for (std::size_t there = 0; there < came_.size();) {
        if (!ready(fd_.get(), POLLIN, until)) return false;
        const ssize_t got = ::recv(fd_.get(), came_.data() + there, came_.size() - there, 0);
        if (later(got)) continue;
        if (got <= 0) return false;
        there += static_cast<std::size_t>(got);
    }
    return came_ == sent_;  // else it is no such echo
}

}  // namespace knurl::cli
