#include <array>
#include <cerrno>
#include <mutex>

#include <linux/futex.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <knurl/shm/deadline.hpp>
#include <knurl/shm/waiter.hpp>

#include "system_error.hpp"

namespace knurl::shm {

namespace {

void signal_event(int event_fd) noexcept {
    const std::uint64_t one = 1;
    // EAGAIN: the counter is full, so the descriptor is readable already.
    [[maybe_unused]] const ssize_t written = ::write(event_fd, &one, sizeof one);
}

constexpr std::size_t few = 8;  // clients

bool wake_one(const WakeTarget& wake_target) noexcept {
    if (!lower_flag<>(wake_target.flag->waiting)) return false;
    signal_event(wake_target.event_fd);
    return true;
}

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value) noexcept {
    static_assert(sizeof word == sizeof(std::uint32_t) && std::atomic<std::uint32_t>::is_always_lock_free);
    return ::syscall(SYS_futex, &word, operation | FUTEX_PRIVATE_FLAG, value, nullptr, nullptr, 0);
}

}  // namespace

UniqueFd make_event() {
    UniqueFd fd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
    if (!fd) throw_errno("event descriptor: cannot create", "see the limit of open files (ulimit -n)");
    return fd;
}

bool Waiter::wait(std::chrono::nanoseconds timeout) noexcept {
    if (reader_->fresh()) return true;
    const Deadline deadline = deadline_after(timeout);
    while (announce_wait<>(flag_->waiting, reader_->end_word(), reader_->position())) {
        pollfd event{.fd = event_, .events = POLLIN, .revents = 0};
        const int ready = poll_until({&event, 1}, deadline);
        if (ready > 0) drain();
        if (reader_->fresh() || ready == 0 || (ready < 0 && errno != EINTR)) break;
    }
    disarm();
    return reader_->fresh();
}

void Waiter::rearm() noexcept {
    drain();
    if (!announce_wait<>(flag_->waiting, reader_->end_word(), reader_->position())) signal_event(event_);
}

void Waiter::disarm() noexcept {
    HardwareMemory::store(flag_->waiting, 0, std::memory_order::relaxed);
}

void Waiter::drain() noexcept {
    std::uint64_t count = 0;
    [[maybe_unused]] const ssize_t got = ::read(event_, &count, sizeof count);
}

struct Waker::Table {
    // Between the waker's thread and the broker; the servo never takes it.
    std::mutex mutex;
    std::array<WakeTarget, max_entries> entries;
    std::size_t count = 0;
};

Waker::Waker() : table_(std::make_unique<Table>()) {}
Waker::~Waker() = default;

void Waker::add(const WakeTarget& wake_target) {
    const std::lock_guard lock(table_->mutex);
    if (table_->count == max_entries)
        throw std::runtime_error("waker: " + std::to_string(max_entries) + " waiters; no room for one more");
    table_->entries[table_->count++] = wake_target;
}

void Waker::remove(const WaiterFlag* flag) noexcept {
    const std::lock_guard lock(table_->mutex);
    for (std::size_t i = 0; i < table_->count; ++i) {
        if (table_->entries[i].flag != flag) continue;
        table_->entries[i] = table_->entries[--table_->count];
        return;
    }
}

std::size_t Waker::run_once() noexcept {
    const std::lock_guard lock(table_->mutex);
    std::size_t woken = 0;
    for (std::size_t i = 0; i < table_->count; ++i)
        if (wake_one(table_->entries[i])) ++woken;
    return woken;
}

std::size_t Waker::wake(std::span<const WakeTarget> wake_targets) noexcept {
    const Waiting waiting = who_waits(wake_targets);
    if (waiting.count == 0) return 0;
    // A wake-up through the thread costs a sleeper some 9 us, which a single sleeper can avoid. Then the
    // servo pays this time instead, so not when there are many sleepers. If an earlier poke lets the thread
    // act too, only one of the two finds the flag set.
    const WakeTarget& last = wake_targets[waiting.last];
    if (waiting.count == 1 && wake_targets.size() <= few && last.event_fd >= 0)
        wake_one(last);
    else
        poke();
    return waiting.count;
}

void Waker::poke() noexcept {
    // Release: pairs with the acquire loads in run. A thread that sees the poke sees the flag that caused it,
    // and stop_.
    pokes_.fetch_add(1, std::memory_order::release);
    fence_after_publish<>();
    // Relaxed: the fence orders it. The waking thread clears it, so one sleep costs one futex call.
    if (sleeping_.load(std::memory_order::relaxed) != 0 && sleeping_.exchange(0) != 0)
        futex(pokes_, FUTEX_WAKE, 1);
}

void Waker::run() noexcept {
    std::uint32_t seen = pokes_.load(std::memory_order::acquire);
    while (!stop_.load(std::memory_order::acquire)) {
        run_once();
        sleeping_.store(1, std::memory_order::relaxed);
        fence_after_publish<>();
        // A poke after this load changes pokes_, which the kernel compares before it sleeps; an earlier poke
        // is seen here.
        if (pokes_.load(std::memory_order::acquire) == seen && !stop_.load(std::memory_order::relaxed))
            futex(pokes_, FUTEX_WAIT, seen);
        sleeping_.store(0, std::memory_order::relaxed);
        seen = pokes_.load(std::memory_order::acquire);
    }
    stop_.store(false, std::memory_order::relaxed);
}

void Waker::stop() noexcept {
    stop_.store(true, std::memory_order::release);
    poke();
}

}  // namespace knurl::shm
