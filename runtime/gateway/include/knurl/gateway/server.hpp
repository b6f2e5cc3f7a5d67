#pragma once

/// @file
/// HTTP/1.1 and WebSocket for all gateways: who may connect, what is bounded, and nothing of what is said. Everything
/// runs in the thread that calls run(): handlers need no locks, and one that waits makes all others wait.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/gateway/socket.hpp>

namespace knurl::gateway {

/// A request whose sender may make it.
struct Request {
    /// "GET" (which includes HEAD), "POST", ...
    std::string method;
    /// Decoded: "/asset/0/3/1".
    std::string path;
    /// Decoded; the last of equal names.
    std::map<std::string, std::string> query;
    /// As the sender says, lower case, without parameters: "application/json".
    std::string content_type;
    /// All of it.
    std::string body;
    /// What the sender may do.
    Role role = Role::observe;
    /// Whose request it is, as Socket::session has it; empty: nobody's.
    std::string session;
    /// Who it is, for messages: "127.0.0.1:40312".
    std::string peer;
};

/// What a request is answered with.
struct Response {
    /// Status code of HTTP.
    unsigned status = 200;
    /// Of the body.
    std::string content_type = "text/plain; charset=utf-8";
    /// The body.
    std::string body{};
    /// In place of `body`: memory that outlives the server.
    std::string_view fixed{};
    /// The same, compressed by gzip, for senders that take it; empty: there is none.
    std::string_view fixed_gzip{};
    /// A name of this content, without quotes; a sender that has it already is told so (304). Empty: has no name.
    std::string etag{};
    /// How long it may be kept. With an etag "no-cache" (asks each time) is the better one.
    std::string cache_control = "no-store";
};

/// Who may use a route.
struct Access {
    /// The least role.
    Role needs = Role::observe;
    /// Role of a caller on this host that shows neither session nor key; none: such a caller is refused. A caller from
    /// another host always needs a key.
    std::optional<Role> without_key{};
    /// Origins of other pages that may use it too ("https://app.foxglove.dev"). The page's own always may, and who sends
    /// none is no page.
    std::vector<std::string> origins{};
};

/// What answers requests of HTTP.
struct HttpRoute {
    /// "GET" or "POST".
    std::string method;
    /// The path; with a * at its end, every path that begins so. The longest that fits is taken.
    std::string path;
    /// Who may.
    Access access{};
    /// Longest body (bytes).
    std::size_t most_body = 64 * 1024;
    /// Answers. Where it throws, the answer is 500, and the connection ends.
    std::function<Response(const Request&)> answer;
};

/// What a path is as a WebSocket.
struct SocketRoute {
    /// The path.
    std::string path;
    /// Of these the peer must ask for one, and gets the first that it asks for. Empty: it needs none.
    std::vector<std::string> subprotocols{};
    /// Who may.
    Access access{};
    /// Longest message that the peer may send (bytes).
    std::size_t most_message = std::size_t{1} << 20;
    /// Most that are open at a time: one protocol does not use up the places of the others.
    std::size_t most_sockets = 16;
    /// Makes the handler; null: the socket is closed with 1013 (try again later).
    MakeHandler make;
};

/// What one port has.
struct Site {
    /// Requests.
    std::vector<HttpRoute> http{};
    /// WebSockets.
    std::vector<SocketRoute> sockets{};
    /// GET / takes ?token= (on this host) and ?key=, and begins a session. Each site has sessions of its own name, and
    /// they are valid on all.
    bool login = false;
    /// Further names of this host that may stand in a request: "lab.example" (with the site's port), "localhost:9000".
    std::vector<std::string> hosts{};
    /// The program's option that says where it listens, for messages.
    std::string option = "--listen";
};

/// What is bounded, and how.
struct ServerOptions {
    /// Certificate chain and private key (PEM): what is not of this host speaks TLS.
    std::filesystem::path certificate{}, private_key{};
    /// Keys of a bridge (`knurl-bridge keygen`): who may connect from other hosts, in which role.
    std::filesystem::path keys{};
    /// Connections at a time; of one address.
    std::size_t most_connections = 128, most_of_address = 64;
    /// Bytes of a request before its body.
    std::size_t most_head = 8 * 1024;
    /// Bytes of bodies that are being read, all together.
    std::size_t most_bodies = std::size_t{128} << 20;
    /// Bytes that wait to be read by the peer of a socket.
    std::size_t most_waiting = std::size_t{4} << 20;
    /// Sessions at a time; a further one ends the one that was idle longest.
    std::size_t most_sessions = 64;
    /// A session, and a token, ends when it was not used for this long.
    std::chrono::seconds session_idle = std::chrono::hours(12);
    /// A request must be there, and an answer be taken, in this time; a second more for each MiB.
    std::chrono::milliseconds request_time = std::chrono::seconds(10);
    /// A connection that asks for nothing more ends after this.
    std::chrono::milliseconds idle_time = std::chrono::seconds(30);
    /// A socket whose peer answers no ping ends after this.
    std::chrono::milliseconds silence = std::chrono::seconds(20);
    /// A peer that has not taken part in closing ends after this.
    std::chrono::milliseconds closing_time = std::chrono::seconds(3);
    /// Takes one line for a log, without a line end. At most one a second of each kind comes.
    std::function<void(const std::string&)> log{};
};

/// The server.
class Server {
  public:
    /// Period of ticks.
    static constexpr std::chrono::nanoseconds tick_period{1'000'000'000 / 60};

    /// Throws std::runtime_error, one line: a file of `options` cannot be used.
    explicit Server(ServerOptions options = {});
    /// Closes everything; the handlers end.
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// Listens at an address in digits, or "localhost". Port 0: any that is free. Returns the port. Throws
    /// std::runtime_error, one line: it is taken, or it is not this host's own and certificate or keys are missing.
    std::uint16_t listen(const std::string& address, std::uint16_t port, Site site);
    /// Serves a connection that was accepted elsewhere, as one of this host to `port`; owns `fd`, a stream socket.
    void serve(int fd, std::uint16_t port, const Site& site);

    /// Called 60 times a second, before the sockets' ticks.
    void on_tick(std::function<void(std::chrono::steady_clock::time_point now)> call);
    /// Calls it in the server's thread. Any thread may.
    void post(std::function<void()> call);
    /// Serves until stop().
    void run();
    /// Serves what is there now, without waiting. Returns how many steps there were.
    std::size_t poll();
    /// Ends run(). Any thread may; a signal handler may not.
    void stop();

    /// A token that GET /?token= takes once, for a session of this role. The one before is void.
    std::string new_token(Role role = Role::control);
    /// Reads the file of keys again. Sessions and sockets of keys that are not in it any more end. Throws
    /// std::runtime_error, one line: it cannot be used, and the keys stay as they were.
    void read_keys_again();
    /// WebSockets that are open.
    std::size_t sockets() const;

    /// What server.cpp has.
    struct Core;

  private:
    std::unique_ptr<Core> core_;
};

/// A file that GET serves.
struct StaticFile {
    /// "/app.js"; "/index.html" is "/" as well.
    std::string_view path;
    /// Its type.
    std::string_view content_type;
    /// A name of its content.
    std::string_view etag;
    /// Its content, for as long as the server lives.
    std::string_view content;
    /// The same, compressed; empty: not compressed.
    std::string_view gzip;
};

/// The route of a file.
HttpRoute route_of(const StaticFile& file, const Access& access);

}  // namespace knurl::gateway
