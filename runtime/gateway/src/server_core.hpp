#pragma once
// What the server and its connections share. Both are in one thread.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <sys/socket.h>

#include <knurl/gateway/server.hpp>

#include "limited_log.hpp"
#include "sessions.hpp"

namespace knurl::gateway {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

/// Where callers are accepted.
struct Listener {
    Site site;
    std::uint16_t port = 0;
    bool this_host = true;  // what comes here comes from this host; else it speaks TLS and shows a key
    std::vector<std::string> names;  // what Host may say, lower case
    std::string cookie;              // its name
    const char* scheme = "http";
    std::map<const SocketRoute*, std::size_t> open;  // sockets of each route
};

/// A connection, in one of its two lives: requests of HTTP, then perhaps a WebSocket.
class Peer {
  public:
    Peer(std::string host, std::string name) : host_(std::move(host)), peer_(std::move(name)) {}
    virtual ~Peer() = default;
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;

    /// Ends it, now. It is out of Core::peers afterwards.
    virtual void drop() noexcept = 0;
    /// A place may be taken from it: nobody waits for its answer.
    virtual bool may_be_evicted() const = 0;
    virtual bool is_socket() const = 0;
    virtual void tick(Clock::time_point now) = 0;

    const std::string& host() const { return host_; }  // without a port
    const std::string& name() const { return peer_; }
    Clock::time_point since = Clock::now();  // what it does now, it does since then
    Clock::time_point deadline = Clock::time_point::max();

  protected:
    std::string host_, peer_;
};

struct Server::Core {
    explicit Core(ServerOptions given);
    ~Core();

    std::uint16_t listen(const std::string& address, std::uint16_t port, Site site);
    void adopt(int fd, const std::shared_ptr<Listener>& listener, const sockaddr_storage& from);
    void admit(std::shared_ptr<Peer> peer);
    void remove(const Peer* peer) noexcept;
    void log(const std::string& kind, const std::string& line) noexcept;
    void refused(const std::string& kind, const std::string& host, const std::string& line) noexcept;
    void next_tick();
    void tick();

    ServerOptions options;
    LimitedLog limited;
    Sessions sessions;
    std::optional<asio::ssl::context> tls;
    bool has_keys = false;
    std::function<void(Clock::time_point)> on_tick;
    asio::io_context io{1};
    asio::steady_timer timer{io};
    struct Door;
    std::vector<std::shared_ptr<Door>> doors;
    std::map<const Peer*, std::shared_ptr<Peer>> peers;
    std::size_t bodies = 0;  // bytes that are reserved for bodies
    bool stopped = false;

  private:
    bool make_room(const std::string& host);
    void accept(const std::shared_ptr<Door>& door);
    bool accept_one(const std::shared_ptr<Door>& door);
};

/// Begins to serve requests on a connected socket.
void begin_connection(Server::Core& core, std::shared_ptr<Listener> listener, int fd, int family,
                      std::string host, std::string name);

}  // namespace knurl::gateway
