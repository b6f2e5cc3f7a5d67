#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/post.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/gateway/server.hpp>

#include "server_core.hpp"
#include "target.hpp"

namespace knurl::gateway {

namespace fs = std::filesystem;

namespace {

constexpr int most_accepts = 16;  // in one go: who is connected has its turn between
constexpr std::chrono::milliseconds accept_pause{100};

std::vector<bridge::Key> keys_from(const fs::path& file) {
    if (file.empty()) return {};
    std::vector<bridge::Key> keys = bridge::read_keys(file);
    if (keys.empty())
        throw std::runtime_error(file.string() +
                                 ": holds no key; knurl-bridge keygen --keys FILE --name NAME adds one");
    return keys;
}

/// Who can read the private key can pretend to be this server.
void require_private(const fs::path& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0)
        throw std::runtime_error(fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno)));
    if ((status.st_mode & 077) != 0)
        throw std::runtime_error(fmt::format("{}: others may read or write this private key; chmod 600 {}",
                                             file.string(), file.string()));
}

std::string openssl_text() {
    const char* reason = ERR_reason_error_string(ERR_peek_last_error());
    ERR_clear_error();
    return reason ? reason : "OpenSSL refuses it";
}

asio::ssl::context tls_from(const ServerOptions& options) {
    if (options.certificate.empty() || options.private_key.empty())
        throw std::runtime_error(
            "a certificate needs its private key and the key its certificate: give both, or none");
    require_private(options.private_key);
    asio::ssl::context context(asio::ssl::context::tls_server);
    SSL_CTX* native = context.native_handle();
    SSL_CTX_set_min_proto_version(native, TLS1_3_VERSION);
    SSL_CTX_set_session_cache_mode(native, SSL_SESS_CACHE_OFF);
    SSL_CTX_set_options(native, SSL_OP_NO_TICKET);
    SSL_CTX_set_num_tickets(native, 0);
    if (SSL_CTX_use_certificate_chain_file(native, options.certificate.c_str()) != 1)
        throw std::runtime_error(
            fmt::format("{}: no certificate chain in PEM: {}", options.certificate.string(), openssl_text()));
    if (SSL_CTX_use_PrivateKey_file(native, options.private_key.c_str(), SSL_FILETYPE_PEM) != 1)
        throw std::runtime_error(fmt::format("{}: no private key in PEM for this certificate: {}",
                                             options.private_key.string(), openssl_text()));
    return context;
}

/// "python3 (pid 4711)"; empty: it is somebody else's, whose open files are hidden.
std::string holder_of(std::uint16_t port) {
    std::vector<std::string> inodes;
    for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
        std::ifstream file(table);
        std::string line;
        const std::string wanted = fmt::format(":{:04X} ", port);
        while (std::getline(file, line)) {
            char local[80]{}, remote[80]{}, state[8]{}, inode[32]{};
            if (std::sscanf(line.c_str(), " %*s %79s %79s %7s %*s %*s %*s %*s %*s %31s", local, remote, state,
                            inode) == 4 &&
                (std::string(local) + ' ').ends_with(wanted) && std::string_view(state) == "0A")
                inodes.push_back(fmt::format("socket:[{}]", inode));
        }
    }
    std::error_code error;
    for (const auto& process : fs::directory_iterator("/proc", error)) {
        const std::string pid = process.path().filename().string();
        if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
        std::error_code hidden;
        for (fs::directory_iterator fd(process.path() / "fd", hidden), end; !hidden && fd != end;
             fd.increment(hidden)) {
            std::error_code gone;
            const std::string target = fs::read_symlink(fd->path(), gone).string();
            if (std::find(inodes.begin(), inodes.end(), target) == inodes.end()) continue;
            std::ifstream comm(process.path() / "comm");
            std::string program;
            std::getline(comm, program);
            return fmt::format("{} (pid {})", program, pid);
        }
    }
    return {};
}

