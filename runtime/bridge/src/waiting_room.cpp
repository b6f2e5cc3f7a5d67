#include "waiting_room.hpp"

#include <algorithm>
#include <cstring>
#include <tuple>

#include <netinet/in.h>

#include "frame_stream.hpp"
#include "wire.hpp"

namespace knurl::bridge {

WaitingRoom::Host WaitingRoom::host_of(const sockaddr_storage& address) noexcept {
    Host host{};
    if (address.ss_family == AF_INET) {
        std::memcpy(host.data(), &reinterpret_cast<const sockaddr_in&>(address).sin_addr, sizeof(in_addr));
        return host;
    }
    const in6_addr& long_one = reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
    // The first half of an address that stands for one of IPv4 is zero, as that of this host itself.
    const bool whole = IN6_IS_ADDR_V4MAPPED(&long_one) || IN6_IS_ADDR_LOOPBACK(&long_one);
    std::memcpy(host.data(), &long_one, whole ? sizeof long_one : sizeof long_one / 2);
    return host;
}

std::size_t WaitingRoom::enter(shm::UniqueFd socket, const sockaddr_storage& from, std::int64_t now) {
    const auto free =
        std::find_if(callers_.begin(), callers_.end(), [](const Caller& each) { return !each.socket; });
    std::size_t& of_its_host = hosts_[host_of(from)];
    ++of_its_host;
    ++taken_;
    *free = {.socket = std::move(socket),
             .from = from,
             .since_ns = now,
             .tls = {},
             .spoken = false,
             .of_its_host = &of_its_host,
             .use = ++last_use_};
    return static_cast<std::size_t>(free - callers_.begin());
}

Caller WaitingRoom::leave(std::size_t seat) noexcept {
    const auto host = hosts_.find(host_of(callers_[seat].from));
    if (--host->second == 0) hosts_.erase(host);
    --taken_;
    return std::exchange(callers_[seat], Caller{});
}

std::size_t WaitingRoom::gives_way() const {
    const auto sooner = [](const Caller& a, const Caller& b) {
        const bool key_a = a.tls.has_value(), key_b = b.tls.has_value();
        return std::tie(*b.of_its_host, key_a, a.since_ns) < std::tie(*a.of_its_host, key_b, b.since_ns);
    };
    std::size_t chosen = seats;
    for (std::size_t seat = 0; seat < seats; ++seat)
        if (callers_[seat].socket && (chosen == seats || sooner(callers_[seat], callers_[chosen])))
            chosen = seat;
    return chosen;
}

bool is_worth_reading(std::span<const std::byte> bytes, bool tls) noexcept {
    constexpr std::size_t handshake = 22, alert = 21, record_header = 5, record_start = 3;
    const auto at = [&](std::size_t i) { return std::to_integer<std::size_t>(bytes[i]); };
    if (tls) {
        if (!bytes.empty() && at(0) != handshake) return true;
        if (bytes.size() < record_header) return false;
        const std::size_t whole = record_header + (at(3) << 8 | at(4));
        return whole > max_hello_bytes || bytes.size() >= whole;
    }
    // A client with a key is told at once that there are none here.
    if (bytes.size() >= record_start && (at(0) == alert || at(0) == handshake) && at(1) == 3) return true;
    FrameHeader header;
    if (bytes.size() < sizeof header) return false;
    std::memcpy(&header, bytes.data(), sizeof header);
    return header.bytes > max_greeting_bytes || bytes.size() >= sizeof header + header.bytes;
}

}  // namespace knurl::bridge
