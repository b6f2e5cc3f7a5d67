#include "relay.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>

#include <netinet/in.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/link/clock.hpp>
#include <knurl/link/text.hpp>

namespace knurl::bridge {

namespace {

// The values that epoll returns: the source, its index, and the place's use counter at that time.
enum class Source : std::uint64_t {
    listener,
    signals,
    datagrams,
    servo,
    device,
    caller,
    errands,
    peer,
    peers_servo,
    peers_assets
};

constexpr std::uint64_t source(Source what, std::size_t which = 0, std::uint32_t use = 0) {
    return static_cast<std::uint64_t>(what) << 56 | static_cast<std::uint64_t>(which) << 32 | use;
}

constexpr std::int64_t tick_ns = 100'000'000;
constexpr std::int64_t accept_pause_ns = 100'000'000;  // after the process has run out of descriptors
constexpr int most_bags = 8;      // of datagrams per round; the rest wait for the next round
constexpr int most_reports = 64;  // of one device per round
constexpr int most_calls = 64;    // per round
constexpr int most_heard = 8;     // callers whose hello is read per round, which takes longer
// A departed peer may have a few datagrams under way. More datagrams of no session are logged, once a minute.
constexpr std::uint64_t few_strays = 64;
constexpr std::int64_t strays_said_every_ns = 60'000'000'000;
constexpr std::int64_t give_way_ns = 500'000'000;

/// Never waits for the reader.
bool write_line(const std::string& line) {
    pollfd out{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
    if (::poll(&out, 1, 0) <= 0) return false;
    std::puts(line.c_str());
    std::fflush(stdout);
    return true;
}

}  // namespace

Relay::Relay(RelayOptions options)
    : options_(std::move(options)),
      listening_(listen_at(options_.listen, !options_.keys.empty())),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      out_(listening_.datagrams.get()),
      log_(write_line),
      context_{.servo = options_.servo,
               .keys = options_.keys,
               .notifier = notifier_,
               .out = out_,
               .errands = errands_} {
    context_.sessions_of = [this](std::string_view key) {
        return static_cast<std::size_t>(
            std::count_if(places_.begin(), places_.end(), [&](const Place& place) {
                return place.peer && place.peer->identified() && place.peer->has_key(key);
            }));
    };
    context_.observers_of = [this](std::string_view key, std::uint32_t device) {
        PeerContext::Observers observers;
        for (const Place& place : places_) {
            if (!place.peer) continue;
            const std::size_t held = place.peer->observers(device);
            observers.all += held;
            if (place.peer->has_key(key)) observers.by_key += held;
        }
        return observers;
    };
    if (!epoll_) throw std::runtime_error(detail::format("epoll: {}", std::strerror(errno)));
    if (!options_.keys.empty()) tls_ = TlsContext::server(options_.keys);
    watch(listening_.datagrams.get(), EPOLLIN, source(Source::datagrams), EPOLL_CTL_ADD);
    watch(errands_.event(), EPOLLIN, source(Source::errands), EPOLL_CTL_ADD);
}

Relay::~Relay() = default;

void Relay::watch(int fd, std::uint32_t events, std::uint64_t from, int operation) {
    epoll_event event{.events = events, .data = {.u64 = from}};
    if (::epoll_ctl(epoll_.get(), operation, fd, &event) != 0)
        throw std::runtime_error(detail::format("epoll: {}", std::strerror(errno)));
}

std::size_t Relay::pending() const {
    return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [](const Place& place) {
        return place.peer && !place.peer->identified();
    }));
}

std::size_t Relay::identified() const {
    return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [](const Place& place) {
        return place.peer && place.peer->identified();
    }));
}

std::uint64_t Relay::new_session(std::size_t place) const {
    std::uint64_t random = 0;
    if (::getrandom(&random, sizeof random, 0) != sizeof random)
        throw std::runtime_error(detail::format("no random numbers: {}", std::strerror(errno)));
    return random << 8 | place;
}

// -------------------------------------------------------------------------------------------------- peers

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