[[noreturn]] void cannot_listen(const std::string& at, std::uint16_t port, const std::string& option,
                                int error) {
    std::string why = std::strerror(error);
    if (error == EADDRINUSE) {
        const std::string holder = holder_of(port);
        why = fmt::format(
            "{} has this port; end it, or give another {}",
            holder.empty() ? "a program of another user (ss -ltnp, as root, says which)" : holder, option);
    } else if (error == EADDRNOTAVAIL) {
        why = fmt::format("this host has no such address; give another {}", option);
    } else if (error == EACCES) {
        why = fmt::format("ports below 1024 are root's; give another {}", option);
    }
    throw std::runtime_error(fmt::format("cannot listen at {}: {}", at, why));
}

int listening_socket(const sockaddr* address, socklen_t length) {
    const int fd = ::socket(address->sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd < 0) return -1;
    const int on = 1;
    ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (address->sa_family == AF_INET6) ::setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
    if (::bind(fd, address, length) == 0 && ::listen(fd, SOMAXCONN) == 0) return fd;
    const int error = errno;
    ::close(fd);
    errno = error;
    return -1;
}

std::vector<std::string> names_of(const Listener& listener, const std::string& address) {
    const std::uint16_t port = listener.port;
    const bool usual = port == (listener.this_host ? 80 : 443);
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        names.push_back(fmt::format("{}:{}", name, port));
        if (usual) names.push_back(name);
    };
    for (const char* name : {"127.0.0.1", "localhost", "[::1]"}) add(name);
    add(address.find(':') == std::string::npos ? address : '[' + address + ']');
    for (const std::string& each : listener.site.hosts) {
        const std::string name = lower(each);
        const std::size_t colon = name.rfind(':');
        if (colon != std::string::npos && name.find(']', colon) == std::string::npos)
            names.push_back(name);
        else
            add(name);
    }
    return names;
}

std::string host_in_digits(const sockaddr_storage& from) {
    char text[INET6_ADDRSTRLEN]{};
    if (from.ss_family == AF_INET)
        ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(from).sin_addr, text, sizeof text);
    else if (from.ss_family == AF_INET6)
        ::inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6&>(from).sin6_addr, text, sizeof text);
    else
        return "local";
    return text;
}

}  // namespace

/// A listening socket.
struct Server::Core::Door {
    Door(asio::io_context& io, int fd, std::shared_ptr<Listener> for_whom)
        : callers(io, fd), pause(io), listener(std::move(for_whom)) {}
    asio::posix::stream_descriptor callers;
    asio::steady_timer pause;
    std::shared_ptr<Listener> listener;
};

Server::Core::Core(ServerOptions given)
    : options(std::move(given)),
      limited(options.log),
      sessions(options.most_sessions, options.session_idle, keys_from(options.keys)) {
    has_keys = !options.keys.empty();
    if (!options.certificate.empty() || !options.private_key.empty()) tls.emplace(tls_from(options));
    next_tick();
}

Server::Core::~Core() {
    stopped = true;
    while (!peers.empty()) peers.begin()->second->drop();
    doors.clear();
}

std::uint16_t Server::Core::listen(const std::string& address, std::uint16_t port, Site site) {
    boost::system::error_code bad;
    const auto parsed = asio::ip::make_address(address == "localhost" ? "127.0.0.1" : address, bad);
    const std::string digits = bad ? address : parsed.to_string();
    const std::string at =
        (digits.find(':') == std::string::npos ? digits : '[' + digits + ']') + ':' + std::to_string(port);
    if (bad)
        throw std::runtime_error(
            fmt::format("cannot listen at {}: give {} an address in digits", at, site.option));
    auto listener = std::make_shared<Listener>();
    listener->this_host = parsed.is_loopback();
    if (!listener->this_host && (!tls || !has_keys))
        throw std::runtime_error(
            fmt::format("cannot listen at {}: whoever reaches it could move the hand, so an address that is "
                        "not this host's own "
                        "(127.0.0.1, [::1]) needs TLS and keys: --tls-certificate and --tls-key, and --keys "
                        "FILE from `knurl-bridge "
                        "keygen`",
                        at));

    sockaddr_storage where{};
    socklen_t length = sizeof(sockaddr_in);
    if (parsed.is_v4()) {
        auto& v4 = reinterpret_cast<sockaddr_in&>(where);
        v4.sin_family = AF_INET;
        v4.sin_port = htons(port);
        v4.sin_addr.s_addr = htonl(parsed.to_v4().to_uint());
    } else {
        auto& v6 = reinterpret_cast<sockaddr_in6&>(where);
        v6.sin6_family = AF_INET6;
        v6.sin6_port = htons(port);
        v6.sin6_scope_id = static_cast<std::uint32_t>(parsed.to_v6().scope_id());
        const auto bytes = parsed.to_v6().to_bytes();
        std::memcpy(&v6.sin6_addr, bytes.data(), bytes.size());
        length = sizeof(sockaddr_in6);
    }
    const int fd = listening_socket(reinterpret_cast<const sockaddr*>(&where), length);
    if (fd < 0) cannot_listen(at, port, site.option, errno);
    ::getsockname(fd, reinterpret_cast<sockaddr*>(&where), &length);
    listener->port = ntohs(parsed.is_v4() ? reinterpret_cast<const sockaddr_in&>(where).sin_port
                                          : reinterpret_cast<const sockaddr_in6&>(where).sin6_port);
    listener->site = std::move(site);
    listener->scheme = listener->this_host ? "http" : "https";
    // Cookies do not belong to a port: a second knurl-web on this host has another name.
    listener->cookie = fmt::format("knurl_{}", listener->port);
    listener->names = names_of(*listener, digits);
    auto door = std::make_shared<Door>(io, fd, listener);
    doors.push_back(door);
    accept(door);
    return listener->port;
}

