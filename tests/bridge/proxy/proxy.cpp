#include "proxy.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <list>
#include <mutex>
#include <queue>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/shm/fd.hpp>

namespace knurl::bridge::proxy {

using shm::UniqueFd;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::size_t max_datagrams_waiting = 65536;
constexpr std::size_t max_stream_bytes_waiting = 1 << 20;  // in one direction: then its sender waits
constexpr std::size_t max_flows = 512;
constexpr std::size_t piece_bytes = 16 * 1024;

[[noreturn]] void refuse(const std::string& what) {
    throw std::runtime_error("proxy: " + what + ": " + std::generic_category().message(errno));
}

sockaddr_in address_of(const std::string& host, std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    if (::inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1)
        throw std::runtime_error("proxy: '" + host + "' is no IPv4 address");
    return address;
}

const sockaddr* generic(const sockaddr_in& address) {
    return reinterpret_cast<const sockaddr*>(&address);
}

UniqueFd make_socket(int type, const sockaddr_in& address) {
    UniqueFd fd(::socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    // For TCP it ignores connections that were closed a moment ago. For UDP it would share the port.
    const int on = 1;
    if (type == SOCK_STREAM) ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (!fd || ::bind(fd.get(), generic(address), sizeof address) != 0) return UniqueFd();
    return fd;
}

struct Waiting {
    double due;
    std::uint64_t order;  // among those that are due at the same time
    Way way;
    std::uint32_t flow;
    std::vector<char> bytes;
    bool operator<(const Waiting& other) const {
        return due != other.due ? due > other.due : order > other.order;
    }
};

/// One client's UDP port, with a separate port on the other side.
struct Flow {
    sockaddr_in client;
    UniqueFd upstream;
    std::uint64_t seen[2] = {};
};

struct Piece {
    double due;
    std::vector<char> bytes;
    std::size_t written = 0;
};

struct Stream {  // one way of a connection
    std::deque<Piece> pieces;
    std::size_t waiting = 0;
    std::uint64_t seen = 0;
    double last_due = 0;
    bool ended = false, told = false;
};

struct Connection {
    UniqueFd ends[2];  // the client's, the server's
    Stream ways[2];    // read from ends[way], written to ends[1 - way]
    std::uint32_t flow = 0;
};

}  // namespace

struct Proxy::Impl {
    sockaddr_in to;
    std::uint64_t seed;
    std::function<void(Way, At, std::span<const char>)> overhear;
    UniqueFd tcp, udp, wake;
    std::uint16_t port = 0;
    Clock::time_point start = Clock::now();

    mutable std::mutex mutex;  // data that the other thread may read
    NetworkProfile profile;
    Counts counts;
    bool is_cut = false, hang_up = false, stop = false;

    std::vector<Flow> flows;
    std::priority_queue<Waiting> waiting;
    std::uint64_t order = 0;
    std::list<Connection> connections;
    std::uint32_t connection_number = 0;
    std::thread thread;

    double now() const { return std::chrono::duration<double>(Clock::now() - start).count(); }
    void run();
    void datagrams_from_clients();
    void datagrams_from_server(std::uint32_t flow);
    void take(Way way, std::uint32_t flow, const char* bytes, std::size_t size);
    void deliver();
    std::uint32_t flow_of(const sockaddr_in& client);
    void accept();
    bool read(Connection& connection, Way way);
    bool write(Connection& connection, Way way);
};

Proxy::Proxy(const Options& options) : impl_(std::make_unique<Impl>()) {
    Impl& self = *impl_;
    self.to = address_of(options.to, options.to_port);
    self.seed = options.seed;
    self.overhear = options.overhear;
    self.profile = options.profile;
    // A port that is free for TCP may be taken for UDP: if any port will do, the next one may be free for
    // both.
    for (int tries = options.port == 0 ? 16 : 1; tries > 0 && !self.udp; --tries) {
        sockaddr_in here = address_of(options.listen, options.port);
        self.tcp = make_socket(SOCK_STREAM, here);
        socklen_t bytes = sizeof here;
        if (!self.tcp || ::listen(self.tcp.get(), 64) != 0) refuse("cannot listen");
        ::getsockname(self.tcp.get(), reinterpret_cast<sockaddr*>(&here), &bytes);
        self.udp = make_socket(SOCK_DGRAM, here);
        self.port = ntohs(here.sin_port);
    }
    if (!self.udp) refuse("cannot listen for datagrams");
    self.wake = UniqueFd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
    self.thread = std::thread([&self] { self.run(); });
}

Proxy::~Proxy() {
    {
        const std::lock_guard lock(impl_->mutex);
        impl_->stop = true;
    }
    ::eventfd_write(impl_->wake.get(), 1);
    impl_->thread.join();
}

std::uint16_t Proxy::port() const noexcept {
    return impl_->port;
}
void Proxy::set(const NetworkProfile& profile) {
    const std::lock_guard lock(impl_->mutex);
    impl_->profile = profile;
}
void Proxy::cut() {
    const std::lock_guard lock(impl_->mutex);
    impl_->is_cut = true;
}
void Proxy::heal() {
    const std::lock_guard lock(impl_->mutex);
    impl_->is_cut = false;
    ::eventfd_write(impl_->wake.get(), 1);
}
void Proxy::hang_up() {
    const std::lock_guard lock(impl_->mutex);
    impl_->hang_up = true;
    ::eventfd_write(impl_->wake.get(), 1);
}
Counts Proxy::counts() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->counts;
}

