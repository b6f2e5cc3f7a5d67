// Callers, from the kernel's queue to a peer's place.

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>

#include <netinet/in.h>
#include <sys/epoll.h>
#include <sys/random.h>
#include <sys/socket.h>

#include <knurl/link/text.hpp>

#include "relay.hpp"
#include "relay_source.hpp"

namespace knurl::bridge {

namespace {

constexpr std::int64_t accept_pause_ns = 100'000'000;  // after the process has run out of descriptors
constexpr int most_calls = 64;                         // per round
constexpr int most_heard = 8;  // callers whose hello is read per round, which takes longer
constexpr std::int64_t give_way_ns = 500'000'000;

}  // namespace

std::size_t Relay::pending() const {
    return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [](const Place& place) {
        return place.peer && !place.peer->identified();
    }));
}

std::uint64_t Relay::new_session(std::size_t place) const {
    std::uint64_t random = 0;
    if (::getrandom(&random, sizeof random, 0) != sizeof random)
        throw std::runtime_error(detail::format("no random numbers: {}", std::strerror(errno)));
    return random << 8 | place;
}

void Relay::watch_listener(bool wanted) {
    if (wanted == accepting_) return;
    watch(listening_.callers.get(), EPOLLIN, source(Source::listener),
          wanted ? EPOLL_CTL_ADD : EPOLL_CTL_DEL);
    accepting_ = wanted;
}

/// Callers are taken out of the kernel's queue at once, so that none blocks the others there. (Of those who
/// wait in it for TCP_DEFER_ACCEPT the kernel would drop none for another one.)
void Relay::accept_all(std::int64_t now) {
    for (int calls = 0; calls < most_calls; ++calls) {
        sockaddr_storage from{};
        socklen_t length = sizeof from;
        shm::UniqueFd socket(::accept4(listening_.callers.get(), reinterpret_cast<sockaddr*>(&from), &length,
                                       SOCK_NONBLOCK | SOCK_CLOEXEC));
        if (!socket) {
            if (errno != EMFILE && errno != ENFILE && errno != ENOMEM && errno != ENOBUFS) return;
            accept_after_ns_ = now + accept_pause_ns;
            if (!room_.empty()) turn_away(room_.gives_way(), "this process has no descriptor left", now);
            return;
        }
        if (!caller_rate_.allows(from, now)) {
            log_.refused(from, numeric(from), "its host calls too often", now);
            continue;
        }
        if (room_.full())
            turn_away(room_.gives_way(), "it did not identify itself, and another caller waits", now);
        const std::size_t seat = room_.enter(std::move(socket), from, now);
        // Edge-triggered: a part of a hello stays in the kernel's buffer, and must wake nobody.
        const Caller& caller = *room_.at(seat);
        watch(caller.socket.get(), EPOLLIN | EPOLLRDHUP | EPOLLET, source(Source::caller, seat, caller.use),
              EPOLL_CTL_ADD);
    }
}