void Server::Core::accept(const std::shared_ptr<Door>& door) {
    door->callers.async_wait(
        asio::posix::stream_descriptor::wait_read, [this, door](const boost::system::error_code& error) {
            if (error || stopped) return;
            int why = 0;
            try {
                for (int i = 0; i < most_accepts && accept_one(door); ++i) {
                }
                why = errno;
            } catch (const std::bad_alloc&) {
                why = ENOMEM;
            }
            if (why != EMFILE && why != ENFILE && why != ENOBUFS && why != ENOMEM) return accept(door);
            // The callers stay where they are until a descriptor is free: looked for again soon,
            // not at once.
            log("accept", fmt::format("cannot take another connection: {}", std::strerror(why)));
            door->pause.expires_after(accept_pause);
            door->pause.async_wait([this, door](const boost::system::error_code& ended) {
                if (!ended && !stopped) accept(door);
            });
        });
}

/// False: nobody else waits, or errno says why there is no further one.
bool Server::Core::accept_one(const std::shared_ptr<Door>& door) {
    sockaddr_storage from{};
    socklen_t length = sizeof from;
    const int fd = ::accept4(door->callers.native_handle(), reinterpret_cast<sockaddr*>(&from), &length,
                             SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) {
        if (errno != ECONNABORTED && errno != EINTR) return false;
        errno = 0;
        return true;
    }
    adopt(fd, door->listener, from);
    errno = 0;
    return true;
}

