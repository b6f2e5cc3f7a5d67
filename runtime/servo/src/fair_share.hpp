#pragma once
// Who may take one more of a number of places that all clients share: nobody may hold more than he leaves free.
// So one alone gets half of them, the next one half of the rest, and nobody finds all places taken.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <sys/types.h>
#include <unistd.h>

#include <knurl/servo/claim_table.hpp>

namespace knurl::servo {

/// Places held by the process and by the user of one peer.
struct Share {
    std::size_t by_process = 0;
    std::size_t by_user = 0;

    void count(const Peer& holder, const Peer& peer) noexcept {
        by_process += holder.pid == peer.pid ? 1 : 0;
        by_user += holder.uid == peer.uid ? 1 : 0;
    }
};

/// A user who could stop the servo anyway has no share of his own, only his processes have.
inline bool trusted(const Peer& peer) noexcept {
    return peer.uid == 0 || peer.uid == ::geteuid();
}

/// Whether this peer may take one of `left` places. None: it may; else who holds how much, for a refusal.
inline std::optional<std::string> takes_too_much(const Share& held, const Peer& peer, std::size_t left) {
    const bool process = held.by_process >= left;
    if (!process && (trusted(peer) || held.by_user < left)) return std::nullopt;
    return fmt::format("{} {} holds {} and leaves {}, and nobody may hold more than he leaves,",
                       process ? "process" : "user",
                       process ? std::int64_t{peer.pid} : std::int64_t{peer.uid},
                       process ? held.by_process : held.by_user, left);
}

}  // namespace knurl::servo
