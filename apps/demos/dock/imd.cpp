#include "imd.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace dock {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using knurl::shm::UniqueFd;

struct HostAndPort {
    std::string host, port;
};

HostAndPort parts_of(const std::string& address) {
    const auto colon = address.rfind(':');
    HostAndPort parts;
    if (colon != std::string::npos) {
        parts = {address.substr(0, colon), address.substr(colon + 1)};
        if (parts.host.size() > 2 && parts.host.front() == '[' && parts.host.back() == ']')
            parts.host = parts.host.substr(1, parts.host.size() - 2);
    }
    const bool number =
        !parts.port.empty() && parts.port.find_first_not_of("0123456789") == std::string::npos;
    if (parts.host.empty() || !number || parts.port.size() > 5 || std::stoi(parts.port) > 65535)
        throw ImdError(fmt::format("'{}' is no HOST:PORT of a simulation, as localhost:8889 is", address));
    return parts;
}

bool poll_for(int fd, short events, std::chrono::milliseconds timeout) {
    pollfd one{.fd = fd, .events = events, .revents = 0};
    return ::poll(&one, 1, static_cast<int>(std::max<std::chrono::milliseconds::rep>(0, timeout.count()))) >
           0;
}

std::chrono::milliseconds left(Clock::time_point deadline) {
    return std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
}

/// Reads all remaining data, so that the last message arrives: closing with unread frames would reset the
/// connection and discard data under way. Allocates nothing.
void hear_out(int socket, Clock::time_point deadline) {
    ::shutdown(socket, SHUT_WR);
    char bytes[4096];
    while (poll_for(socket, POLLIN, left(deadline)) && left(deadline).count() > 0) {
        const ssize_t got = ::recv(socket, bytes, sizeof bytes, MSG_DONTWAIT);
        if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN)) return;
    }
}

UniqueFd connected(const std::string& address, std::chrono::milliseconds patience) {
    const HostAndPort parts = parts_of(address);
    const auto deadline = Clock::now() + patience;
    addrinfo hints{}, *found = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    if (const int error = ::getaddrinfo(parts.host.c_str(), parts.port.c_str(), &hints, &found); error != 0)
        throw ImdError(fmt::format("{}: {}", address, ::gai_strerror(error)));
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> all(found, ::freeaddrinfo);
    int error = ETIMEDOUT;
    for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
        UniqueFd fd(::socket(one->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
        if (!fd) continue;
        error = ::connect(fd.get(), one->ai_addr, one->ai_addrlen) == 0 ? 0 : errno;
        if (error == EINPROGRESS) {
            error = ETIMEDOUT;
            socklen_t size = sizeof error;
            if (poll_for(fd.get(), POLLOUT, left(deadline)))
                ::getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &error, &size);
        }
        if (error != 0) continue;
        const int yes = 1;
        ::setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
        return fd;
    }
    throw ImdError(
        fmt::format("{}: {}; is a simulation running there, as `gmx mdrun -imdwait -imdpull -imdport {}`?",
                    address, std::strerror(error), parts.port));
}

}  // namespace

