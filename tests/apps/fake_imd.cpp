#include "fake_imd.hpp"

#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace knurl::test {

namespace {

void append(std::string& to, std::uint32_t word) {
    to.append(reinterpret_cast<const char*>(&word), 4);
}

std::string header(int type, int length) {
    std::string bytes;
    append(bytes, htonl(static_cast<std::uint32_t>(type)));
    append(bytes, htonl(static_cast<std::uint32_t>(length)));
    return bytes;
}

bool send_all(int fd, const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
        const ssize_t sent = ::send(fd, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
        if (sent <= 0) return false;
        at += static_cast<std::size_t>(sent);
    }
    return true;
}

std::uint32_t at(const std::string& bytes, std::size_t place) {
    std::uint32_t word;
    std::memcpy(&word, bytes.data() + place, 4);
    return word;
}

/// False: `stop` came first.
bool readable(int fd, int stop, double seconds = -1) {
    pollfd two[] = {{.fd = stop, .events = POLLIN, .revents = 0}, {.fd = fd, .events = POLLIN, .revents = 0}};
    ::poll(two, fd >= 0 ? 2 : 1, seconds < 0 ? -1 : static_cast<int>(std::ceil(seconds * 1e3)));
    return (two[0].revents & POLLIN) == 0;
}

}  // namespace

FakeImd::FakeImd(FakeImdOptions options)
    : options_(options),
      listening_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)),
      stop_(::eventfd(0, EFD_CLOEXEC)) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(listening_.get(), reinterpret_cast<sockaddr*>(&here), sizeof here);
    ::listen(listening_.get(), 4);
    socklen_t size = sizeof here;
    ::getsockname(listening_.get(), reinterpret_cast<sockaddr*>(&here), &size);
    port_ = ntohs(here.sin_port);
    for (int i = 0; i < options_.atoms; ++i) places_.push_back({2.0 * i, 1, -1});
    thread_ = std::thread([this] {
        if (!readable(listening_.get(), stop_.get())) return;
        const shm::UniqueFd fd(::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC));
        serve(fd.get());
        // Reads the last messages as well, unless a frame could not be sent; then it closes.
        while (!unheard_ && readable(fd.get(), stop_.get(), 10) && read_orders(fd.get())) {
        }
        const std::lock_guard lock(mutex_);
        gone_ = true;
        changed_.notify_all();
    });
}

FakeImd::~FakeImd() {
    ::eventfd_write(stop_.get(), 1);
    thread_.join();
}

std::string FakeImd::address() const {
    return "127.0.0.1:" + std::to_string(port_);
}

bool FakeImd::eventually_gone() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(30), [&] { return gone_; });
}

std::uint32_t FakeImd::word(std::uint32_t value) const {
    return options_.swapped ? __builtin_bswap32(value) : value;
}

void FakeImd::serve(int fd) {
    if (!options_.greets) {
        readable(-1, stop_.get());
        return;
    }
    std::string greeting = header(4, 0).substr(0, 4);
    append(greeting, word(static_cast<std::uint32_t>(options_.version)));
    greeting.resize(static_cast<std::size_t>(options_.handshake_bytes));
    if (!send_all(fd, greeting)) return;
    if (options_.handshake_bytes < 8) {
        ::shutdown(fd, SHUT_WR);
        return;
    }
    // `go` must arrive within a second; a client that sends anything else gets no simulation.
    if (!readable(fd, stop_.get(), 5) || !read_orders(fd)) return;
    while (readable(-1, stop_.get(), rate_ / options_.steps_per_second)) {
        if (options_.pause_at == frame_ && !readable(-1, stop_.get(), options_.pause)) return;
        while (true) {
            pollfd one{.fd = fd, .events = POLLIN, .revents = 0};
            if (::poll(&one, 1, 0) <= 0) break;
            if (!read_orders(fd)) return;
        }
        if (killed_ || said_goodbye_) return;
        if (!send_frame(fd)) {
            ::shutdown(fd, SHUT_WR);
            return;
        }
    }
}

bool FakeImd::send_frame(int fd) {
    {
        const std::lock_guard lock(mutex_);
        for (const auto& [atom, force] : forces_)
            for (std::size_t i = 0; i < 3; ++i)
                places_[static_cast<std::size_t>(atom)][i] +=
                    options_.mobility * rate_ * static_cast<double>(force[i]);
    }
    step_ += rate_;
    const int number = options_.once_pulled && !was_pulled_ ? -2 : frame_++;
    std::string bytes = header(1, 1);
    append(bytes, word(static_cast<std::uint32_t>(step_)));
    const bool hot = options_.hot_at >= 0 && number >= options_.hot_at;
    append(bytes, word(std::bit_cast<std::uint32_t>(hot ? 1000.0F : options_.temperature)));
    for (int i = 0; i < 8; ++i) append(bytes, word(std::bit_cast<std::uint32_t>(static_cast<float>(i))));
    const int atoms = options_.atoms + (number == options_.more_atoms_at);
    bytes += number == options_.nonsense_at ? header(77, 1) : header(2, atoms);
    for (int i = 0; i < atoms; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& place = places_[static_cast<std::size_t>(std::min(i, options_.atoms - 1))];
            const auto value = number == options_.nan_at ? std::numeric_limits<float>::quiet_NaN()
                                                         : static_cast<float>(place[k]);
            append(bytes, word(std::bit_cast<std::uint32_t>(value)));
        }
    if (number == options_.cut_at) bytes.resize(bytes.size() - 20);
    if (number == options_.goodbye_at) bytes += header(0, 0);
    unheard_ = !send_all(fd, bytes);
    return !unheard_ && number != options_.cut_at && number != options_.close_at;
}

/// False: the other end has disconnected.
bool FakeImd::read_orders(int fd) {
    char bytes[4096];
    const ssize_t got = ::recv(fd, bytes, sizeof bytes, 0);
    if (got <= 0) return false;
    unread_.append(bytes, static_cast<std::size_t>(got));
    while (unread_.size() >= 8) {
        const int type = static_cast<int>(ntohl(at(unread_, 0))),
                  length = static_cast<int>(ntohl(at(unread_, 4)));
        const std::size_t body = type == 6 ? 16 * static_cast<std::size_t>(length) : 0;
        if (unread_.size() < 8 + body) break;
        if (type == 0) said_goodbye_ = true;
        if (type == 5) killed_ = true;
        if (type == 8) rate_ = length;
        if (type == 6) {
            const std::lock_guard lock(mutex_);
            forces_.clear();
            ++forces_read_;
            const auto n = static_cast<std::size_t>(length);
            for (std::size_t i = 0; i < n; ++i) {
                std::array<float, 3> force;
                for (std::size_t k = 0; k < 3; ++k)
                    force[k] = std::bit_cast<float>(word(at(unread_, 8 + 4 * n + 12 * i + 4 * k)));
                if (force != std::array<float, 3>{}) was_pulled_ = true;
                const auto atom = static_cast<int>(word(at(unread_, 8 + 4 * i)));
                if (atom >= 0 && atom < options_.atoms) forces_[atom] = force;
            }
            changed_.notify_all();
        }
        unread_.erase(0, 8 + body);
    }
    return true;
}

}  // namespace knurl::test