void Proxy::Impl::run() {
    ::prctl(PR_SET_TIMERSLACK, 1UL);  // ns: otherwise a delay of 1 ms becomes 1.05
    std::vector<pollfd> fds;
    while (true) {
        fds.clear();
        fds.push_back({.fd = wake.get(), .events = POLLIN, .revents = 0});
        fds.push_back({.fd = udp.get(), .events = POLLIN, .revents = 0});
        fds.push_back({.fd = tcp.get(), .events = POLLIN, .revents = 0});
        timespec sleep{};
        {
            const std::lock_guard lock(mutex);
            if (stop) return;
            for (const Flow& flow : flows)
                fds.push_back({.fd = flow.upstream.get(), .events = POLLIN, .revents = 0});
            double due = waiting.empty() ? 1e9 : waiting.top().due;
            for (const Connection& c : connections)
                for (int way = 0; way < 2; ++way) {
                    const Stream& stream = c.ways[way];
                    const bool reads = !is_cut && !stream.ended && stream.waiting < max_stream_bytes_waiting;
                    const bool blocked = !stream.pieces.empty() && stream.pieces.front().written > 0;
                    if (!is_cut && !blocked && !stream.pieces.empty())
                        due = std::min(due, stream.pieces.front().due);
                    // Only wanted sources: poll() reports a hang-up repeatedly, whether requested or not.
                    if (reads) fds.push_back({.fd = c.ends[way].get(), .events = POLLIN, .revents = 0});
                    // A partial write waits for room.
                    if (blocked && !is_cut)
                        fds.push_back({.fd = c.ends[1 - way].get(), .events = POLLOUT, .revents = 0});
                }
            const double wait = std::clamp(due - now(), 0.0, 0.1);
            sleep.tv_nsec = static_cast<long>(wait * 1e9);
        }
        ::ppoll(fds.data(), fds.size(), &sleep, nullptr);
        const std::lock_guard lock(mutex);
        eventfd_t nothing;
        ::eventfd_read(wake.get(), &nothing);
        if (hang_up) {
            for (Connection& c : connections)
                for (UniqueFd& end : c.ends) {
                    const linger reset{.l_onoff = 1, .l_linger = 0};
                    ::setsockopt(end.get(), SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
                }
            connections.clear();
            hang_up = false;
        }
        datagrams_from_clients();
        for (std::uint32_t i = 0; i < flows.size(); ++i) datagrams_from_server(i);
        deliver();
        if (is_cut) continue;
        accept();
        connections.remove_if([&](Connection& c) {
            return !read(c, Way::forth) || !read(c, Way::back) || !write(c, Way::forth) ||
                   !write(c, Way::back);
        });
    }
}

std::uint32_t Proxy::Impl::flow_of(const sockaddr_in& client) {
    const auto found = std::find_if(flows.begin(), flows.end(), [&](const Flow& flow) {
        return flow.client.sin_port == client.sin_port &&
               flow.client.sin_addr.s_addr == client.sin_addr.s_addr;
    });
    if (found != flows.end()) return static_cast<std::uint32_t>(found - flows.begin());
    if (flows.size() == max_flows) return max_flows;
    UniqueFd upstream(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    ::connect(upstream.get(), generic(to), sizeof to);
    flows.push_back({.client = client, .upstream = std::move(upstream)});
    return static_cast<std::uint32_t>(flows.size() - 1);
}

void Proxy::Impl::datagrams_from_clients() {
    std::array<char, 65536> bytes;
    for (int n = 0; n < 1000; ++n) {
        sockaddr_in from{};
        socklen_t size = sizeof from;
        const ssize_t got =
            ::recvfrom(udp.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
        if (got < 0) return;
        const std::uint32_t flow = flow_of(from);
        if (flow < max_flows) take(Way::forth, flow, bytes.data(), static_cast<std::size_t>(got));
    }
}

void Proxy::Impl::datagrams_from_server(std::uint32_t flow) {
    std::array<char, 65536> bytes;
    for (int n = 0; n < 1000; ++n) {
        const ssize_t got = ::recv(flows[flow].upstream.get(), bytes.data(), bytes.size(), 0);
        if (got < 0) return;  // nothing, or the server's port is closed
        take(Way::back, flow, bytes.data(), static_cast<std::size_t>(got));
    }
}

void Proxy::Impl::take(Way way, std::uint32_t flow, const char* bytes, std::size_t size) {
    const auto w = static_cast<std::size_t>(way);
    const double at = now();
    if (overhear) overhear(way, At::entry, {bytes, size});
    // The n-th datagram keeps its fate across a cut.
    const Fate fate = fate_of(profile, seed, way, flow, flows[flow].seen[w]++, at);
    ++counts.datagrams[w];
    // A sum, since the two directions' datagrams come in any order.
    counts.fates += (flows[flow].seen[w] * 2 + w + 1) * (static_cast<std::uint64_t>(fate.copies) + 1);
    if (fate.copies == 0 || is_cut || waiting.size() + 2 > max_datagrams_waiting) {
        ++counts.lost[w];
        return;
    }
    counts.doubled[w] += fate.copies == 2;
    for (int copy = 0; copy < fate.copies; ++copy)
        waiting.push({.due = at + fate.delays[copy],
                      .order = order++,
                      .way = way,
                      .flow = flow,
                      .bytes = std::vector<char>(bytes, bytes + size)});
}

void Proxy::Impl::deliver() {
    while (!waiting.empty() && waiting.top().due <= now()) {
        const Waiting& datagram = waiting.top();
        const auto w = static_cast<std::size_t>(datagram.way);
        const Flow& flow = flows[datagram.flow];
        if (overhear && !is_cut) overhear(datagram.way, At::exit, datagram.bytes);
        if (is_cut)
            ++counts.lost[w];
        else if (datagram.way == Way::forth)
            ::send(flow.upstream.get(), datagram.bytes.data(), datagram.bytes.size(), MSG_NOSIGNAL);
        else
            ::sendto(udp.get(), datagram.bytes.data(), datagram.bytes.size(), MSG_NOSIGNAL,
                     generic(flow.client), sizeof flow.client);
        counts.delivered[w] += !is_cut;
        waiting.pop();
    }
}

void Proxy::Impl::accept() {
    for (int n = 0; n < 16; ++n) {
        UniqueFd client(::accept4(tcp.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        if (!client) return;
        UniqueFd server(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
        const int on = 1;
        ::setsockopt(client.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        ::setsockopt(server.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        if (::connect(server.get(), generic(to), sizeof to) != 0 && errno != EINPROGRESS) continue;
        Connection& c = connections.emplace_back();
        c.ends[0] = std::move(client);
        c.ends[1] = std::move(server);
        c.flow = connection_number++;
        ++counts.connections;
    }
}

/// False: the connection is over.
bool Proxy::Impl::read(Connection& c, Way way) {
    const auto w = static_cast<std::size_t>(way);
    Stream& stream = c.ways[w];
    while (!stream.ended && stream.waiting < max_stream_bytes_waiting) {
        std::vector<char> bytes(piece_bytes);
        const ssize_t got = ::recv(c.ends[w].get(), bytes.data(), bytes.size(), 0);
        if (got < 0) return errno == EAGAIN || errno == EINTR || errno == ENOTCONN;
        if (got == 0) {
            stream.ended = true;
            break;
        }
        bytes.resize(static_cast<std::size_t>(got));
        const double at = now();
        const double due =
            std::max(stream.last_due, at + stream_delay(profile, seed, way, c.flow, stream.seen++, at));
        stream.last_due = due;
        stream.waiting += bytes.size();
        stream.pieces.push_back({.due = due, .bytes = std::move(bytes)});
    }
    return true;
}

bool Proxy::Impl::write(Connection& c, Way way) {
    const auto w = static_cast<std::size_t>(way);
    Stream& stream = c.ways[w];
    const int to_fd = c.ends[1 - w].get();
    while (!stream.pieces.empty() && stream.pieces.front().due <= now()) {
        Piece& piece = stream.pieces.front();
        const ssize_t sent = ::send(to_fd, piece.bytes.data() + piece.written,
                                    piece.bytes.size() - piece.written, MSG_NOSIGNAL);
        if (sent < 0) return errno == EAGAIN || errno == EINTR || errno == ENOTCONN;
        piece.written += static_cast<std::size_t>(sent);
        stream.waiting -= static_cast<std::size_t>(sent);
        if (piece.written < piece.bytes.size()) return true;
        stream.pieces.pop_front();
    }
    if (stream.ended && stream.pieces.empty() && !stream.told) {
        ::shutdown(to_fd, SHUT_WR);
        stream.told = true;
    }
    return !(c.ways[0].told && c.ways[1].told);
}

}  // namespace knurl::bridge::proxy
