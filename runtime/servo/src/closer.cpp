#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/servo/closer.hpp>
#include <knurl/shm/socket.hpp>

#include "child_process.hpp"

namespace knurl::servo {

namespace {

enum class Word : std::uint8_t { keep, now };

bool say(const shm::UniqueFd& to, Word word, std::span<const int> fds = {}) noexcept {
    try {
        return shm::send_message(to, std::as_bytes(std::span(&word, 1)), fds);
    } catch (const std::exception&) {  // too many descriptors are in flight
        return false;
    }
}

}  // namespace

Closer::Closer(std::string program) : program_(std::move(program)) {
    start();
}

Closer::~Closer() {
    hand_over_kept();
    socket_.reset();
    reap();
}

void Closer::start() {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
        throw std::runtime_error(fmt::format("knurld: no socket for its closer ({})", std::strerror(errno)));
    shm::UniqueFd ours(ends[0]), theirs(ends[1]);
    pid_t child = 0;
    if (const int error = start_child(program_, {close_descriptors_option}, {theirs.get(), theirs.get()},
                                      SCHED_OTHER, child);
        error != 0)
        throw std::runtime_error(fmt::format(
            "knurld: cannot start its closer ({}); see the limits of processes", std::strerror(error)));
    if (pid_ > 0) {
        // Some of what it closes may take any time, which nothing here waits for.
        ::kill(pid_, SIGKILL);
        ending_.push_back(pid_);
    }
    pid_ = child;
    socket_ = std::move(ours);
    reap();
}

void Closer::reap() noexcept {
    std::erase_if(ending_, [](pid_t pid) { return ::waitpid(pid, nullptr, WNOHANG) != 0; });
}

bool Closer::hand_over(shm::UniqueFd& fd) noexcept {
    const std::array fds{fd.get()};
    if (!say(socket_, Word::keep, fds)) return false;
    fd.reset();  // not the last one: the message, or the closer, holds another
    say(socket_, Word::now);
    return true;
}

bool Closer::hand_over_kept() noexcept {
    while (!kept_.empty() && hand_over(kept_.back())) kept_.pop_back();
    return kept_.empty();
}

void Closer::close(shm::UniqueFd fd) noexcept {
    if (!fd) return;
    ::shutdown(fd.get(), SHUT_RDWR);
    if (hand_over_kept() && hand_over(fd)) return;
    try {
        kept_.push_back(std::move(fd));
        start();
        hand_over_kept();
    } catch (const std::exception&) {  // the next one tries again
    }
}

int close_descriptors_main() {
    // It ends when knurld does. A signal to the whole group must not come first.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::signal(signal, SIG_IGN);
    ::prctl(PR_SET_NAME, "knurl-closer");
    leave_protection();
    // Whoever reads what knurld says must see its end, however long this process lives.
    if (const shm::UniqueFd nowhere(::open("/dev/null", O_WRONLY | O_CLOEXEC)); nowhere)
        ::dup2(nowhere.get(), STDERR_FILENO);
    std::vector<shm::UniqueFd> kept;
    for (;;) {
        std::array<std::byte, 1> word{};
        shm::Received received = shm::receive_message(STDIN_FILENO, word);
        if (received.closed) return 0;
        std::move(received.fds.begin(), received.fds.end(), std::back_inserter(kept));
        if (word[0] != std::byte{static_cast<std::uint8_t>(Word::now)}) continue;
        try {
            std::thread([closing = std::exchange(kept, {})] {}).detach();
        } catch (const std::exception&) {  // no thread left: what it held is closed already, here
        }
    }
}

}  // namespace knurl::servo
