#pragma once
// Who may take one more of a number of places that all clients share: nobody may hold more than he leaves free.
// So one alone gets half of them, the next one half of the rest, and nobody finds all places taken.

#include <cstddef>

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

/// May this peer take one of `left` places?
inline bool may_take(const Share& held, const Peer& peer, std::size_t left) noexcept {
    return held.by_process < left && (trusted(peer) || held.by_user < left);
}

}  // namespace knurl::servo