void Relay::serve_peer(std::size_t place, std::int64_t now) {
    Peer& peer = *places_[place].peer;
    const bool knew = peer.greeted();
    bool good = false;
    std::string why;
    places_[place].round = round_;
    try {
        context_.sessions = identified();
        good = peer.servo_answered() ? peer.go_on(context_, now) : peer.serve(context_, now);
        why = peer.why();
    } catch (const std::exception& error) {  // e.g. out of memory: only this peer ends
        why = error.what();
    }
    if (!knew && peer.greeted())
        log_.admitted(peer.from(),
                      detail::format("{}: in, role {}{}", peer.name(), role_name(peer.role()),
                                     options_.keys.empty() ? "" : ", encrypted"),
                      now);
    if (notifier_.is_open() && !watching_servo_) follow_servo();
    if (!good) return end(place, why, now, knew);
    if (places_[place].servo_left && !peer.waits_for_servo()) return servo_left(place);
    follow(place);
}

void Relay::serve_connection(std::size_t place, std::uint32_t events, std::int64_t now) {
    const Peer& peer = *places_[place].peer;
    // Its last frames are not read: the servo ends all that it had in any case.
    if (peer.waits_for_servo() && (events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0)
        return end(place, "it hung up", now, false);
    serve_peer(place, now);
}

void Relay::go_on_after_servo(std::int64_t now) {
    errands_.clear_event();
    for (std::size_t place = 0; place < places; ++place)
        if (places_[place].peer && places_[place].peer->servo_answered()) serve_peer(place, now);
}

void Relay::serve_assets(std::size_t place, std::int64_t now) {
    Peer& peer = *places_[place].peer;
    try {
        if (!peer.serve_assets()) return end(place, peer.why(), now);
    } catch (const std::exception& error) {  // as above
        return end(place, error.what(), now);
    }
    follow(place);
}

void Relay::follow(std::size_t index) {
    Place& place = places_[index];
    if (!place.watches_hang_up && place.peer->greeted()) {
        // Edge-triggered: it may have to wait for an answer.
        watch(place.peer->hang_up(), EPOLLRDHUP | EPOLLET, source(Source::peers_servo, index, place.use),
              EPOLL_CTL_ADD);
        place.watches_hang_up = true;
    }
    if (!place.watches_assets && place.peer->assets_event() >= 0) {
        watch(place.peer->assets_event(), EPOLLIN, source(Source::peers_assets, index, place.use),
              EPOLL_CTL_ADD);
        place.watches_assets = true;
    }
    // While the servo is asked, what comes stays in the kernel's buffer; a hang-up is noticed in any case.
    const std::uint32_t events = (place.peer->waits_for_servo() ? EPOLLRDHUP : EPOLLIN) |
                                 (place.peer->wants_write() ? std::uint32_t{EPOLLOUT} : 0u);
    if (events == place.watches) return;
    place.watches = events;
    watch(place.peer->fd(), events, source(Source::peer, index, place.use), EPOLL_CTL_MOD);
}

/// `told`: the peer gets the reason, too.
void Relay::end(std::size_t index, const std::string& why, std::int64_t now, bool told, Error::Kind kind) {
    const Peer& peer = *places_[index].peer;
    if (peer.greeted()) {
        log_.event(detail::format("{}: out: {}{}", peer.name(), why, peer.dropped()), now);
    } else {
        log_.refused(peer.from(), peer.name(), why, now);
    }
    close(index, kind, told ? "the bridge ends this connection: " + why : "");
}

void Relay::close(std::size_t index, Error::Kind kind, const std::string& text) {
    Place& place = places_[index];
    place.peer->close(context_, kind, text);
    place.peer.reset();  // closing removes its descriptors from the epoll set
    ++place.use;
}

void Relay::admit(std::vector<Key> keys) {
    if (!tls_ || keys.empty()) return;
    tls_ = TlsContext::server(keys);
    options_.keys = std::move(keys);
    context_.keys = options_.keys;
    const std::int64_t now = detail::monotonic_ns();
    for (std::size_t seat = 0; seat < WaitingRoom::seats; ++seat)
        if (room_.at(seat) != nullptr) turn_away(seat, "the keys were read again", now);
    for (std::size_t i = 0; i < places; ++i) {
        if (!places_[i].peer || places_[i].peer->holds_one_of(options_.keys)) continue;
        // A caller in the handshake may have used an old key, and which one is not known yet: it must call
        // again.
        const bool knew = places_[i].peer->admitted();
        const std::string why = knew ? "its key is not in the file any more" : "the keys were read again";
        end(i, why, now, true, knew ? Error::Kind::permission : Error::Kind::disconnected);
    }
}

// ----------------------------------------------------------------------------------------------- the servo

void Relay::follow_servo() {
    watch(notifier_.hang_up(), EPOLLRDHUP, source(Source::servo), EPOLL_CTL_ADD);
    for (std::size_t i = 0; i < notifier_.devices(); ++i)
        // Edge-triggered: when the last stream has just ended, nobody lowers the event.
        watch(notifier_.event(i), std::uint32_t{EPOLLIN} | EPOLLET, source(Source::device, i), EPOLL_CTL_ADD);
    watching_servo_ = true;
}

void Relay::servo_gone() {
    const std::string text = detail::format("servo '{}' has gone; start it again", options_.servo);
    log_.event(text, detail::monotonic_ns());
    for (std::size_t i = 0; i < places; ++i) {
        if (!places_[i].peer || !places_[i].peer->greeted()) continue;
        places_[i].peer->say_gone(text);
        close(i, Error::Kind::disconnected, "");
    }
    notifier_.close();
    watching_servo_ = false;
}

/// An answer that is waited for says more, and comes first.
void Relay::servo_left(std::size_t index) {
    Place& place = places_[index];
    place.servo_left = true;
    if (place.peer->waits_for_servo()) return;
    // When the servo dies its sockets close one after the other, so which of the two cases it is shows later.
    place.peer->say_gone(
        detail::format("servo '{}' has gone, or has closed this connection; start it again", options_.servo));
    close(index, Error::Kind::disconnected, "");
}

void Relay::serve_device(std::size_t device, std::int64_t now) {
    if (device >= notifier_.devices()) return;
    Report report;
    std::uint64_t unseen = 0;
    for (int i = 0; i < most_reports && notifier_.next(device, report, unseen); ++i) {
        for (std::size_t place = 0; place < places; ++place) {
            Peer* const peer = places_[place].peer.get();
            if (peer == nullptr || !peer->greeted()) continue;
            if (peer->cycle(static_cast<std::uint32_t>(device), report, unseen, now, context_)) {
                follow(place);  // watch for what could not be sent at once
                continue;
            }
            end(place, peer->why(), now);
        }
    }
    out_.flush();
    notifier_.rearm(device);  // raises its event at once if there are more
}

// ------------------------------------------------------------------------------------------------ the loop

void Relay::take_datagrams(std::int64_t now) {
    for (int bag = 0; bag < most_bags; ++bag) {
        const std::size_t count = receive_batch_.receive(listening_.datagrams.get());
        for (std::size_t i = 0; i < count; ++i) {
            const std::span<std::byte> datagram = receive_batch_.datagram(i);
            std::uint64_t session = 0;
            ++strays_;
            if (datagram.size() < sizeof(DatagramHeader)) continue;
            std::memcpy(&session, datagram.data(), sizeof session);
            const std::size_t place = session & 0xff;
            if (place >= places || !places_[place].peer) continue;
            Peer& peer = *places_[place].peer;
            const PeerAddress& from = receive_batch_.from(i);
            if (peer.session() != session || !same_host(peer.from(), from.address)) continue;
            --strays_;
            peer.datagram(datagram, from, now, context_);
        }
        if (count < ReceiveBatch::most) return;
    }
}

void Relay::tick(std::int64_t now) {
    // If this process was stopped, it has heard nothing meanwhile.
    const bool stood_still = last_tick_ns_ != 0 && now - last_tick_ns_ > dead_after_ns / 2;
    last_tick_ns_ = now;
    if (strays_ > few_strays && now >= say_strays_after_ns_) {
        log_.event(detail::format("{} datagrams of no session were dropped", strays_), now);
        strays_ = 0;
        say_strays_after_ns_ = now + strays_said_every_ns;
    }
    constexpr auto greeting_ns = static_cast<std::int64_t>(greeting_seconds * 1e9);
    const auto silent = [] {
        return detail::format("it did not identify itself within {:g} s", greeting_seconds);
    };
    for (std::size_t seat = 0; seat < WaitingRoom::seats && !room_.empty(); ++seat) {
        Caller* const caller = room_.at(seat);
        if (caller == nullptr) continue;
        if (stood_still) caller->since_ns = now;
        if (now - caller->since_ns > greeting_ns) turn_away(seat, silent(), now);
    }
    for (std::size_t i = 0; i < places; ++i) {
        Peer* const peer = places_[i].peer.get();
        if (peer == nullptr) continue;
        if (stood_still || peer->waits_for_servo()) peer->heard(now);
        const auto patience = peer->greeted() ? dead_after_ns : greeting_ns;
        if (now - peer->heard_ns() <= patience) {
            follow(i);
            continue;
        }
        const std::string why = peer->greeted() ? detail::format("nothing was heard of it for {} s",
                                                                 dead_after_ns / 1'000'000'000)
                                                : silent();
        end(i, why, now);
    }
}

// What one event of epoll asks for. What ends the round is noted in `happened`.
void Relay::serve(const epoll_event& event, std::int64_t now, Happened& happened) {
    const auto what = static_cast<Source>(event.data.u64 >> 56);
    const auto which = static_cast<std::size_t>(event.data.u64 >> 32 & 0xffffff);
    const auto use = static_cast<std::uint32_t>(event.data.u64);
    const bool there = which < places && places_[which].peer && places_[which].use == use;
    switch (what) {
        case Source::signals:
            happened.told = true;  // after the others, since a device's edge comes once
            break;
        case Source::listener:
            accept_all(now);
            break;
        case Source::datagrams:
            take_datagrams(now);
            break;
        case Source::device:
            serve_device(which, now);
            break;
        case Source::servo:
            happened.gone = true;
            break;
        case Source::peers_servo:
            if (there) servo_left(which);
            break;
        case Source::peers_assets:
            if (there) serve_assets(which, now);
            break;
        case Source::caller:
            if (room_.at(which) != nullptr && room_.at(which)->use == use)
                listen_to(which, event.events, now);
            break;
        case Source::errands:
            go_on_after_servo(now);
            break;
        case Source::peer:
            // Once per round; the rest is still there in the next round.
            if (there && places_[which].round != round_) serve_connection(which, event.events, now);
            break;
    }
}

void Relay::run(int signals) {
    watch(signals, EPOLLIN, source(Source::signals), EPOLL_CTL_ADD);
    for (std::array<epoll_event, 64> events;;) {
        std::int64_t now = detail::monotonic_ns();
        const bool anyone =
            !room_.empty() || std::any_of(places_.begin(), places_.end(),
                                          [](const Place& place) { return place.peer != nullptr; });
        watch_listener(now >= accept_after_ns_);
        const bool timed = anyone || !accepting_;
        if (!timed) last_tick_ns_ = 0;
        const std::int64_t left = std::max<std::int64_t>(0, last_tick_ns_ + tick_ns - now);
        const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()),
                                       anyone_spoke_ ? 0
                                       : timed       ? static_cast<int>((left + 999'999) / 1'000'000)
                                                     : -1);
        if (count < 0 && errno != EINTR)
            throw std::runtime_error(detail::format("epoll_wait: {}", std::strerror(errno)));
        now = detail::monotonic_ns();
        Happened happened;
        ++round_;
        for (int i = 0; i < count; ++i) serve(events[static_cast<std::size_t>(i)], now, happened);
        hear_callers(now);
        out_.flush();
        if (happened.gone) servo_gone();
        if (happened.told) return watch(signals, 0, 0, EPOLL_CTL_DEL);
        if (now - last_tick_ns_ >= tick_ns) tick(now);
    }
}

}  // namespace knurl::bridge
