#pragma once
// TLS 1.3 with an external pre-shared key (RFC 8446, 4.2.11) and a Diffie-Hellman exchange (psk_dhe_ke), by
// OpenSSL: no certificates, no other version, no tickets, no early data. The sockets are non-blocking, and
// the owner polls them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/bridge/keys.hpp>

namespace knurl::bridge {

/// Shared by all connections of one end. Must outlive its sessions; several threads may use it.
class TlsContext {
  public:
    static std::shared_ptr<const TlsContext> client(Key key);
    static std::shared_ptr<const TlsContext> server(std::vector<Key> keys);
    ~TlsContext();
    TlsContext(const TlsContext&) = delete;
    TlsContext& operator=(const TlsContext&) = delete;

  private:
    friend class TlsSession;
    struct Impl;
    explicit TlsContext(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Keys of the datagrams, one per direction; both ends of a connection derive the same two.
struct DirectionKeys {
    std::array<std::byte, key_bytes> send{}, receive{};
};

/// One connection.
class TlsSession {
  public:
    enum class Io : std::uint8_t {
        done,    // `bytes` were moved (reading: 1 or more)
        again,   // the socket has no data, or no room
        closed,  // the peer has sent all it will send
        failed,  // reason()
    };
    struct Moved {
        Io io;
        std::size_t bytes = 0;
    };

    TlsSession(std::shared_ptr<const TlsContext> context, int fd);
    ~TlsSession();
    TlsSession(TlsSession&&) noexcept;
    TlsSession& operator=(TlsSession&&) noexcept;
    Io handshake() noexcept;  // done: both ends have shown that they hold the key
    Moved read(std::span<std::byte> into) noexcept;
    Moved write(std::span<const std::byte> from) noexcept;
    void close() noexcept;  // tells the peer, and does not wait

    bool wants_write() const noexcept;     // the last call could not write
    std::size_t pending() const noexcept;  // bytes that read() has without the socket
    /// Server: the name of the client's key, once the handshake is done.
    std::string_view peer_identity() const noexcept;
    /// Server: the client's hello was made with a key, now or earlier.
    bool known_key() const noexcept;
    /// RFC 8446, 7.5. False: the handshake is not done.
    bool export_keys(std::string_view label, DirectionKeys& out) const noexcept;
    /// One line: what went wrong and what to do.
    const std::string& reason() const noexcept;
    /// It failed because the keys do not match: trying again changes nothing.
    bool about_keys() const noexcept;

  private:
    friend class TlsContext;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::bridge
