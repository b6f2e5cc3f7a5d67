#include "connection.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>

namespace knurl::vrpn {

namespace {

constexpr int datagrams_a_round = 64;
/// A client that has UDP says so within its first messages.
constexpr std::chrono::seconds says_port_within{1};

void set(int fd, int level, int option, int value) {
    ::setsockopt(fd, level, option, &value, sizeof value);
}

/// A host that has vanished says nothing: four probes of a second tell.
void watch_over(int tcp) {
    set(tcp, IPPROTO_TCP, TCP_NODELAY, 1);
    set(tcp, SOL_SOCKET, SO_KEEPALIVE, 1);
    set(tcp, IPPROTO_TCP, TCP_KEEPIDLE, 1);
    set(tcp, IPPROTO_TCP, TCP_KEEPINTVL, 1);
    set(tcp, IPPROTO_TCP, TCP_KEEPCNT, 3);
    set(tcp, IPPROTO_TCP, TCP_USER_TIMEOUT, 4000);
    // Reports that a slow client has not read are old: a small queue keeps few.
    set(tcp, SOL_SOCKET, SO_SNDBUF, 32 << 10);
}

sockaddr_in local_end(const ServerOptions& options, std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    ::inet_pton(AF_INET, options.address.c_str(), &address.sin_addr);
    return address;
}

const sockaddr* plain(const sockaddr_in& address) {
    return reinterpret_cast<const sockaddr*>(&address);
}

}  // namespace

Connection::Connection(Core& core, const sockaddr_in& peer, bool back)
    : core_(core), peer_(peer), back_(back), name_(text_of(peer)), begun_(core.now), moved_(core.now) {
    tcp_ready_.call = [this](std::uint32_t events) { on_tcp(events); };
    udp_ready_.call = [this](std::uint32_t) { on_udp(); };
}

Connection::~Connection() {
    session_.reset();
    for (Connection*& holder : core_.holders)
        if (holder == this) holder = nullptr;
}

std::unique_ptr<Connection> Connection::back(Core& core, const sockaddr_in& peer) {
    std::unique_ptr<Connection> made(new Connection(core, peer, true));
    made->tcp_ = shm::UniqueFd(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const sockaddr_in from = local_end(core.options, 0);
    if (!made->tcp_ || ::bind(made->tcp_.get(), plain(from), sizeof from) != 0 ||
        (::connect(made->tcp_.get(), plain(peer), sizeof peer) != 0 && errno != EINPROGRESS)) {
        made->end(fmt::format("cannot be connected to: {}", std::strerror(errno)));
        return made;
    }
    made->writes_ = true;
    core.loop.add(made->tcp_.get(), EPOLLIN | EPOLLOUT, made->tcp_ready_);
    return made;
}

std::unique_ptr<Connection> Connection::accepted(Core& core, shm::UniqueFd tcp, const sockaddr_in& peer) {
    std::unique_ptr<Connection> made(new Connection(core, peer, false));
    made->tcp_ = std::move(tcp);
    core.loop.add(made->tcp_.get(), EPOLLIN, made->tcp_ready_);
    made->greet();
    return made;
}

void Connection::end(const std::string& why) {
    if (over_) return;
    over_ = true;
    note("end", why);
    tcp_.reset();
    udp_.reset();
}

void Connection::note(std::string_view kind, const std::string& line) {
    core_.log.say(kind, fmt::format("client {}: {}", name_, line), core_.now);
}

/// This end's cookie. Both ends send theirs at once.
bool Connection::greet() {
    connected_ = true;
    watch_over(tcp_.get());
    const auto mine = cookie();
    send(Service::reliable, mine);
    return !over_;
}

void Connection::on_tcp(std::uint32_t events) {
    if (over_) return;
    if (!connected_) {
        int error = 0;
        socklen_t size = sizeof error;
        ::getsockopt(tcp_.get(), SOL_SOCKET, SO_ERROR, &error, &size);
        if (error != 0) return end(fmt::format("cannot be connected to: {}", std::strerror(error)));
        if ((events & EPOLLOUT) == 0 || !greet()) return;
    }
    if ((events & EPOLLOUT) != 0) flush();
    if (!over_ && (events & (EPOLLIN | EPOLLHUP | EPOLLERR)) != 0 && read()) parse();
}

bool Connection::read() {
    const std::size_t before = in_.size();
    in_.resize(before + (std::size_t{64} << 10));
    const ssize_t got = ::recv(tcp_.get(), in_.data() + before, in_.size() - before, 0);
    in_.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got > 0) return true;
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return false;
    end(got == 0 ? (session_ ? "has gone" : "has gone before it began")
                 : fmt::format("has gone: {}", std::strerror(errno)));
    return false;
}

void Connection::parse() {
    std::span<const std::byte> rest(in_);
    if (!session_) {
        if (rest.size() < cookie_bytes) return;  // tick() ends it if the others never come
        const Cookie theirs = read_cookie(rest.first<cookie_bytes>());
        if (!theirs.refused.empty()) return end(theirs.refused);
        rest = rest.subspan(cookie_bytes);
        begin();
        if (over_) return;
    }
    Message message;
    Split found = Split::more;
    while ((found = split(rest, message)) == Split::whole) {
        const std::string why = session_->receive(message, Service::reliable, core_.now);
        if (over_) return;
        if (!why.empty()) return end(why);
    }
    if (found == Split::bad) return end("sent a message of an impossible length");
    in_.erase(in_.begin(), in_.end() - static_cast<std::ptrdiff_t>(rest.size()));
    session_->received(core_.now);
}

void Connection::begin() {
    std::uint16_t port = 0;
    sockaddr_in here{};
    socklen_t size = sizeof here;
    ::getsockname(tcp_.get(), reinterpret_cast<sockaddr*>(&here), &size);
    const std::string address = text_of(here);
    if (back_) {
        here.sin_port = 0;
        udp_ = shm::UniqueFd(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
        size = sizeof here;
        if (!udp_ || ::bind(udp_.get(), plain(here), sizeof here) != 0 ||
            ::getsockname(udp_.get(), reinterpret_cast<sockaddr*>(&here), &size) != 0)
            return end(fmt::format("no port for its datagrams: {}", std::strerror(errno)));
        port = ntohs(here.sin_port);
        core_.loop.add(udp_.get(), EPOLLIN, udp_ready_);
    }
    session_ = std::make_unique<Session>(core_.options.session, *this);
    session_->begin(address.substr(0, address.find(':')), port, core_.now);
}

void Connection::on_udp() {
    std::array<std::byte, most_datagram> datagram;
    for (int i = 0; i < datagrams_a_round && !over_; ++i) {
        sockaddr_in from{};
        socklen_t size = sizeof from;
        const ssize_t got = ::recvfrom(udp_.get(), datagram.data(), datagram.size(), MSG_TRUNC,
                                       reinterpret_cast<sockaddr*>(&from), &size);
        if (got < 0) break;
        if (static_cast<std::size_t>(got) > datagram.size()) {
            note("datagram", "a datagram is too long, and dropped");
            continue;
        }
        take_datagram(std::span(datagram).first(static_cast<std::size_t>(got)), from);
    }
    if (!over_) session_->received(core_.now);
}

/// Only from the client's host, and only from the first port there: a client sends from another port than the one that it
/// has described.
void Connection::take_datagram(std::span<const std::byte> datagram, const sockaddr_in& from) {
    if (from.sin_addr.s_addr != peer_.sin_addr.s_addr ||
        (datagrams_from_ != 0 && from.sin_port != datagrams_from_))
        return note("stranger", fmt::format("a datagram of a stranger, {}, is dropped", text_of(from)));
    Message message;
    Split found = Split::more;
    while (!datagram.empty() && (found = split(datagram, message)) == Split::whole) {
        datagrams_from_ = from.sin_port;
        session_->receive(message, Service::quick, core_.now);
        if (over_) return;
    }
    if (found != Split::whole)
        note("datagram", "a datagram has a message of an impossible length; the rest of it is dropped");
}

void Connection::takes_datagrams(std::uint16_t port) {
    if (back_) datagrams_to_ = htons(port);
}

void Connection::send(Service service, std::span<const std::byte> messages) {
    if (over_) return;
    if (service == Service::quick && back_) {
        if (datagrams_to_ != 0) {
            sockaddr_in to = peer_;
            to.sin_port = datagrams_to_;
            ::sendto(udp_.get(), messages.data(), messages.size(), MSG_DONTWAIT | MSG_NOSIGNAL, plain(to),
                     sizeof to);
            return;
        }
        if (core_.now - begun_ < says_port_within) return;
    }
    // A report is not worth waiting for: the next one is newer.
    if (service == Service::quick && !out_.empty()) return;
    if (out_.empty()) moved_ = core_.now;
    if (out_.size() + messages.size() > core_.options.most_waiting)
        return end("does not read what it is sent");
    out_.insert(out_.end(), messages.begin(), messages.end());
    flush();
}

void Connection::flush() {
    if (over_ || !connected_) return;
    if (!out_.empty()) {
        const ssize_t sent = ::send(tcp_.get(), out_.data(), out_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent < 0 && errno != EAGAIN && errno != EINTR)
            return end(fmt::format("has gone: {}", std::strerror(errno)));
        if (sent > 0) {
            out_.erase(out_.begin(), out_.begin() + sent);
            moved_ = core_.now;
        }
    }
    if (writes_ == !out_.empty()) return;
    writes_ = !out_.empty();
    core_.loop.change(tcp_.get(), writes_ ? EPOLLIN | EPOLLOUT : EPOLLIN, tcp_ready_);
}

void Connection::reports(std::size_t sender, std::span<const HandReport> reports) {
    if (!over_ && session_) session_->report(sender, reports, std::chrono::steady_clock::now());
}

void Connection::tick() {
    if (over_) return;
    if (!session_) {
        if (core_.now - begun_ > core_.options.begin_within)
            end(connected_ ? "has not said which version of VRPN it speaks"
                           : "cannot be connected to: no answer");
        return;
    }
    if (!out_.empty() && core_.now - moved_ > core_.options.stalled_after)
        return end("does not read what it is sent");
    session_->tick(core_.now);
}

std::string Connection::hold(std::size_t sender) {
    const ServerOptions& options = core_.options;
    const std::string& name = options.senders[sender].name;
    const std::uint32_t address = number_of(peer_);
    if (std::none_of(options.force_peers.begin(), options.force_peers.end(),
                     [&](const HostRange& range) { return range.has(address); }))
        return fmt::format("no force for {}: the operator of knurl-vrpn allows it with --force-peer {}",
                           name_, name_.substr(0, name_.find(':')));
    Connection*& holder = core_.holders[sender];
    if (holder != nullptr && holder != this)
        return fmt::format("the force of '{}' is commanded by the client {}; end that one first", name,
                           holder->name_);
    holder = this;
    return {};
}

std::unique_ptr<gateway::PeerCommands> Connection::make_hand(std::size_t sender) {
    const auto& device = core_.devices.senders()[sender].device;
    return std::make_unique<gateway::PeerHand>(
        gateway::PeerOptions{.servo = core_.options.servo,
                             .device = device ? device->name : core_.options.senders[sender].device,
                             .peer = "vrpn " + name_});
}

}  // namespace knurl::vrpn
