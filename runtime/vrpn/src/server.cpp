#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <list>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <knurl/vrpn/server.hpp>

#include "connection.hpp"

namespace knurl::vrpn {

namespace {

constexpr std::chrono::milliseconds tick_every{25};
constexpr int requests_a_round = 16;
constexpr int requests_a_second = 50;  // of connections back: none is made for more

shm::UniqueFd bound(int type, const sockaddr_in& at) {
    shm::UniqueFd fd(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    int yes = 1;
    if (type == SOCK_STREAM && fd) ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (fd && ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0 &&
        (type != SOCK_STREAM || ::listen(fd.get(), 16) == 0))
        return fd;
    const char* kind = type == SOCK_STREAM ? "TCP" : "UDP";
    if (errno == EADDRINUSE)
        throw std::runtime_error(fmt::format(
            "{} port {} is in use, perhaps by another VRPN server: end that one, or take another port with "
            "--listen; clients then say Phantom0@{}",
            kind, text_of(at), text_of(at)));
    throw std::runtime_error(fmt::format("{} port {}: {}", kind, text_of(at), std::strerror(errno)));
}

sockaddr_in address_of(const ServerOptions& options) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(options.port);
    if (::inet_pton(AF_INET, options.address.c_str(), &at.sin_addr) != 1)
        throw std::runtime_error(
            fmt::format("'{}' is no IPv4 address in digits, and VRPN has no other", options.address));
    return at;
}

void check(const ServerOptions& options) {
    if (options.senders.empty()) throw std::runtime_error("there is no sender: name one");
    for (std::size_t i = 0; i < options.senders.size(); ++i) {
        const std::string& name = options.senders[i].name;
        if (name.empty() || name.size() > most_name || name.find_first_of("@ \t") != std::string::npos)
            throw std::runtime_error(
                fmt::format("'{}' is no name of a sender: it has 1 to {} characters, no space and no @", name,
                            most_name));
        for (std::size_t k = 0; k < i; ++k)
            if (options.senders[k].name == name)
                throw std::runtime_error(fmt::format("the sender '{}' is named twice", name));
    }
}

}  // namespace

struct Server::Impl {
    explicit Impl(ServerOptions given);
    ~Impl() { core.devices.end(); }  // whose threads use the connections
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    Core core;
    shm::UniqueFd tcp, udp;
    Ready tcp_ready, udp_ready;
    std::list<std::unique_ptr<Connection>> connections;
    std::function<void()> work;
    std::uint16_t port = 0;
    bool stopping = false;
    Time ticked{}, counting{};
    int requests = 0;

