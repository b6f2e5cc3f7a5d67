#pragma once
// Whole messages over one non-blocking TCP connection, with TLS or without: {u32 bytes, u16 type, u16
// stream}, then `bytes` of payload, 1 or more, little-endian. Never blocks. Never allocates after
// construction, except for the text of a failure (OpenSSL makes and frees four notes of 40 bytes per TLS
// record). Buffers a bounded number of bytes. The owner polls fd():
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
        in_order,     // or still open; or closed by close()
        unreachable,  // no program listens there
        keys,         // the keys do not match: trying again changes nothing
        foreign,      // its first bytes are no frame: it is no bridge
        broken,
    };

    struct Limits {
        std::size_t payload = 640 * 1024;       // of one frame, incoming or outgoing
        std::size_t outgoing = 2 * 640 * 1024;  // bytes waiting for a slow reader
    };

    /// `fd` is connected, or connecting (wait until it is writable); it is made non-blocking and TCP_NODELAY.
    /// A null `tls` means a plain connection; a TLS context knows its own side. `server` chooses the texts
    /// for a plain connection.
    FrameStream(shm::UniqueFd fd, bool server, std::shared_ptr<const TlsContext> tls, Limits limits);
    FrameStream(shm::UniqueFd fd, bool server, std::shared_ptr<const TlsContext> tls = nullptr);
    /// A server's end; `tls` has heard the caller, and none means a plain connection.
    FrameStream(shm::UniqueFd fd, std::optional<TlsSession> tls, Limits limits);
    ~FrameStream();
    FrameStream(const FrameStream&) = delete;
    FrameStream& operator=(const FrameStream&) = delete;

    /// Connects, shakes hands, reads what has arrived (bounded by the buffer), and writes what waits.
    State pump() noexcept;
    State state() const noexcept { return state_; }

    /// Queues one frame made of the parts in sequence, and writes what the socket accepts; during the
    /// handshake it waits. False: no room (then nothing is queued, and the caller should close a peer that
    /// reads too slowly), or closed.
    bool send(std::uint16_t type, std::uint16_t stream,
              std::span<const std::span<const std::byte>> parts) noexcept;
    bool send(std::uint16_t type, std::uint16_t stream, std::span<const std::byte> payload) noexcept;

    /// The next whole frame; null: none. Frames that arrived before the connection closed are still returned.
    const Frame* next() noexcept;

    /// Bytes wait to be written: poll for POLLOUT.
    bool wants_write() const noexcept;
    std::size_t queued() const noexcept { return out_end_ - out_begin_; }
    /// Larger frames are refused from now on; at most the value in Limits. A server keeps it small until it
    /// knows the peer.
    void limit_payload(std::size_t bytes) noexcept;

    int fd() const noexcept { return fd_.get(); }
    bool encrypted() const noexcept { return tls_.has_value(); }
    /// The name of the peer's key; empty: a plain connection, or this end is the client.
    std::string_view peer_identity() const noexcept;
    /// Keys for datagrams; nothing: plain, or not open.
    std::optional<DirectionKeys> export_keys(std::string_view label) const noexcept;
    /// Why it is closed, in one line; empty: the peer closed it properly, between two frames.
    const std::string& reason() const noexcept { return reason_; }
    End how_it_ended() const noexcept { return end_; }
    /// Writes what the socket accepts at once, and closes.
    void close() noexcept;

  private:
    FrameStream(shm::UniqueFd fd, bool server, Limits limits);
    enum class From : std::uint8_t { socket, decrypted };
    void connect_and_handshake() noexcept;
    void read_some(From from) noexcept;
    void write_some() noexcept;
    TlsSession::Moved read(std::span<std::byte> into) noexcept;
    TlsSession::Moved write(std::span<const std::byte> from) noexcept;
    const Frame* take() noexcept;
    bool begins_as_tls() const noexcept;
    void end(End how, std::string_view why) noexcept;  // a text that ends with ": " is completed with error_
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
    bool first_frame_ = true;  // no frame was complete yet
    int error_ = 0;            // errno when a plain connection ended
    Frame frame_;
    End end_ = End::in_order;
    std::string reason_;
};

}  // namespace knurl::bridge
