#pragma once
// Owns an opened device, libusb's context and the thread on which all of libusb runs. The cycle touches
// neither: it takes the newest reading and leaves the newest orders.
//
//   cycle:  read <── Newest<Reading> ──┐                 ┌── transfer in flight <── device
//           write ── Newest<Orders> ───┴── I/O thread ───┴── transfer in flight ──> device
//                └─ eventfd ("there is something to send")
//
// Each device has its own thread. Starting a device blocks for seconds, also after a replug, and must not
// delay another device's transfers. A device that floods its thread disturbs no other.
//
// Every write() is one packet, sent at once; incoming packets are requested all the time. Without a write for
// `silence` the thread sends zero itself (the cycle has stopped, the process lives). Nothing is sent or
// requested before the first take(): the guardian is forked before that, from a process whose threads hold no
// lock.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <libusb.h>
#include <poll.h>
#include <pthread.h>

#include <knurl/drivers/newest.hpp>

#include "usb/protocol.hpp"
#include "usb/zero_line.hpp"

namespace knurl::drivers::usb {

struct IoCounts {
    std::uint64_t readings = 0;  // from the device
    std::uint64_t sent = 0;      // packets to it
    std::uint64_t missed = 0;    // orders that found every packet in flight: replaced by later ones, or sent
                                 // later
    std::uint64_t garbage = 0;
    std::uint64_t errors = 0;  // transfers that failed
    std::uint64_t openings = 0;
};

class IoThread {
  public:
    static constexpr Nanoseconds silence = 10'000'000;  // ns without a write until zero is sent; then
                                                        // repeated
    // The device counts as deaf when a packet has waited this long and this many orders have followed it.
    // Both are needed: a machine may have stood still, and a fast loop gives many orders in one USB frame.
    static constexpr Nanoseconds deaf_after = 20'000'000;  // ns
    static constexpr int deaf_orders = 20;
    static constexpr int transfers_in = 3;   // requested at any time
    static constexpr int transfers_out = 2;  // in flight at most
    static constexpr int most_errors = 64;   // in a row, of one transfer: then the device is closed and
                                             // opened again
    static constexpr int search_ms = 50;     // between searches for a missing device
    // SCHED_FIFO while the thread searches and opens the device, which takes milliseconds at a time: below
    // the servo and the threads of other devices, above ordinary threads. The guardian learns of a dead servo
    // only when its last thread has ended.
    static constexpr int search_priority = 1;
    static constexpr std::size_t stack_bytes = 512 << 10;

    /// Finds, opens and starts the device; throws std::runtime_error with the remedy. `priority`: SCHED_FIFO
    /// priority of the thread, 0: ordinary; without the right to it the thread stays ordinary. With wanted.wait an
    /// absent device is no error: the thread looks for it once the cycle has begun, as for one that was unplugged.
    IoThread(Wanted wanted, std::unique_ptr<Protocol> protocol, int priority);
    /// Sends zero and returns the device to the kernel.
    ~IoThread();
    IoThread(const IoThread&) = delete;
    IoThread& operator=(const IoThread&) = delete;

    // For the cycle: no wait, no allocation, no libusb. One thread at a time.

    /// ok: `reading` is newer than the last one. bad: garbage arrived, or the device accepts no packet, so
    /// its motors hold the last command. unplugged: also once if the device was gone and came back between
    /// two calls.
    ReadStatus take(Reading& reading) noexcept;
    /// Efforts and flags; false: the device is gone. Orders become zero if the device was plugged in again or
    /// made safe since the last take.
    bool send(Orders orders) noexcept;
    /// Also works in a forked copy.
    void make_safe() noexcept;

    /// False: the device is gone. send() returns the same.
    bool there() const noexcept {
        return (seen_session_ & 1U) != 0 && session_number_.load(std::memory_order_acquire) == seen_session_;
    }

    /// From the opening in the constructor, with the first reading. No session: the device was absent.
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
        Nanoseconds since = 0;  // time of submission
        int errors_in_row = 0;
        std::array<std::uint8_t, packet_bytes> bytes = {};
    };

    bool is_absent() const;
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

    // For the thread only.
    Reading reading_;
    Orders orders_;
    Nanoseconds last_order_ = 0;
    std::uint64_t answered_acts_ = 0;  // ZeroLine::acts() for which a zero was sent
    std::uint64_t number_ = 0;         // of this opening; even: closed
    bool owed_ = false;                // orders must be sent when a packet is free
    int unheard_ = 0;                  // orders since the device last accepted a packet
    bool gone_ = false;
    bool halted_ = false;

    // Between cycle and thread.
    Newest<Reading> readings_;
    Newest<Orders> newest_orders_;
    // odd: the device is there. Release after its first reading.
    std::atomic<std::uint64_t> session_number_ = 0;
    std::atomic<bool> awake_ = false;  // the cycle has begun
    std::atomic<bool> deaf_ = false;   // the device accepts no packets
    std::atomic<std::uint64_t> readings_count_ = 0, sent_ = 0, missed_ = 0, garbage_ = 0, errors_ = 0;

    // For the cycle only.
    std::uint64_t seen_session_ = 0, seen_acts_ = 0, seen_garbage_ = 0;
    bool begun_ = false;
};

}  // namespace knurl::drivers::usb
