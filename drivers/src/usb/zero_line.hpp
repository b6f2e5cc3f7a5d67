#pragma once
// Sends zero effort past a servo that is dead or stopped: the part of a driver that the guardian's copy can
// still use.
//
// libusb's state in a forked copy is that of the moment of the fork, so it is not used. The node's descriptor
// stays valid. The open file behind it holds the interface, not a process, so the guardian may send. It uses
// USBDEVFS_BULK, one call that has its own request block and waits for it:
//   - The zero is queued behind the servo's transfers on that endpoint, so it is the last packet.
//   - USBDEVFS_REAPURB would also return the servo's blocks, and write their data to the addresses of the
//     servo's buffers, in the guardian's memory.
// The kernel accepts the same call for interrupt endpoints. An endpoint that the servo's last packets left
// halted refuses it: then the halt is cleared, and the zero sent once more.
//
// A device that was plugged in again has another node, opened after the fork. It is passed through a socket
// whose two ends both processes hold. The servo empties the socket before it puts a new node in, and the
// guardian takes the last one when needed. A descriptor in a socket outlives its sender.

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include <sys/types.h>

namespace knurl::drivers::usb {

class ZeroLine {
  public:
    /// Throws std::runtime_error. An empty packet: the device accepts no efforts.
    explicit ZeroLine(std::span<const std::uint8_t> zero_packet);
    ~ZeroLine();
    ZeroLine(const ZeroLine&) = delete;
    ZeroLine& operator=(const ZeroLine&) = delete;

    /// Sets the present node and the endpoint for efforts (always the same one). Called by the thread that
    /// opened it; libusb still owns `node`.
    void hold(int node, std::uint8_t endpoint) noexcept;
    /// The node is closed.
    void let_go() noexcept;

    /// How often any process has requested zero; orders from before the last request must not be sent. Pairs
    /// with the release in zero().
    std::uint64_t acts() const noexcept { return shared_->load(std::memory_order_acquire); }

    /// Counts first, so that a servo that continues finds the request; then, in a forked copy, sends. In the
    /// original process the I/O thread is alive and sends. False: the device did not accept it.
    bool zero() noexcept;
    /// This is the copy in a forked process.
    bool forked() const noexcept;

    /// The node to which it sends; for tests.
    int node() const noexcept { return node_; }
    /// In a forked copy: takes a node that was opened since.
    void take_newest() noexcept;

  private:
    static constexpr unsigned patience_ms = 2;  // a packet takes a frame or two
    static constexpr int tries = 2;

    std::uint8_t endpoint_ = 0;
    std::array<std::uint8_t, 64> packet_ = {};
    std::size_t length_;
    pid_t made_by_;
    std::atomic<std::uint64_t>* shared_ = nullptr;  // in a page shared over the fork
    int node_ = -1;
    bool first_ = true;       // the node is the one from before the fork
    int ends_[2] = {-1, -1};  // of the socket: in, out
};

}  // namespace knurl::drivers::usb