void Server::Core::adopt(int fd, const std::shared_ptr<Listener>& listener, const sockaddr_storage& from) {
    const std::string host = host_in_digits(from);
    if (!make_room(host)) {
        constexpr std::string_view full =
            "HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 37\r\n\r\n"
            "all connections are taken; try again\n";
        if (listener->this_host) [[maybe_unused]]
            const ssize_t sent = ::send(fd, full.data(), full.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        ::close(fd);
        refused("full", host, fmt::format("{}: all connections are taken", host));
        return;
    }
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    // What a slow peer has not read waits here, where newer replaces it, and not in the kernel.
    const int unsent = 64 * 1024;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
    std::string name =
        from.ss_family == AF_UNIX || from.ss_family == AF_UNSPEC ? "local" : bridge::numeric(from);
    int family = AF_INET;
    socklen_t size = sizeof family;
    ::getsockopt(fd, SOL_SOCKET, SO_DOMAIN, &family, &size);
    try {
        begin_connection(*this, listener, fd, family, host, std::move(name));
    } catch (const std::exception& error) {
        log("connection", fmt::format("{}: {}", host, error.what()));
    }
}

/// There is a place for a connection of that host. A full server ends the connection that has asked for nothing for the
/// longest time: nobody can hold all places by doing nothing. Sockets stay.
bool Server::Core::make_room(const std::string& host) {
    const auto of_host = static_cast<std::size_t>(std::count_if(
        peers.begin(), peers.end(), [&](const auto& each) { return each.second->host() == host; }));
    const bool host_full = of_host >= options.most_of_address;
    if (!host_full && peers.size() < options.most_connections) return true;
    std::shared_ptr<Peer> oldest;
    for (const auto& [key, each] : peers) {
        if (!each->may_be_evicted() || (host_full && each->host() != host)) continue;
        if (!oldest || each->since < oldest->since) oldest = each;
    }
    if (!oldest) return false;
    oldest->drop();
    return true;
}

void Server::Core::admit(std::shared_ptr<Peer> peer) {
    const Peer* key = peer.get();
    peers.emplace(key, std::move(peer));
}

void Server::Core::remove(const Peer* peer) noexcept {
    peers.erase(peer);
}

void Server::Core::log(const std::string& kind, const std::string& line) noexcept try {
    limited.say(kind, line, Clock::now());
} catch (...) {
    // A log that cannot be written changes nothing for those who are served.
}

void Server::Core::refused(const std::string& kind, const std::string& host, const std::string& line) noexcept
    try {
    limited.refused(kind, host, line, Clock::now());
} catch (...) {
}

void Server::Core::next_tick() {
    timer.async_wait([this](const boost::system::error_code& error) {
        if (error || stopped) return;
        // After a standstill the ticks that were missed do not follow.
        timer.expires_at(std::max(timer.expiry() + tick_period, Clock::now()));
        next_tick();
        tick();
    });
}

void Server::Core::tick() {
    const Clock::time_point now = Clock::now();
    if (on_tick) try {
            on_tick(now);
        } catch (const std::exception& error) {
            log("tick", error.what());
        } catch (...) {
            log("tick", "an unknown exception in a tick");
        }
    std::vector<std::shared_ptr<Peer>> all;  // one may end others
    for (const auto& [key, each] : peers) all.push_back(each);
    for (const auto& each : all) {
        if (!peers.contains(each.get())) continue;
        if (now > each->deadline)
            each->drop();
        else
            each->tick(now);
    }
}

Server::Server(ServerOptions options) : core_(std::make_unique<Core>(std::move(options))) {}
Server::~Server() = default;

std::uint16_t Server::listen(const std::string& address, std::uint16_t port, Site site) {
    return core_->listen(address, port, std::move(site));
}

void Server::serve(int fd, std::uint16_t port, const Site& site) {
    auto listener = std::make_shared<Listener>();
    listener->port = port;
    listener->site = site;
    listener->cookie = fmt::format("knurl_{}", port);
    listener->names = names_of(*listener, "127.0.0.1");
    ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
    core_->adopt(fd, listener, {});
}

void Server::on_tick(std::function<void(Clock::time_point)> call) {
    core_->on_tick = std::move(call);
}

void Server::post(std::function<void()> call) {
    asio::post(core_->io, std::move(call));
}

void Server::run() {
    core_->timer.expires_at(Clock::now());  // of the time before run() no ticks follow
    core_->next_tick();
    core_->io.restart();
    for (;;) {
        try {
            core_->io.run();
            return;
        } catch (const std::exception& error) {
            // The connection whose step threw has ended with the step.
            core_->log("step", error.what());
        } catch (...) {
            core_->log("step", "an unknown exception");
        }
    }
}

std::size_t Server::poll() {
    core_->io.restart();
    return core_->io.poll();
}

void Server::stop() {
    asio::post(core_->io, [core = core_.get()] { core->io.stop(); });
}

std::string Server::new_token(Role role) {
    return core_->sessions.new_token(role, Clock::now());
}

void Server::read_keys_again() {
    core_->sessions.admit(keys_from(core_->options.keys));
}

std::size_t Server::sockets() const {
    return static_cast<std::size_t>(std::count_if(core_->peers.begin(), core_->peers.end(),
                                                  [](const auto& each) { return each.second->is_socket(); }));
}

HttpRoute route_of(const StaticFile& file, const Access& access) {
    return {.method = "GET",
            .path = std::string(file.path == "/index.html" ? "/" : file.path),
            .access = access,
            .answer = [file](const Request&) {
                return Response{.content_type = std::string(file.content_type),
                                .fixed = file.content,
                                .fixed_gzip = file.gzip,
                                .etag = std::string(file.etag),
                                .cache_control = "no-cache"};
            }};
}

}  // namespace knurl::gateway
