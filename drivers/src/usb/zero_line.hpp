#pragma once
// Zero effort past a servo that is dead or stopped: what the guardian's copy of a driver can still use.
//
// libusb's state in a forked copy is that of the moment of the fork, so nothing of it is touched; what a fork
// leaves valid is the node's descriptor. The interface is claimed by the open file behind it, not by a
// process, so the guardian may send. It sends with USBDEVFS_BULK, one call that has a request block of its
// own and waits for it:
//   - queued behind what the servo had in flight on that endpoint, so the zero is the last word;
//   - USBDEVFS_REAPURB would hand over the servo's blocks as well, and write their data to the addresses of
//     the servo's buffers, in the guardian's memory.
// The kernel takes the same call for interrupt endpoints. An endpoint that the last packets of the servo left
// halted refuses it: the halt is cleared, and the zero sent once more.
//
// A device that was plugged in again has another node, opened after the fork. It is handed over through a
// socket whose both ends both processes have: the servo empties it before it puts a new one in, the guardian
// takes the last one when it needs it. A descriptor that lies in a socket outlives its sender.

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include <sys/types.h>

namespace knurl::drivers::usb {

class ZeroLine {
  public:
    /// Throws std::runtime_error. An empty packet: the device takes no efforts.
    explicit ZeroLine(std::span<const std::uint8_t> zero_packet);
    ~ZeroLine();
    ZeroLine(const ZeroLine&) = delete;
    ZeroLine& operator=(const ZeroLine&) = delete;

    /// This is the node now, and where it takes efforts (at the same endpoint every time). By the thread that
    /// opened it; `node` stays libusb's.
    void hold(int node, std::uint8_t endpoint) noexcept;
    /// It is closed.
    void let_go() noexcept;

    /// How often any process has asked for zero; what was ordered before the last time must not be sent.
    /// Pairs with the release in zero().
    std::uint64_t acts() const noexcept { return shared_->load(std::memory_order_acquire); }

    /// First counts, so that a servo that wakes up finds it, then, in a forked copy, sends. In the process
    /// that made this the I/O thread is alive and sends itself. False if the device did not take it.
    bool zero() noexcept;
    /// This is a copy in a forked process.
    bool forked() const noexcept;

    /// Where it sends to; for tests.
    int node() const noexcept { return node_; }
    /// A forked copy looks for a node that was opened since.
    void take_newest() noexcept;

  private:
    static constexpr unsigned patience_ms = 2;  // a packet takes a frame or two
    static constexpr int tries = 2;

    std::uint8_t endpoint_ = 0;
    std::array<std::uint8_t, 64> packet_ = {};
    std::size_t length_;
    pid_t made_by_;
    std::atomic<std::uint64_t>* shared_ = nullptr;  // in a page that a fork shares
    int node_ = -1;
    bool first_ = true;       // that one a fork inherits
    int ends_[2] = {-1, -1};  // of the socket: in, out
};

}  // namespace knurl::drivers::usb
