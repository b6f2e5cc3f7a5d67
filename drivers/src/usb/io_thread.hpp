#pragma once
// Owns an opened device, libusb's context and the thread on which all of libusb runs. The cycle meets
// neither: it takes the newest reading and leaves the newest orders.
//
//   cycle:  read <── Newest<Reading> ──┐                 ┌── transfer in flight <── device
//           write ── Newest<Orders> ───┴── I/O thread ───┴── transfer in flight ──> device
//                └─ eventfd ("there is something to send")
//
// One thread per device, not one for all: starting a device takes seconds and waits, when it is plugged in
// again as well, and the other hand's transfers must not; a device that floods its thread floods nobody
// else's.
//
// Every write() is one packet, sent at once; packets in are asked for all the time. Without a write for
// `silence` the thread sends zero itself (the cycle has stopped, the process lives). Nothing is sent or asked
// for before the first take(): a guardian is forked until then, from a process whose threads hold no lock.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <libusb.h>
#include <poll.h>
#include <pthread.h>

#include "usb/newest.hpp"
#include "usb/protocol.hpp"
#include "usb/zero_line.hpp"

namespace knurl::drivers::usb {

struct IoCounts {
    std::uint64_t readings = 0;  // from the device
    std::uint64_t sent = 0;      // packets to it
    std::uint64_t missed = 0;    // orders that found every packet in flight, and were replaced or sent later
    std::uint64_t garbage = 0;
    std::uint64_t errors = 0;  // transfers that failed
    std::uint64_t openings = 0;
};

class IoThread {
  public:
    static constexpr Nanoseconds silence = 10'000'000;  // ns without a write until zero is sent, and again
    // A packet has waited so long, and so many orders after it, when the device counts as deaf. Both: a
    // machine that stood still is no fault of the device's, a fast loop has many orders in a frame of USB.
    static constexpr Nanoseconds deaf_after = 20'000'000;  // ns
    static constexpr int deaf_orders = 20;
    static constexpr int transfers_in = 3;   // asked for at any time
    static constexpr int transfers_out = 2;  // in flight at most
    static constexpr int most_errors = 64;   // in a row of one transfer: it is closed and opened again
    static constexpr int search_ms = 50;     // between looks for a device that is gone
    // SCHED_FIFO while it looks for it and opens it, which takes milliseconds at a time: below the servo and
    // the threads of other hands, above ordinary ones, since the guardian hears of a dead servo when the last
    // of its threads has ended.
    static constexpr int search_priority = 1;
    static constexpr std::size_t stack_bytes = 512 << 10;

    /// Finds, opens and starts the device; throws std::runtime_error with the way out. `priority`: SCHED_FIFO
    /// of the thread, 0: ordinary; one that it may not have is left alone.
    IoThread(Wanted wanted, std::unique_ptr<Protocol> protocol, int priority);
    /// Sends zero, gives the device back to the kernel.
    ~IoThread();
    IoThread(const IoThread&) = delete;
    IoThread& operator=(const IoThread&) = delete;

    // For the cycle: no wait, no allocation, no libusb. One thread at a time.

    /// ok: `reading` is newer than the one before. bad: garbage came instead, or the device takes no packet,
    /// whatever it says: its motors hold what they were told last. unplugged: also once after a device that
    /// was gone and is back between two calls.
    ReadStatus take(Reading& reading) noexcept;
    /// Efforts and flags; false: the device is gone. Orders for a device that has been plugged in again since
    /// the last take, or been made safe since, are zero.
    bool send(Orders orders) noexcept;
    /// In a forked copy as well.
    void make_safe() noexcept;

    /// False: the device is gone. What send() says as well.
    bool there() const noexcept {
        return (seen_session_ & 1U) != 0 && session_number_.load(std::memory_order_acquire) == seen_session_;
    }

    /// As it was first opened, and what it said first.
    const UsbDevice& info() const { return info_; }
    const Reading& first() const { return first_; }
    IoCounts counts() const noexcept;

  private:
    struct Free {
        void operator()(libusb_transfer* block) const noexcept { libusb_free_transfer(block); }
    };
    struct Transfer {
        IoThread* owner = nullptr;
        std::unique_ptr<libusb_transfer, Free> block;
        bool active = false;
        Nanoseconds since = 0;  // it was submitted
        int errors_in_row = 0;
        std::array<std::uint8_t, packet_bytes> bytes = {};
    };

    void open();
    void close() noexcept;
    void live() noexcept;
    void run_at(int priority) const noexcept;
    void converse() noexcept;
    void attend() noexcept;
    void transmit(bool fresh) noexcept;
    void submit(Transfer& transfer, std::uint8_t endpoint, std::size_t length,
                libusb_transfer_cb_fn done) noexcept;
    void ask(Transfer& transfer) noexcept;
    void received(Transfer& transfer) noexcept;
    void ended(Transfer& transfer) noexcept;
    void clear_halts() noexcept;
    void wait(int timeout_ms) noexcept;
    bool any_active() const noexcept;
    bool deaf(Nanoseconds now) const noexcept;
    static void on_in(libusb_transfer* block);
    static void on_out(libusb_transfer* block);

    Wanted wanted_;
    std::unique_ptr<Protocol> protocol_;
    const int priority_;
    UsbDevice info_;
    Reading first_;
    class Poke {  // an eventfd
      public:
        Poke();
        ~Poke();
        Poke(const Poke&) = delete;
        Poke& operator=(const Poke&) = delete;
        void set() const noexcept;
        void take() const noexcept;
        int fd() const { return fd_; }

      private:
        int fd_;
    } poke_;
    std::atomic<bool> stop_ = false;
    Context context_;
    std::optional<ZeroLine> zero_line_;
    std::optional<Session> session_;
    std::vector<pollfd> waits_;
    std::vector<std::unique_ptr<Transfer>> in_, out_;
    pthread_t thread_ = {};

    // The thread's.
    Reading reading_;
    Orders orders_;
    Nanoseconds last_order_ = 0;
    std::uint64_t answered_acts_ = 0;  // ZeroLine::acts() that a zero has followed
    std::uint64_t number_ = 0;         // of this opening; even: it is closed
    bool owed_ = false;                // orders are still to go out, when a packet is free
    int unheard_ = 0;                  // orders since the device took a packet
    bool gone_ = false;
    bool halted_ = false;

    // Between the two.
    Newest<Reading> readings_;
    Newest<Orders> newest_orders_;
    // odd: there is a device. Release after its first reading.
    std::atomic<std::uint64_t> session_number_ = 0;
    std::atomic<bool> awake_ = false;  // the cycle has begun
    std::atomic<bool> deaf_ = false;   // the device takes no packet
    std::atomic<std::uint64_t> readings_count_ = 0, sent_ = 0, missed_ = 0, garbage_ = 0, errors_ = 0;

    // The cycle's.
    std::uint64_t seen_session_ = 0, seen_acts_ = 0, seen_garbage_ = 0;
    bool begun_ = false;
};

}  // namespace knurl::drivers::usb
