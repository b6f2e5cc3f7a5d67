#pragma once
// Outgoing datagrams are numbered and sealed, incoming ones checked and opened. Without a key (loopback) they
// are only numbered.

#include <optional>
#include <span>

#include "counter_window.hpp"
#include "seal.hpp"
#include "wire.hpp"

namespace knurl::bridge {

/// One direction of one connection.
class OutgoingDatagrams {
  public:
    OutgoingDatagrams() = default;
    OutgoingDatagrams(std::uint64_t session, const std::array<std::byte, key_bytes>* key)
        : session_(session) {
        if (key != nullptr) sealer_.emplace(*key);
    }

    std::size_t overhead() const noexcept { return sizeof(DatagramHeader) + (sealer_ ? tag_bytes : 0); }

    /// `room` holds `bytes` of header and body; session and counter of the header are filled in here. Returns
    /// the length to send; 0: no room for the tag.
    std::size_t close(std::span<std::byte> room, std::size_t bytes) noexcept {
        DatagramHeader header;
        std::memcpy(&header, room.data(), sizeof header);
        header.session = session_;
        header.counter = ++counter_;
        std::memcpy(room.data(), &header, sizeof header);
        return sealer_ ? sealer_->seal(header.counter, room, sizeof header, bytes) : bytes;
    }

  private:
    std::uint64_t session_ = 0;
    std::uint64_t counter_ = 0;
    std::optional<Sealer> sealer_;
};

/// The other direction.
class IncomingDatagrams {
  public:
    enum class Verdict : std::uint8_t { good, foreign, already, too_old };
    struct Opened {
        Verdict verdict = Verdict::foreign;
        DatagramHeader header;
        std::span<const std::byte> body;
    };

    IncomingDatagrams() = default;
    IncomingDatagrams(std::uint64_t session, const std::array<std::byte, key_bytes>* key)
        : session_(session) {
        if (key != nullptr) opener_.emplace(*key);
    }

    /// A foreign datagram must not be used. A duplicate, or a possible one, is the peer's, but serves only
    /// for counting. `windows`: one per stream, 0 included.
    Opened open(std::span<std::byte> datagram, std::span<CounterWindow> windows) noexcept {
        Opened opened;
        const std::size_t tag = opener_ ? tag_bytes : 0;
        if (datagram.size() < sizeof(DatagramHeader) + tag) return opened;
        std::memcpy(&opened.header, datagram.data(), sizeof(DatagramHeader));
        if (opened.header.session != session_ || opened.header.stream >= windows.size()) return opened;
        CounterWindow& window = windows[opened.header.stream];
        const CounterWindow::Seen seen = window.look(opened.header.counter);
        if (opener_ && !opener_->open(opened.header.counter, datagram, sizeof(DatagramHeader))) return opened;
        opened.body =
            datagram.subspan(sizeof(DatagramHeader), datagram.size() - sizeof(DatagramHeader) - tag);
        if (seen == CounterWindow::Seen::never) window.accept(opened.header.counter);
        opened.verdict = seen == CounterWindow::Seen::never     ? Verdict::good
                         : seen == CounterWindow::Seen::already ? Verdict::already
                                                                : Verdict::too_old;
        return opened;
    }

  private:
    std::uint64_t session_ = 0;
    std::optional<Opener> opener_;
};

}  // namespace knurl::bridge
