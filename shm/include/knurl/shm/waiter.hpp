#pragma once

/// @file
/// Sleeping until the next report. The reports are mapped read-only, so a client cannot count itself in
/// there: it sets a flag in its own segment. The servo reads the flags of its clients after it has published.
/// One that sleeps alone, among few, it wakes itself, if that one may be trusted with it; else it pokes a
/// thread of lower priority on its own core, which wakes them while the servo sleeps. Either is one system
/// call, whatever the number of clients.
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

/// The waiting side: raises the flag, then looks again. True: `counter` is still at `seen`, sleeping is safe.
template <class Memory = HardwareMemory, class Orders = WaiterOrders>
bool announce_wait(typename Memory::Word& flag, const typename Memory::Word& counter,
                   std::uint64_t seen) noexcept {
    Memory::store(flag, 1, std::memory_order::relaxed);
    Memory::fence(Orders::waiter_fence);
    return Memory::load(counter, std::memory_order::acquire) == seen;
}

/// The publishing side, after its store and before it reads flags.
template <class Memory = HardwareMemory, class Orders = WaiterOrders>
void fence_after_publish() noexcept {
    Memory::fence(Orders::publisher_fence);
}

/// Lowers the flag; true: it was up. Lowered before the client is signalled: one that waits again meanwhile
/// raises it again, and that is not overwritten.
template <class Memory = HardwareMemory>
bool lower_flag(typename Memory::Word& flag) noexcept {
    return Memory::load(flag, std::memory_order::relaxed) != 0 &&
           Memory::exchange(flag, 0, std::memory_order::acq_rel) != 0;
}

/// One client's flag, in the client's segment, a line for itself. Zero-initialise it with the segment.
struct alignas(line_bytes) WaiterFlag {
    /// Not 0: the client waits. The client sets it; the thread that wakes it clears it.
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

/// One who may sleep: its flag, and the descriptor that it sleeps on. Neither is owned. A client shares its
/// descriptor, and could make writing to it block: whoever must never block has -1 there, unless the client
/// could stop it anyway.
struct WakeTarget {
    /// Its flag.
    WaiterFlag* flag = nullptr;
    /// The descriptor that it sleeps on, or -1.
    int event_fd = -1;
};

/// Who waits.
struct Waiting {
    /// How many.
    std::size_t count = 0;
    /// Index of the last of these.
    std::size_t last = 0;
};
/// The servo calls it after publishing. The fence is inside. Costs a fence and a load per flag.
inline Waiting who_waits(std::span<const WakeTarget> wake_targets) noexcept {
    fence_after_publish<>();
    Waiting found;
    for (std::size_t i = 0; i < wake_targets.size(); ++i) {
        if (HardwareMemory::load(wake_targets[i].flag->waiting, std::memory_order::relaxed) == 0) continue;
        ++found.count;
        found.last = i;
    }
    return found;
}

/// A non-blocking, close-on-exec eventfd for a client to sleep on. Throws std::runtime_error.
UniqueFd make_event();

/// The client's side of waiting. It owns none of the things that it is given; the reader's position says what
/// is new.
class Waiter {
  public:
    /// Waits with this flag, on this descriptor, for this reader.
    Waiter(WaiterFlag* flag, int event_fd, const BroadcastReader& reader)
        : flag_(flag), event_(event_fd), reader_(&reader) {}

    /// Sleeps until the reader has something new, at most `timeout` (nanoseconds::max(): for ever). True: it
    /// has, or its ring was restarted. A time-out of a few cycles, repeated, also sees a servo that died.
    /// Signals do not end it.
    bool wait(std::chrono::nanoseconds timeout) noexcept;

    /// For an event loop: fd() becomes readable when a report arrives after rearm(). When it is readable,
    /// read all reports, then rearm() again; if a report came in between, the descriptor is readable at once.
    /// A wake-up may be early, it is never lost.
    int fd() const noexcept { return event_; }
    /// Raises the flag again; see fd().
    void rearm() noexcept;

    /// No longer interested: lowers the flag.
    void disarm() noexcept;

  private:
    void drain() noexcept;

    WaiterFlag* flag_;
    int event_;
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

    /// Adds a client. remove(flag) before unmapping the flag or closing the descriptor. Throws
    /// std::runtime_error when the table is full. Safe while the thread runs, never called by the servo's
    /// thread.
    void add(const WakeTarget& wake_target);
    /// On return nobody touches the flag or the descriptor any more. Unknown flags are ignored.
    void remove(const WaiterFlag* flag) noexcept;

    /// From the servo's thread, after publishing: wakes whoever of these waits, with one system call at most,
    /// no lock, no allocation. Those without a descriptor are left to the thread. How many did wait.
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

    // poke: ++pokes_      ─sb─> fence ─sb─> sleeping_ not set: no futex call
    // run:  sleeping_ = 1 ─sb─> fence ─sb─> pokes_ as seen:    futex wait
    // The same Dekker pair; besides, the kernel compares pokes_ once more before it sleeps.
    alignas(line_bytes) std::atomic<std::uint32_t> pokes_ = 0;
    std::atomic<std::uint32_t> sleeping_ = 0;
    std::atomic<bool> stop_ = false;
};

}  // namespace knurl::shm
