#pragma once

/// @file
/// Sleeping until the next report. The reports are mapped read-only, so a client cannot count itself in
/// there: it sets a flag in its own segment. The servo reads the flags of its clients after it has published.
/// One that sleeps alone, among few, it wakes itself, if that one may be trusted with it; else it pokes a
/// thread of lower priority on its own core, which wakes them while the servo sleeps. Either is one system
/// call, whatever the number of clients.
///
/// A client sleeps in one of two ways, which its flag names: on the flag itself (a futex), or in poll() on
/// its end of a pair of sockets, for event loops. No wake-up can block, whatever the client does: a futex call
/// for memory that is present waits for nothing, and the flags of the servo's end of the pair are its own, so
/// a full buffer is an answer. (An eventfd has one set of flags for both sides: a client that makes it
/// blocking and fills it holds up whoever writes.) Only the thread writes to sockets, since that allocates
/// memory in the kernel.
///
///     client: flag = 1   ─sb─> fence(seq_cst) ─sb─> read end: nothing new ⇒ sleep
///     servo:  end = n+1  ─sb─> fence(seq_cst) ─sb─> read flag: not set    ⇒ wake nobody
///
/// Dekker's protocol: the fences are in one total order, and the later side sees what the earlier one stored.
/// So at least one of the two notices, and no wake-up is lost. Without either fence both may read the old
/// value.

#include <atomic>
#include <chrono>
#include <memory>
#include <span>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/shm/words.hpp>

namespace knurl::shm {

/// Memory orders of waiting. The models in tests/shm weaken them one by one.
struct WaiterOrders {
    /// Pairs with publisher_fence.
    static constexpr auto waiter_fence = std::memory_order::seq_cst;
    /// Pairs with waiter_fence.
    static constexpr auto publisher_fence = std::memory_order::seq_cst;
};

/// How a client waits: what WaiterFlag::waiting is. Any other value but 0 counts as on_flag.
enum class Waits : std::uint64_t {
    /// It does not.
    no = 0,
    /// In a futex call on the flag.
    on_flag = 1,
    /// In poll() on its socket.
    on_socket = 2,
};

/// The waiting side: raises the flag, then looks again. True: `counter` is still at `seen`, sleeping is safe.
template <class Memory = HardwareMemory, class Orders = WaiterOrders>
bool announce_wait(typename Memory::Word& flag, const typename Memory::Word& counter, std::uint64_t seen,
                   Waits how = Waits::on_flag) noexcept {
    Memory::store(flag, static_cast<std::uint64_t>(how), std::memory_order::relaxed);
    Memory::fence(Orders::waiter_fence);
    return Memory::load(counter, std::memory_order::acquire) == seen;
}

/// The publishing side, after its store and before it reads flags.
template <class Memory = HardwareMemory, class Orders = WaiterOrders>
void fence_after_publish() noexcept {
    Memory::fence(Orders::publisher_fence);
}

/// Lowers the flag; returns what it was, 0: it was down. Lowered before the client is woken: one that waits
/// again meanwhile raises it again, and that is not overwritten.
template <class Memory = HardwareMemory>
std::uint64_t lower_flag(typename Memory::Word& flag) noexcept {
    if (Memory::load(flag, std::memory_order::relaxed) == 0) return 0;
    return Memory::exchange(flag, 0, std::memory_order::acq_rel);
}

/// One client's flag, in the client's segment, a line for itself. Zero-initialise it with the segment.
struct alignas(line_bytes) WaiterFlag {
    /// A value of Waits; the client's word alone, so it may be any. The client sets it; the thread that wakes
    /// it clears it. Its lower half is the futex.
    std::uint64_t waiting = 0;
    /// Reports that its owner has missed (BroadcastReader::missed), for people who look on. It lies here
    /// since whoever publishes has this line at hand anyway. The owner's word alone says so: nothing may
    /// depend on it.
    std::uint64_t missed = 0;
    /// How often its owner has put something into its other rings (SentCount). The servo leaves alone the
    /// rings of a client at rest until this changes: one line for each of them, and one that it reads anyway.
    std::uint64_t sent = 0;
};
static_assert(sizeof(WaiterFlag) == line_bytes);

/// Memory orders of WaiterFlag::sent.
struct SentOrders {
    /// Pairs with see.
    static constexpr auto publish = std::memory_order::release;
    /// Pairs with publish.
    static constexpr auto see = std::memory_order::acquire;
};

/// The client's side of WaiterFlag::sent: called after each push and publish.
///
///   client: push ─sb─> sent = n+1 (rel) ══sw══> sent read (acq) ─sb─> the rings are looked at
///
/// Who reads n+1 finds what was pushed before it; who reads n before it looks reads n+1 the next time.
template <class Memory = HardwareMemory, class Orders = SentOrders>
class BasicSentCount {
  public:
    /// Goes on with this count.
    explicit BasicSentCount(typename Memory::Word* sent)
        : sent_(sent), count_(Memory::load(*sent, std::memory_order::relaxed)) {}
    /// Something was pushed or published.
    void add() noexcept { Memory::store(*sent_, ++count_, Orders::publish); }

