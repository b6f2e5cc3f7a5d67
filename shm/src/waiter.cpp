#include <array>
#include <bit>
#include <cerrno>

#include <linux/futex.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <knurl/shm/deadline.hpp>
#include <knurl/shm/waiter.hpp>

#include "system_error.hpp"

namespace knurl::shm {

namespace {

constexpr std::size_t few = 8;  // clients

/// The futex of a flag: its lower half.
std::uint32_t* futex_of(WaiterFlag& flag) noexcept {
    static_assert(std::endian::native == std::endian::little);
    return reinterpret_cast<std::uint32_t*>(&flag.waiting);
}

long futex(std::uint32_t* word, int operation, std::uint32_t value,
           const timespec* until = nullptr) noexcept {
    return ::syscall(SYS_futex, word, operation, value, until, nullptr, FUTEX_BITSET_MATCH_ANY);
}

/// For words of this process alone.
long private_futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value) noexcept {
    static_assert(sizeof word == sizeof(std::uint32_t) && std::atomic<std::uint32_t>::is_always_lock_free);
    return futex(reinterpret_cast<std::uint32_t*>(&word), operation | FUTEX_PRIVATE_FLAG, value);
}

/// Until the deadline, while the flag says that somebody sleeps on it. Returns 0 or an errno.
int sleep_on(WaiterFlag& flag, Deadline deadline) noexcept {
    const auto since_zero = std::chrono::nanoseconds(deadline.time_since_epoch());
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since_zero);
    // Of CLOCK_MONOTONIC, which is the clock of a Deadline.
    const timespec until{.tv_sec = static_cast<time_t>(seconds.count()),
                         .tv_nsec = (since_zero - seconds).count()};
    const bool for_ever = deadline == Deadline::max();
    constexpr auto expected = static_cast<std::uint32_t>(Waits::on_flag);
    return futex(futex_of(flag), FUTEX_WAIT_BITSET, expected, for_ever ? nullptr : &until) == 0 ? 0 : errno;
}

bool wake_one(const WakeTarget& wake_target) noexcept {
    const std::uint64_t waited = lower_flag<>(wake_target.flag->waiting);
    if (waited == 0) return false;
    if (waited == static_cast<std::uint64_t>(Waits::on_socket)) {
        // EAGAIN: unread wake-ups fill the buffer, so the client's end is readable already.
        const std::byte one{};
        [[maybe_unused]] const ssize_t sent =
            ::send(wake_target.wake_fd, &one, sizeof one, MSG_DONTWAIT | MSG_NOSIGNAL);
    } else {
        // One sleeper: a client may have put any number there, and all would be woken one by one.
        futex(futex_of(*wake_target.flag), FUTEX_WAKE, 1);
    }
    return true;
}

}  // namespace

UniqueFd make_event() {
    UniqueFd fd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
    if (!fd) throw_errno("event descriptor: cannot create", "see the limit of open files (ulimit -n)");
    return fd;
}

WakePair make_wake_pair() {
    std::array<int, 2> ends{};
    // A stream: the kernel lets the owner of a datagram socket attach a filter, which the sender runs.
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) != 0)
        throw_errno("pair of sockets: cannot create", "see the limit of open files (ulimit -n)");
    WakePair pair{.servo = UniqueFd(ends[0]), .client = UniqueFd(ends[1])};
    // Nothing comes back. Else a client could send descriptors, which stay in the socket until it is closed,
    // and closing some takes any time.
    if (::shutdown(pair.servo.get(), SHUT_RD) != 0)
        throw_errno("pair of sockets: cannot make it one-way", "see the limits of this process");
    // The kernel's least: a few unread wake-ups are as good as many, and each takes memory.
    const int least = 1;
    static_cast<void>(::setsockopt(pair.servo.get(), SOL_SOCKET, SO_SNDBUF, &least, sizeof least));
    return pair;
}

bool Waiter::wait(std::chrono::nanoseconds timeout) noexcept {
    if (reader_->fresh()) return true;
    const Deadline deadline = deadline_after(timeout);
    while (announce_wait<>(flag_->waiting, reader_->end_word(), reader_->position())) {
        const int error = sleep_on(*flag_, deadline);
        // EAGAIN: the flag was lowered before this thread slept.
        if (reader_->fresh() || (error != 0 && error != EAGAIN && error != EINTR)) break;
    }
    disarm();
    return reader_->fresh();
}

bool Waiter::rearm() noexcept {
    drain();
    return announce_wait<>(flag_->waiting, reader_->end_word(), reader_->position(), Waits::on_socket);
}

void Waiter::disarm() noexcept {
    HardwareMemory::store(flag_->waiting, 0, std::memory_order::relaxed);
}