namespace {

/// Of another process; no allocation.
bool is_stopped(pid_t pid) {
    char path[32], text[512];
    std::snprintf(path, sizeof path, "/proc/%d/stat", static_cast<int>(pid));
    const int fd = ::open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return false;
    const ssize_t got = ::read(fd, text, sizeof text - 1);
    ::close(fd);
    text[std::max<ssize_t>(got, 0)] = 0;
    const char* const state = std::strrchr(text, ')');  // behind the name, which may contain anything
    return state != nullptr && (state[2] == 'T' || state[2] == 't');
}

void say_to(int socket, const std::string& bytes) {
    [[maybe_unused]] const ssize_t sent =
        ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

constexpr auto look_for_stops = 50ms;

}  // namespace

void LastWord::Unmap::operator()(Shared* shared) const {
    ::munmap(shared, sizeof *shared);
}

LastWord::LastWord(int socket, const std::string& when_dead, const std::string& when_stopped) {
    void* const memory =
        ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED)
        throw ImdError(fmt::format("cannot map shared memory: {}", std::strerror(errno)));
    shared_.reset(new (memory) Shared);
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
        throw ImdError(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
    UniqueFd theirs(ends[0]);
    alive_ = UniqueFd(ends[1]);
    const pid_t parent = ::getpid();
    pid_ = ::fork();
    if (pid_ < 0) throw ImdError(fmt::format("no second process: {}", std::strerror(errno)));
    if (pid_ > 0) return;
    // The child: keeps the connection open for one more message. Allocates nothing.
    ::setpgid(0, 0);  // Ctrl-C must not reach it
    ::prctl(PR_SET_NAME, "imd-last-word");
    for (int fd = 0, last = static_cast<int>(::sysconf(_SC_OPEN_MAX)); fd < std::min(last, 1024); ++fd)
        if (fd != theirs.get() && fd != socket) ::close(fd);
    bool said = false;
    while (!poll_for(theirs.get(), POLLIN, look_for_stops)) {
        const bool stopped = is_stopped(parent);
        if (stopped && !said && !shared_->within_message) {
            shared_->was_stopped = true;  // first: the parent may continue at any moment
            say_to(socket, when_stopped);
        }
        said = stopped && (said || shared_->was_stopped);
    }
    char byte;
    ssize_t got;
    while ((got = ::read(theirs.get(), &byte, 1)) < 0 && errno == EINTR) {
    }
    if (got == 0) {
        poll_for(socket, POLLOUT, 1s);
        say_to(socket, when_dead);
        hear_out(socket, Clock::now() + 1s);
    }
    ::_exit(0);
}

LastWord::~LastWord() {
    [[maybe_unused]] const ssize_t written = ::write(alive_.get(), "x", 1);
    ::waitpid(pid_, nullptr, 0);
}

Imd::Imd(const std::string& address, std::chrono::milliseconds patience)
    : address_(address), socket_(connected(address, patience)) {
    shake_hands(patience);
    last_word_.emplace(socket_.get(),
                       imd_force(0, Eigen::Vector3f::Zero(), swapped()) + imd_header(ImdType::disconnect, 0),
                       imd_force(0, Eigen::Vector3f::Zero(), swapped()));
}

Imd::~Imd() {
    try {
        if (!ended_) {
            let_go();
            say(imd_header(ImdType::disconnect, 0));
            const auto deadline = Clock::now() + 1s;
            while (!ended_ && !unsent_.empty() && poll_for(socket_.get(), POLLOUT, left(deadline))) flush();
            hear_out(socket_.get(), deadline);
        }
    } catch (const std::exception&) {  // it has gone first
    }
    ::shutdown(socket_.get(), SHUT_RDWR);
}

void Imd::fail(const std::string& what) const {
    throw ImdError(fmt::format("{}: {}", address_, what));
}

void Imd::shake_hands(std::chrono::milliseconds patience) {
    const auto deadline = Clock::now() + patience;
    try {
        while (!reader_.greeted()) {
            if (!poll_for(socket_.get(), POLLIN, left(deadline)))
                fail("it accepts the connection and sends nothing; does another program hold it already?");
            receive();
            // A frame before our answer is invalid: there is none yet.
            reader_.next();
            if (ended_) fail("it closed the connection before IMD's handshake was whole");
        }
    } catch (const ImdError& error) {
        const std::string text = error.what();
        throw ImdError(text.starts_with(address_) ? text : fmt::format("{}: {}", address_, text));
    }
    say(imd_header(ImdType::go, 0));
}

void Imd::receive() {
    std::array<std::byte, 65536> bytes;
    for (int reads = 0; reads < 16; ++reads) {  // more data stay in the socket, which slows the sender down
        const ssize_t got = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
        if (got > 0) {
            reader_.feed({bytes.data(), static_cast<std::size_t>(got)});
            if (static_cast<std::size_t>(got) == bytes.size()) continue;
            return;
        }
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
        ended_ = true;
        return;
    }
}

std::optional<ImdFrame> Imd::next() {
    flush();
    try {
        auto frame = reader_.next();
        if (!frame && !ended_) {
            receive();
            frame = reader_.next();
        }
        if (!frame && ended_ && reader_.within_message())
            throw ImdError("the connection ended within a message; was the simulation killed?");
        return frame;
    } catch (const ImdError& error) {
        broken_ = true;
        let_go();  // it may well understand that
        fail(error.what());
    }
}

bool Imd::wait(std::chrono::milliseconds timeout) const {
    return poll_for(socket_.get(), POLLIN, timeout);
}

void Imd::pull(std::int32_t atom, const Eigen::Vector3d& force) {
    newest_force_ = imd_force(atom, force.cast<float>(), swapped());
    flush();
}

void Imd::set_rate(int steps) {
    say(imd_header(ImdType::rate, steps));
}

void Imd::kill() {
    say(imd_header(ImdType::kill, 0));
}

void Imd::say(const std::string& message) {
    unsent_ += std::exchange(newest_force_, {});
    unsent_ += message;
    flush();
}

void Imd::flush() {
    if (unsent_.empty()) unsent_ = std::exchange(newest_force_, {});
    while (!unsent_.empty() && !ended_) {
        if (last_word_) last_word_->within_message(true);
        const ssize_t sent =
            ::send(socket_.get(), unsent_.data(), unsent_.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent == static_cast<ssize_t>(unsent_.size()) && last_word_) last_word_->within_message(false);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
        if (sent < 0) {
            ended_ = true;
            return;
        }
        unsent_.erase(0, static_cast<std::size_t>(sent));
        if (unsent_.empty()) unsent_ = std::exchange(newest_force_, {});
    }
}

}  // namespace dock