  private:
    typename Memory::Word* sent_;
    std::uint64_t count_;  // private; *sent_ is only its publication
};

/// The servo's side of WaiterFlag::sent, read before it looks at the rings.
template <class Memory = HardwareMemory, class Orders = SentOrders>
std::uint64_t sent_so_far(const typename Memory::Word& sent) noexcept {
    return Memory::load(sent, Orders::see);
}

/// The count of a client's WaiterFlag.
class SentCount : public BasicSentCount<> {
  public:
    /// Goes on with this flag's count.
    explicit SentCount(WaiterFlag* flag) : BasicSentCount(&flag->sent) {}
};

/// One who may sleep: its flag, and the socket that it may sleep on. Neither is owned.
struct WakeTarget {
    /// Its flag.
    WaiterFlag* flag = nullptr;
    /// The servo's end of its pair of sockets, or -1.
    int wake_fd = -1;
    /// The servo's thread may wake it. Waking passes over the other waiters that the kernel keeps in the same
    /// list. A client can make such a list long, so this is for clients that could stop the servo anyway.
    bool trusted = false;
};

/// Who waits.
struct Waiting {
    /// How many.
    std::size_t count = 0;
    /// How many of these are trusted.
    std::size_t trusted = 0;
    /// Index of the last trusted one.
    std::size_t last = 0;
    /// Its flag.
    std::uint64_t how = 0;
};
/// The servo calls it after publishing. The fence is inside. Costs a fence and a load per flag while nobody
/// waits.
inline Waiting who_waits(std::span<const WakeTarget> wake_targets) noexcept {
    fence_after_publish<>();
    const auto how = [](const WakeTarget& each) {
        return HardwareMemory::load(each.flag->waiting, std::memory_order::relaxed);
    };
    std::uint64_t anyone = 0;
    for (const WakeTarget& each : wake_targets) anyone |= how(each);
    Waiting found;
    if (anyone == 0) return found;
    // A flag that is raised between the two looks counts as well; no flag that was raised before is missed.
    for (std::size_t i = 0; i < wake_targets.size(); ++i) {
        const std::uint64_t waits = how(wake_targets[i]);
        if (waits == 0) continue;
        ++found.count;
        if (!wake_targets[i].trusted) continue;
        ++found.trusted;
        found.last = i;
        found.how = waits;
    }
    return found;
}

/// What a client sleeps on in an event loop: two ends of one connection. Neither side can change how the
/// other's end behaves.
struct WakePair {
    /// Stays with the servo: WakeTarget::wake_fd.
    UniqueFd servo;
    /// Goes to the client: readable when it has been woken.
    UniqueFd client;
};
/// Makes a pair; both ends are non-blocking and close-on-exec. Throws std::runtime_error.
WakePair make_wake_pair();

/// A non-blocking, close-on-exec eventfd, for threads of one process. It is no good between processes that do
/// not trust each other: its flags are the same for all who have it. Throws std::runtime_error.
UniqueFd make_event();

/// The client's side of waiting. It owns none of the things that it is given; the reader's position says what
/// is new.
class Waiter {
  public:
    /// Waits with this flag for this reader. `wake_fd`: the client's end of its pair of sockets; -1: it only
    /// calls wait().
    Waiter(WaiterFlag* flag, int wake_fd, const BroadcastReader& reader)
        : flag_(flag), wake_fd_(wake_fd), reader_(&reader) {}

