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

#include "relay_source.hpp"

namespace knurl::bridge {

namespace {

constexpr std::int64_t tick_ns = 100'000'000;
constexpr int most_bags = 8;      // of datagrams per round; the rest wait for the next round
constexpr int most_reports = 64;  // of one device per round
// A departed peer may have a few datagrams under way. More datagrams of no session are logged, once a minute.
constexpr std::uint64_t few_strays = 64;
constexpr std::int64_t strays_said_every_ns = 60'000'000'000;

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

std::size_t Relay::identified() const {
    return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [](const Place& place) {
        return place.peer && place.peer->identified();
    }));
}

// -------------------------------------------------------------------------------------------------- peers

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