    bool admits(const sockaddr_in& peer, const char* what);
    void accept();
    void request();
    void call_back(const sockaddr_in& client);
    void tick();
};

Server::Impl::Impl(ServerOptions given) : core(std::move(given)) {
    check(core.options);
    sockaddr_in at = address_of(core.options);
    // With port 0: a port that is free for both.
    for (int tries = 0;; ++tries) {
        udp = bound(SOCK_DGRAM, at);
        sockaddr_in got{};
        socklen_t size = sizeof got;
        ::getsockname(udp.get(), reinterpret_cast<sockaddr*>(&got), &size);
        try {
            tcp = bound(SOCK_STREAM, got);
            port = ntohs(got.sin_port);
            break;
        } catch (const std::runtime_error&) {
            if (core.options.port != 0 || tries == 20) throw;
        }
    }
    tcp_ready.call = [this](std::uint32_t) { accept(); };
    udp_ready.call = [this](std::uint32_t) { request(); };
    core.loop.add(tcp.get(), EPOLLIN, tcp_ready);
    core.loop.add(udp.get(), EPOLLIN, udp_ready);
    core.devices.on_reports = [this](std::size_t sender, std::span<const HandReport> reports) {
        for (const auto& each : connections) each->reports(sender, reports);
    };
}

bool Server::Impl::admits(const sockaddr_in& peer, const char* what) {
    const std::uint32_t address = number_of(peer);
    const auto& peers = core.options.peers;
    if (!host_range("localhost").has(address) &&
        std::none_of(peers.begin(), peers.end(),
                     [&](const HostRange& range) { return range.has(address); })) {
        core.log.say(
            "stranger",
            fmt::format("{} of {} is refused: it is not among the hosts of --peer", what, text_of(peer)),
            core.now);
        return false;
    }
    const auto of_host = std::count_if(connections.begin(), connections.end(),
                                       [&](const auto& each) { return number_of(each->peer()) == address; });
    if (connections.size() >= core.options.most_connections ||
        static_cast<std::size_t>(of_host) >= core.options.most_of_host) {
        core.log.say("full",
                     fmt::format("{} of {} is refused: there are {} clients, {} of that host, and no more "
                                 "than {} and {} may be",
                                 what, text_of(peer), connections.size(), of_host,
                                 core.options.most_connections, core.options.most_of_host),
                     core.now);
        return false;
    }
    return true;
}

void Server::Impl::accept() {
    sockaddr_in peer{};
    socklen_t size = sizeof peer;
    shm::UniqueFd fd(
        ::accept4(tcp.get(), reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!fd) {
        if (errno == EMFILE || errno == ENFILE)
            core.log.say("files", "no more descriptors for clients: see the limit of open files (ulimit -n)",
                         core.now);
        return;
    }
    if (admits(peer, "a connection")) connections.push_back(Connection::accepted(core, std::move(fd), peer));
}

/// A client asks to be connected to. It asks again every 2 s until it is.
void Server::Impl::request() {
    for (int i = 0; i < requests_a_round; ++i) {
        std::array<std::byte, 256> datagram;
        sockaddr_in from{};
        socklen_t size = sizeof from;
        const ssize_t got = ::recvfrom(udp.get(), datagram.data(), datagram.size(), 0,
                                       reinterpret_cast<sockaddr*>(&from), &size);
        if (got < 0) return;
        const auto wanted = requested_port(std::span(datagram).first(static_cast<std::size_t>(got)));
        if (!wanted) {
            core.log.say("request",
                         fmt::format("a datagram of {} is no request for a connection", text_of(from)),
                         core.now);
            continue;
        }
        // To the host that asks, whatever address it writes.
        from.sin_port = htons(*wanted);
        call_back(from);
    }
}

void Server::Impl::call_back(const sockaddr_in& client) {
    for (const auto& each : connections)
        if (each->is_back() && !each->over() && number_of(each->peer()) == number_of(client) &&
            each->peer().sin_port == client.sin_port)
            return;
    if (core.now - counting >= std::chrono::seconds(1)) {
        counting = core.now;
        requests = 0;
    }
    if (++requests > requests_a_second || !admits(client, "a request")) return;
    connections.push_back(Connection::back(core, client));
}

void Server::Impl::tick() {
    bool wanted = false;
    {
        const std::lock_guard lock(core.mutex);
        if (core.now - ticked >= tick_every) {
            ticked = core.now;
            for (const auto& each : connections) each->tick();
        }
        // Not before: the loop may have had something for them.
        connections.remove_if([](const auto& each) { return each->over(); });
        wanted = std::any_of(connections.begin(), connections.end(),
                             [](const auto& each) { return each->live(); });
    }
    core.devices.tick(core.now, wanted);
}

Server::Server(ServerOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}
Server::~Server() = default;

std::uint16_t Server::port() const {
    return impl_->port;
}
void Server::on_tick(std::function<void()> work) {
    impl_->work = std::move(work);
}
void Server::stop() {
    impl_->stopping = true;
}

void Server::run() {
    Impl& s = *impl_;
    while (!s.stopping) {
        const int pause = s.connections.empty() ? 1000 : static_cast<int>(tick_every.count());
        s.core.loop.wait(pause, s.core.mutex, [&] { s.core.now = std::chrono::steady_clock::now(); });
        s.tick();
        if (s.work) s.work();
    }
}

}  // namespace knurl::vrpn