/// A caller has sent something, or hung up. Nothing is taken from the socket before the hello is whole.
void Relay::listen_to(std::size_t seat, std::uint32_t events, std::int64_t now) {
    Caller& caller = *room_.at(seat);
    if (caller.spoken) return;
    std::array<std::byte, max_hello_bytes> bytes;
    const ssize_t got = ::recv(caller.socket.get(), bytes.data(), bytes.size(), MSG_PEEK | MSG_DONTWAIT);
    const std::size_t size = got > 0 ? static_cast<std::size_t>(got) : 0;
    caller.spoken = caller.tls ? size > 0 : is_worth_reading({bytes.data(), size}, tls_ != nullptr);
    anyone_spoke_ = anyone_spoke_ || caller.spoken;
    if (!caller.spoken && (events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0)
        turn_away(seat, tls_ ? "the peer hung up in the handshake" : "it hung up", now);
}

/// By turns, a few per round: a hello costs time of the one thread.
void Relay::hear_callers(std::int64_t now) {
    const std::size_t first = next_heard_;
    anyone_spoke_ = false;
    for (std::size_t i = 0, heard = 0; i < WaitingRoom::seats; ++i) {
        const std::size_t seat = (first + i) % WaitingRoom::seats;
        const Caller* const caller = room_.at(seat);
        if (caller == nullptr || !caller->spoken) continue;
        if (heard++ == most_heard) {
            anyone_spoke_ = true;
            return;
        }
        next_heard_ = (seat + 1) % WaitingRoom::seats;
        try {
            hear(seat, now);
        } catch (const std::bad_alloc&) {  // only this caller ends
            if (room_.at(seat) != nullptr) turn_away(seat, "this process has no memory left", now);
        }
    }
}

/// Only who holds a key gets a place. A hello alone is no proof, since it may have been recorded; the answer
/// to this end's is.
void Relay::hear(std::size_t seat, std::int64_t now) {
    Caller& caller = *room_.at(seat);
    if (!tls_) return give_place(seat, now);
    if (!caller.tls) caller.tls.emplace(tls_, caller.socket.get());
    caller.spoken = false;
    const TlsSession::Io shaken = caller.tls->handshake();
    if (shaken == TlsSession::Io::done) return give_place(seat, now);
    if (shaken == TlsSession::Io::failed) return turn_away(seat, std::string(caller.tls->reason()), now);
    if (shaken == TlsSession::Io::closed) return turn_away(seat, "the peer hung up in the handshake", now);
    if (!caller.tls->known_key()) turn_away(seat, "its first message is no whole hello", now);
}

void Relay::give_place(std::size_t seat, std::int64_t now) {
    if (!make_room(room_.at(seat)->from, now))
        return turn_away(seat, "too many callers that are not identified yet", now);
    const auto free =
        std::find_if(places_.begin(), places_.end(), [](const Place& place) { return !place.peer; });
    if (free == places_.end()) return turn_away(seat, "all places are taken", now);
    Caller caller = room_.leave(seat);
    const auto place = static_cast<std::size_t>(free - places_.begin());
    free->peer = std::make_unique<Peer>(std::move(caller.socket), caller.from, new_session(place),
                                        std::move(caller.tls), now);
    ++free->use;
    free->watches_hang_up = free->watches_assets = free->servo_left = false;
    free->watches = EPOLLIN;
    watch(free->peer->fd(), free->watches, source(Source::peer, place, free->use), EPOLL_CTL_MOD);
    serve_peer(place, now);
}

void Relay::turn_away(std::size_t seat, const std::string& why, std::int64_t now) {
    const Caller caller = room_.leave(seat);
    log_.refused(caller.from, numeric(caller.from), why, now);
    // Unread bytes would make the kernel discard an alert that is on its way.
    std::array<std::byte, max_hello_bytes> unread;
    [[maybe_unused]] const ssize_t got =
        ::recv(caller.socket.get(), unread.data(), unread.size(), MSG_DONTWAIT);
}

/// Makes room for one more caller in the places. The host with the most callers there gives up its oldest:
/// at once for another host, for its own callers only after a while. Else a crowd of legitimate callers would
/// evict each other for ever.
bool Relay::make_room(const sockaddr_storage& from, std::int64_t now) {
    const std::size_t own = pending_of(from);
    if (own < most_pending_of_host && pending() < most_pending) return true;
    std::size_t oldest = places, most = own;
    for (std::size_t i = 0; i < places; ++i) {
        const Peer* const peer = places_[i].peer.get();
        if (peer == nullptr || peer->identified()) continue;
        const std::size_t theirs = pending_of(peer->from());
        // A host at its limit gives up its own oldest caller.
        if (own >= most_pending_of_host ? !same_host(peer->from(), from) : theirs < most) continue;
        if (oldest == places || theirs > most || peer->heard_ns() < places_[oldest].peer->heard_ns())
            oldest = i;
        most = theirs;
    }
    if (oldest == places) return false;
    if (most <= own + 1 && now - places_[oldest].peer->heard_ns() < give_way_ns) return false;
    end(oldest, "it did not identify itself, and another caller waits", now);
    return true;
}

std::size_t Relay::pending_of(const sockaddr_storage& host) const {
    return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [&](const Place& place) {
        return place.peer && !place.peer->identified() && same_host(place.peer->from(), host);
    }));
}

}  // namespace knurl::bridge
