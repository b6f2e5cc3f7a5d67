#include <algorithm>
#include <atomic>
#include <mutex>
#include <vector>

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <knurl/link/error.hpp>
#include <knurl/link/fork_guard.hpp>

namespace knurl::detail {

namespace {

// Relaxed: only a child that still has one thread changes it, and it orders nothing.
std::atomic<std::uint64_t> generation{0};

struct Registry {
    std::mutex mutex;
    std::vector<int> sockets;
};

Registry& registry();

void before_fork() {
    registry().mutex.lock();
}
void in_parent() {
    registry().mutex.unlock();
}

// Only async-signal-safe calls: the parent's other threads may have been in any state.
void in_child() {
    const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int fd : registry().sockets) {
        if (nowhere < 0 || ::dup3(nowhere, fd, O_CLOEXEC) < 0) ::close(fd);
    }
    if (nowhere >= 0) ::close(nowhere);
    registry().sockets.clear();
    generation.fetch_add(1, std::memory_order::relaxed);
    registry().mutex.unlock();
}

// Never destroyed: a fork may happen while statics are being destroyed.
Registry& registry() {
    static Registry* const instance = [] {
        auto* made = new Registry;
        ::pthread_atfork(before_fork, in_parent, in_child);
        return made;
    }();
    return *instance;
}

}  // namespace

std::uint64_t fork_generation() noexcept {
    return generation.load(std::memory_order::relaxed);
}

LostInChild::LostInChild(int fd) : fd_(fd) {
    const std::lock_guard lock(registry().mutex);
    registry().sockets.push_back(fd);
}

LostInChild::~LostInChild() {
    if (made_in_ != fork_generation()) return;
    const std::lock_guard lock(registry().mutex);
    std::erase(registry().sockets, fd_);
}

void require_own(std::uint64_t made_in) {
    if (made_in != fork_generation())
        throw Error(
            Error::Kind::after_fork,
            "this process is a fork's child and has no claim, its parent has; connect again in the child");
}

}  // namespace knurl::detail