void Waiter::drain() noexcept {
    // The servo's end holds fewer. If not all are taken, the next wake-up comes early.
    std::array<std::byte, 64> unread;
    [[maybe_unused]] const ssize_t got = ::recv(wake_fd_, unread.data(), unread.size(), MSG_DONTWAIT);
}

/// No lock: the waker's thread, of higher priority, and the broker each change the state of an entry by one
/// exchange.
///
///   broker:  free ─add─> live ─remove─> free;   busy ─remove─> leaving, and waits until it is free
///   thread:  live ─> busy ─ touches flag and socket ─> live;   leaving ─> free, and tells the broker
struct Waker::Table {
    enum State : std::uint32_t { free, live, busy, leaving };
    struct Entry {
        std::atomic<std::uint32_t> state{free};
        WakeTarget target;
    };
    std::array<Entry, max_entries> entries;
    std::atomic<std::size_t> end{0};  // entries from here on were never used

    /// Ran with the entry held busy. False: it is not there.
    static bool wake(Entry& entry) noexcept {
        std::uint32_t state = live;
        if (!entry.state.compare_exchange_strong(state, busy, std::memory_order::acquire)) return false;
        const bool woken = wake_one(entry.target);
        state = busy;
        if (entry.state.compare_exchange_strong(state, live, std::memory_order::release)) return woken;
        entry.state.store(free, std::memory_order::release);
        entry.state.notify_one();
        return woken;
    }
    /// Null: it is in no entry any more.
    Entry* start_to_remove(const WaiterFlag* flag) noexcept {
        const std::size_t used = end.load(std::memory_order::relaxed);
        for (std::size_t i = 0; i < used; ++i) {
            Entry& entry = entries[i];
            std::uint32_t state = entry.state.load(std::memory_order::acquire);
            if (state == free || entry.target.flag != flag) continue;
            while (state != leaving &&
                   !entry.state.compare_exchange_weak(state, state == busy ? leaving : free,
                                                      std::memory_order::acq_rel)) {
            }
            return state == live ? nullptr : &entry;
        }
        return nullptr;
    }
};

Waker::Waker() : table_(std::make_unique<Table>()) {}
Waker::~Waker() = default;

void Waker::add(const WakeTarget& wake_target) {
    if (far_ != nullptr && !wake_target.trusted) return far_->add(wake_target);
    for (std::size_t i = 0; i < max_entries; ++i) {
        Table::Entry& entry = table_->entries[i];
        if (entry.state.load(std::memory_order::acquire) != Table::free) continue;
        entry.target = wake_target;
        entry.state.store(Table::live, std::memory_order::release);
        if (i >= table_->end.load(std::memory_order::relaxed))
            table_->end.store(i + 1, std::memory_order::release);
        return;
    }
    throw std::runtime_error("waker: " + std::to_string(max_entries) + " waiters; no room for one more");
}

bool Waker::try_remove(const WaiterFlag* flag) noexcept {
    const bool gone = table_->start_to_remove(flag) == nullptr;
    return (far_ == nullptr || far_->try_remove(flag)) && gone;
}

void Waker::remove(const WaiterFlag* flag) noexcept {
    if (far_ != nullptr) far_->remove(flag);
    if (Table::Entry* const entry = table_->start_to_remove(flag))
        entry->state.wait(Table::leaving, std::memory_order::acquire);
}

std::size_t Waker::run_once() noexcept {
    std::size_t woken = 0;
    const std::size_t end = table_->end.load(std::memory_order::acquire);
    for (std::size_t i = 0; i < end; ++i)
        if (Table::wake(table_->entries[i])) ++woken;
    return woken;
}

std::size_t Waker::wake(std::span<const WakeTarget> wake_targets) noexcept {
    const Waiting waiting = who_waits(wake_targets);
    if (waiting.count == 0) return 0;
    if (far_ != nullptr && waiting.count > waiting.trusted) far_->poke();
    const std::size_t here = far_ != nullptr ? waiting.trusted : waiting.count;
    if (here == 0) return waiting.count;
    // A wake-up through the thread costs a sleeper some 9 us, which a single sleeper can avoid. Then the
    // servo pays this time instead, so not when there are many sleepers. If an earlier poke lets the thread
    // act too, only one of the two finds the flag set.
    const bool on_socket = waiting.how == static_cast<std::uint64_t>(Waits::on_socket);
    if (here == 1 && waiting.trusted == 1 && wake_targets.size() <= few && !on_socket)
        wake_one(wake_targets[waiting.last]);
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
        private_futex(pokes_, FUTEX_WAKE, 1);
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
            private_futex(pokes_, FUTEX_WAIT, seen);
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
