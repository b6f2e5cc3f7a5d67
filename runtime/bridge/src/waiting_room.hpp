#pragma once
// Callers that have not proved who they are. One of them costs a socket here, and TLS's state once it has
// sent a hello that was made with a key (by its owner, or recorded from one). So there is room for many, and
// none of them has a peer's place. When the room is full, the host with the most callers loses one. So hosts
// that only call cannot drive out a host with one caller, however long its answers are under way.

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include <sys/socket.h>

#include <knurl/shm/fd.hpp>

#include "tls.hpp"

namespace knurl::bridge {

struct Caller {
    shm::UniqueFd socket;  // none: a free seat
    sockaddr_storage from{};
    std::int64_t since_ns = 0;
    std::optional<TlsSession> tls{};           // it has sent a hello that was made with a key
    bool spoken = false;                       // it waits to be heard
    const std::size_t* of_its_host = nullptr;  // number of callers
    std::uint32_t use = 0;                     // so that events of an earlier caller are ignored
};

class WaitingRoom {
  public:
    static constexpr std::size_t seats = 512;

    bool full() const noexcept { return taken_ == seats; }
    bool empty() const noexcept { return taken_ == 0; }
    /// Only where it is not full. Returns the seat.
    std::size_t enter(shm::UniqueFd socket, const sockaddr_storage& from, std::int64_t now);
    Caller leave(std::size_t seat) noexcept;
    /// Null: a free seat.
    Caller* at(std::size_t seat) noexcept {
        return seat < seats && callers_[seat].socket ? &callers_[seat] : nullptr;
    }
    /// Whoever gives way to another one: of the host with the most callers; first one whose hello showed no
    /// key; then the oldest. Only where it is not empty.
    std::size_t gives_way() const;

  private:
    /// IPv6: the first half of the address, since a host has all addresses of the second one.
    using Host = std::array<std::byte, 16>;
    static Host host_of(const sockaddr_storage& address) noexcept;

    std::array<Caller, seats> callers_;
    std::map<Host, std::size_t> hosts_;  // number of callers
    std::size_t taken_ = 0;
    std::uint32_t last_use_ = 0;
};

/// Longer hellos than this are none of a client's of ours.
inline constexpr std::size_t max_hello_bytes = 2048;
/// A caller's first bytes hold a hello, or can be the begin of none: whoever reads them says why.
bool is_worth_reading(std::span<const std::byte> bytes, bool tls) noexcept;

}  // namespace knurl::bridge
