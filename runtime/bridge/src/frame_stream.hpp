#pragma once
// Whole messages over one non-blocking TCP connection, with TLS or without: {u32 bytes, u16 type, u16
// stream}, then `bytes` of payload, 1 or more, little-endian. Never blocks, never allocates after
// construction except for a failure's text (OpenSSL makes and frees four notes of 40 bytes per TLS record),
// buffers a bounded number of bytes, and is looked after by whoever polls fd().
//
//   while (poll(stream.fd(), POLLIN | (stream.wants_write() ? POLLOUT : 0))) {
//       stream.pump();
//       while (const Frame* frame = stream.next()) ...;
//       if (stream.state() == FrameStream::State::closed) ... stream.reason();
//   }

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <knurl/shm/fd.hpp>

#include "tls.hpp"

namespace knurl::bridge {

struct FrameHeader {
    std::uint32_t bytes = 0;  // of the payload: 1 or more
    std::uint16_t type = 0;
    std::uint16_t stream = 0;
};
static_assert(sizeof(FrameHeader) == 8);

struct Frame {
    std::uint16_t type = 0;
    std::uint16_t stream = 0;
    std::span<const std::byte> payload;  // valid until the next call of next() or pump()
};

class FrameStream {
  public:
    enum class State : std::uint8_t { handshaking, open, closed };
    enum class End : std::uint8_t {
        in_order,     // or not yet; or by close()
        unreachable,  // nobody listens there
        keys,         // who has which key: trying again changes nothing
        foreign,      // what it says is no frame, from its first word: it is no bridge
        broken,
    };

    struct Limits {
        std::size_t payload = 640 * 1024;       // of one frame that comes in or goes out
        std::size_t outgoing = 2 * 640 * 1024;  // bytes that wait for a slow reader
    };

    /// `fd` is connected, or connecting (wait until it is writable); it is made non-blocking and TCP_NODELAY.
    /// `tls` null: plain. It says by itself which side it is; `server` serves the texts of a plain
    /// connection.
    FrameStream(shm::UniqueFd fd, bool server, std::shared_ptr<const TlsContext> tls, Limits limits);
    FrameStream(shm::UniqueFd fd, bool server, std::shared_ptr<const TlsContext> tls = nullptr);
    ~FrameStream();
    FrameStream(const FrameStream&) = delete;
    FrameStream& operator=(const FrameStream&) = delete;

    /// Connects, handshakes, reads what is there (bounded by the buffer), writes what waits.
    State pump() noexcept;
    State state() const noexcept { return state_; }

    /// Queues one frame made of the parts one after another, and writes what the socket takes; while
    /// handshaking it waits. False: no room (nothing is queued; a peer that reads too slowly is the caller's
    /// to close), or closed.
    bool send(std::uint16_t type, std::uint16_t stream,
              std::span<const std::span<const std::byte>> parts) noexcept;
    bool send(std::uint16_t type, std::uint16_t stream, std::span<const std::byte> payload) noexcept;

    /// The next whole frame; null: none. Frames that came before the connection closed are still given.
    const Frame* next() noexcept;

    /// Bytes that wait to be written: POLLOUT is wanted.
    bool wants_write() const noexcept;
    std::size_t queued() const noexcept { return out_end_ - out_begin_; }
    /// Frames above this are refused from now on; at most what Limits said. A server keeps it small until it
    /// knows the peer.
    void limit_payload(std::size_t bytes) noexcept;

    int fd() const noexcept { return fd_.get(); }
    bool encrypted() const noexcept { return tls_.has_value(); }
    /// The name of the peer's key; empty: plain, or a client asks.
    std::string_view peer_identity() const noexcept;
    /// Keys for datagrams; nothing: plain, or not open.
    std::optional<DirectionKeys> export_keys(std::string_view label) const noexcept;
    /// Why it is closed: one line; empty: the peer closed it in order, between two frames.
    const std::string& reason() const noexcept { return reason_; }
    End how_it_ended() const noexcept { return end_; }
    /// Writes what the socket takes at once and closes.
    void close() noexcept;

  private:
    enum class From : std::uint8_t { socket, decrypted };
    void connect_and_handshake() noexcept;
    void read_some(From from) noexcept;
    void write_some() noexcept;
    TlsSession::Moved read(std::span<std::byte> into) noexcept;
    TlsSession::Moved write(std::span<const std::byte> from) noexcept;
    const Frame* take() noexcept;
    bool begins_as_tls() const noexcept;
    void end(End how, std::string_view why) noexcept;  // a text that ends with ": " goes on with error_
    void end_of_tls() noexcept;
    void end_of_socket() noexcept;

    shm::UniqueFd fd_;
    bool server_;
    bool connected_ = false;
    State state_ = State::handshaking;
    Limits limits_;
    std::size_t max_payload_;
    std::optional<TlsSession> tls_;
    std::unique_ptr<std::byte[]> in_, out_;
    std::size_t in_capacity_, in_begin_ = 0, in_end_ = 0;
    std::size_t out_capacity_, out_begin_ = 0, out_end_ = 0;
    bool first_frame_ = true;  // none was whole so far
    int error_ = 0;            // errno of a plain connection's end
    Frame frame_;
    End end_ = End::in_order;
    std::string reason_;
};

}  // namespace knurl::bridge