    /// Sleeps until the reader has something new, at most `timeout` (nanoseconds::max(): for ever). True: it
    /// has, or its ring was restarted. A time-out of a few cycles, repeated, also sees a servo that died.
    /// Signals do not end it.
    bool wait(std::chrono::nanoseconds timeout) noexcept;

    /// For an event loop: fd() becomes readable when a report arrives after rearm(). When it is readable,
    /// read all reports, then rearm() again. A wake-up may be early, it is never lost. A wait() in between
    /// takes the place of rearm().
    int fd() const noexcept { return wake_fd_; }
    /// Raises the flag again; see fd(). False: a report is there already, and the descriptor does not say so;
    /// read it, then call this again.
    [[nodiscard]] bool rearm() noexcept;

    /// No longer interested: lowers the flag.
    void disarm() noexcept;

  private:
    void drain() noexcept;

    WaiterFlag* flag_;
    int wake_fd_;
    const BroadcastReader* reader_;
};

/// The servo process's side: the table of those who may sleep, and the thread that wakes them. One table per
/// device, or one for all devices of a CPU (then a waiter of another device is woken early now and then,
/// which is harmless).
class Waker {
  public:
    /// Most entries: clients times devices.
    static constexpr std::size_t max_entries = 128 * 8;

    /// An empty table.
    Waker();
    ~Waker();
    Waker(const Waker&) = delete;
    Waker& operator=(const Waker&) = delete;

    /// Those who are not trusted are woken by the thread of `far`, which should run on another CPU: waking one
    /// of them may take long (WakeTarget::trusted), with preemption off. Called before the first add().
    void leave_untrusted_to(Waker& far) noexcept { far_ = &far; }

    /// Adds a client. remove(flag) before unmapping the flag or closing the descriptor. Throws
    /// std::runtime_error when the table is full. Safe while the thread runs; add and remove are called by one
    /// thread, which is not the servo's.
    void add(const WakeTarget& wake_target);
    /// True: nobody touches the flag or the descriptor any more. False: the thread is waking this client at
    /// this moment, and will not do so again; ask again later. Does not wait. True for an unknown flag.
    [[nodiscard]] bool try_remove(const WaiterFlag* flag) noexcept;
    /// The same, but waits for the end of that one wake-up.
    void remove(const WaiterFlag* flag) noexcept;

    /// From the servo's thread, after publishing: wakes whoever of these waits, with one system call at most
    /// for those who are trusted and one for the others, no lock, no allocation. Left to the thread are several, those who are not trusted, and those who wait
    /// on a socket. How many did wait.
    std::size_t wake(std::span<const WakeTarget> wake_targets) noexcept;
    /// The thread will look through its table: a futex wake at most.
    void poke() noexcept;

    /// The thread's body: sleeps until poked, wakes, and again, until stop(). The caller makes the thread,
    /// with the priority, CPU and stack that it wants.
    void run() noexcept;
    /// run() returns soon, now or when it is called next. From any thread.
    void stop() noexcept;

    /// One round: wakes everyone whose flag is set, and lowers it. Returns how many.
    std::size_t run_once() noexcept;

  private:
    struct Table;
    std::unique_ptr<Table> table_;
    Waker* far_ = nullptr;

    // poke: ++pokes_      ─sb─> fence ─sb─> sleeping_ not set: no futex call
    // run:  sleeping_ = 1 ─sb─> fence ─sb─> pokes_ as seen:    futex wait
    // The same Dekker pair; besides, the kernel compares pokes_ once more before it sleeps.
    alignas(line_bytes) std::atomic<std::uint32_t> pokes_ = 0;
    std::atomic<std::uint32_t> sleeping_ = 0;
    std::atomic<bool> stop_ = false;
};

}  // namespace knurl::shm
