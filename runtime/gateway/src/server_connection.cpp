// HTTP/1.1 and WebSocket by Boost.Beast, in this file alone: its templates cost as much time to compile as all else here.

#include <algorithm>
#include <array>
#include <deque>
#include <exception>
#include <span>
#include <string>
#include <utility>

#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <fmt/format.h>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/words/printable.hpp>

#include "server_core.hpp"
#include "server_wire.hpp"
#include "target.hpp"

namespace knurl::gateway {

namespace http = beast::http;
namespace websocket = beast::websocket;
using ErrorCode = boost::system::error_code;

namespace {

constexpr std::size_t most_quoted = 100;             // bytes of what a caller has sent, in a message
constexpr std::size_t most_lingering = 1024 * 1024;  // bytes that are read of what nobody wants
constexpr std::size_t read_size = 64 * 1024;

std::string_view view(boost::string_view text) {
    return {text.data(), text.size()};
}

std::string in_quotes(std::string_view said) {
    return '\'' + words::printable(said, most_quoted) + '\'';
}

std::chrono::milliseconds time_for(std::chrono::milliseconds least, std::size_t bytes) {
    return least + std::chrono::seconds(bytes >> 20);
}

std::string_view reason_of(unsigned status) {
    return view(http::obsolete_reason(static_cast<http::status>(status)));
}

/// Refused: the status and one line.
struct Refusal {
    unsigned status = 403;
    std::string line;
    const char* kind = "refused";  // for the log; "": it is the peer's own mistake, and not logged
};

/// A WebSocket.
class Channel final : public Peer, public Socket, public std::enable_shared_from_this<Channel> {
  public:
    using Message = http::request<http::string_body>;

    Channel(Server::Core& core, std::shared_ptr<Listener> listener, const SocketRoute& route, Wire wire,
            Identity identity, std::string subprotocol, std::string host, std::string peer)
        : Peer(std::move(host), std::move(peer)),
          core_(core),
          listener_(std::move(listener)),
          route_(route),
          identity_(std::move(identity)),
          subprotocol_(std::move(subprotocol)),
          ws_(std::move(wire)) {
        ++listener_->open[&route_];
    }
    ~Channel() override { finish(); }

    void start(const Message& request) {
        websocket::stream_base::timeout times{};
        times.handshake_timeout = core_.options.request_time;
        times.idle_timeout = core_.options.silence;
        times.keep_alive_pings = true;
        ws_.set_option(times);
        ws_.set_option(websocket::stream_base::decorator([this](websocket::response_type& response) {
            response.set(http::field::server, "knurl");
            if (!subprotocol_.empty()) response.set(http::field::sec_websocket_protocol, subprotocol_);
        }));
        ws_.read_message_max(route_.most_message);
        ws_.auto_fragment(false);
        ws_.async_accept(request, [self = shared_from_this()](const ErrorCode& error) {
            if (error || self->finished_) return self->finish();
            self->open_ = true;
            self->guarded([&] {
                self->handler_ = self->route_.make(*self, self->subprotocol_);
                if (!self->handler_) self->close(1013, "try again later");
            });
            self->read();
        });
    }

    // Socket
    void send_text(std::string text) override {
        send({.text = true, .bytes = std::move(text), .binary = {}});
    }
    void send_binary(std::vector<std::byte> bytes) override {
        send({.text = false, .bytes = {}, .binary = std::move(bytes)});
    }
    bool idle() const override { return queue_.empty(); }
    void close(std::uint16_t code, std::string reason) override {
        if (closing_ || finished_) return;
        closing_ = true;
        constexpr std::size_t most_reason = 123;  // RFC 6455, 5.5
        reason.resize(std::min(reason.size(), most_reason));
        reason_ = websocket::close_reason(static_cast<websocket::close_code>(code), reason);
        deadline = Clock::now() + core_.options.closing_time;
        if (queue_.empty()) begin_close();
    }
    Role role() const override { return identity_.role; }
    const std::string& peer() const override { return peer_; }
    std::string session() const override { return identity_.session; }

    // Peer
    void drop() noexcept override { finish(); }
    bool may_be_evicted() const override { return false; }
    bool is_socket() const override { return open_; }
    void tick(Clock::time_point now) override {
        core_.sessions.touch(identity_.session, now);
        if (!core_.sessions.stands(identity_)) close(1008, "its key is not admitted any more");
        if (handler_ && open_ && !closing_) guarded([&] { handler_->tick(now); });
    }

  private:
    struct Outgoing {
        bool text = false;
        std::string bytes;
        std::vector<std::byte> binary;
        std::size_t size() const { return text ? bytes.size() : binary.size(); }
    };

    void send(Outgoing message) {
        if (!open_ || closing_ || finished_) return;
        if (!queue_.empty() && waiting_ + message.size() > core_.options.most_waiting) {
            // What waits is given up; the message that is on its way cannot be.
            core_.refused("slow", host_,
                          fmt::format("{}: reads too slowly, {} bytes wait: closed", peer_, waiting_));
            while (queue_.size() > 1) {
                waiting_ -= queue_.back().size();
                queue_.pop_back();
            }
            return close(1008, "reads too slowly");
        }
        waiting_ += message.size();
        queue_.push_back(std::move(message));
        if (queue_.size() == 1) write();
    }

    void write() {
        const Outgoing& next = queue_.front();
        ws_.text(next.text);
        const auto written = [self = shared_from_this()](const ErrorCode& error, std::size_t) {
            if (error || self->finished_) return self->finish();
            self->waiting_ -= self->queue_.front().size();
            self->queue_.pop_front();
            if (!self->queue_.empty())
                self->write();
            else if (self->closing_)
                self->begin_close();
        };
        ws_.async_write(next.text ? asio::buffer(next.bytes) : asio::buffer(next.binary), written);
    }

    void begin_close() {
        ws_.async_close(reason_, [self = shared_from_this()](const ErrorCode&) { self->finish(); });
    }

    void read() {
        if (closing_ || finished_) return;  // closing reads what still comes
        ws_.async_read(inbox_, [self = shared_from_this()](const ErrorCode& error, std::size_t) {
            if (self->closing_ && !self->finished_) return;  // finished by whoever closes
            if (error) return self->ended(error);
            self->guarded([&] {
                const auto data = self->inbox_.data();
                const std::string_view bytes(static_cast<const char*>(data.data()), data.size());
                if (!self->handler_) return;
                if (self->ws_.got_text())
                    self->handler_->text(bytes);
                else
                    self->handler_->binary(std::as_bytes(std::span(bytes)));
            });
            self->inbox_.consume(self->inbox_.size());
            self->inbox_.shrink_to_fit();
            self->read();
        });
    }

    void ended(const ErrorCode& error) {
        if (error == websocket::error::message_too_big)
            core_.refused(
                "message", host_,
                fmt::format("{}: a message of more than {} bytes: closed", peer_, route_.most_message));
        finish();
    }

    /// A handler that throws loses its own socket only.
    template <class Work>
    void guarded(Work work) {
        try {
            work();
            return;
        } catch (const std::exception& error) {
            core_.log("handler", fmt::format("{}: {} failed: {}", peer_, route_.path,
                                             words::printable(error.what(), 300)));
        } catch (...) {
            core_.log("handler", fmt::format("{}: {} failed", peer_, route_.path));
        }
        handler_.reset();
        close(1011, "internal error");
    }

    void finish() noexcept {
        if (finished_) return;
        finished_ = true;
        open_ = false;
        if (auto found = listener_->open.find(&route_); found != listener_->open.end() && found->second > 0)
            --found->second;
        ws_.next_layer().close();
        const auto self = weak_from_this().lock();  // stays until the end of this function
        core_.remove(this);
        handler_.reset();
    }

    Server::Core& core_;
    std::shared_ptr<Listener> listener_;
    const SocketRoute& route_;  // of listener_
    Identity identity_;
    std::string subprotocol_;
    websocket::stream<Wire, false> ws_;
    beast::flat_buffer inbox_;
    std::unique_ptr<SocketHandler> handler_;
    std::deque<Outgoing> queue_;  // the first is being written
    std::size_t waiting_ = 0;     // its bytes
    websocket::close_reason reason_;
    bool open_ = false, closing_ = false, finished_ = false;
};

/// Requests of HTTP, one after another.
class Connection final : public Peer, public std::enable_shared_from_this<Connection> {
    /// A completion: ends the connection on an error, or if `next` throws.
    template <class Next>
    auto step(Next next) {
        return [self = shared_from_this(), next](const ErrorCode& error, std::size_t bytes = 0) {
            if (error || self->finished_) return self->failed(error);
            self->guarded([&] { next(*self, bytes); });
        };
    }

  public:
    Connection(Server::Core& core, std::shared_ptr<Listener> listener, int fd, int family, std::string host,
               std::string peer)
        : Peer(std::move(host), std::move(peer)),
          core_(core),
          listener_(std::move(listener)),
          wire_(core.io, listener_->this_host ? nullptr : &*core.tls),
          buffer_(std::max(read_size, core.options.most_head)) {
        wire_.plain().assign(asio::generic::stream_protocol(family, 0), fd);
    }
    ~Connection() override { finish(); }

    void start() {
        deadline = Clock::now() + core_.options.request_time;
        if (!wire_.secret()) return wait();
        wire_.tls().async_handshake(asio::ssl::stream_base::server,
                                    step([](Connection& self, std::size_t) { self.wait(); }));
    }

    void drop() noexcept override { finish(); }
    bool may_be_evicted() const override { return state_ != State::answers; }
    bool is_socket() const override { return false; }
    void tick(Clock::time_point) override {}

  private:
    enum class State { waits, reads, answers, lingers };
    using Parser = http::request_parser<http::string_body>;

    template <class Work>
    void guarded(Work work) {
        try {
            work();
        } catch (const std::exception& error) {
            core_.log("connection", fmt::format("{}: {}", peer_, words::printable(error.what(), 300)));
            finish();
        } catch (...) {
            core_.log("connection", peer_ + ": failed");
            finish();
        }
    }

    /// Waits for the first byte of a request.
    void wait() {
        state_ = State::waits;
        since = Clock::now();
        parser_.emplace();
        parser_->header_limit(static_cast<std::uint32_t>(core_.options.most_head));
        parser_->body_limit(std::uint64_t{1} << 40);  // a route's own limit is looked at when it is known
        if (buffer_.size() > 0) return read();
        wire_.async_read_some(buffer_.prepare(read_size), step([](Connection& self, std::size_t bytes) {
                                  self.buffer_.commit(bytes);
                                  self.read();
                              }));
    }

    void read() {
        state_ = State::reads;
        deadline = Clock::now() + core_.options.request_time;
        http::async_read_header(wire_, buffer_, *parser_,
                                [self = shared_from_this()](const ErrorCode& error, std::size_t) {
                                    if (self->finished_) return;
                                    self->guarded([&] { self->head(error); });
                                });
    }

    void head(const ErrorCode& error) {
        if (error == http::error::header_limit || error == http::error::buffer_overflow)
            return refuse(
                {431, fmt::format("a request has at most {} bytes before its body", core_.options.most_head),
                 "head"});
        if (error == http::error::body_limit) return refuse({413, "no body is as long as that here", "body"});
        if (error == http::error::end_of_stream || error == http::error::partial_message ||
            (error && !is_http(error)))
            return finish();
        if (error) return refuse({400, "this is no HTTP/1.1: " + error.message(), "head"});
        if (auto refusal = look()) return refuse(*refusal);
    }

    static bool is_http(const ErrorCode& error) {
        return error.category() == http::make_error_code(http::error::end_of_stream).category();
    }

    /// Decides about a request whose header is there.
    std::optional<Refusal> look() {
        const auto& request = parser_->get();
        if (request.version() != 11) return Refusal{505, "give HTTP/1.1", "head"};
        if (auto refusal = foreign_host()) return refusal;
        auto target = parse_target(view(request.target()));
        if (!target)
            return Refusal{
                400, "the address is none: a path that begins with /, with %xx for what is no letter", ""};
        target_ = std::move(*target);
        if (request.count(http::field::upgrade) > 0) return look_at_upgrade();
        return look_at_request();
    }

    /// A page of another name that leads here (DNS rebinding) says its own name in Host.
    std::optional<Refusal> foreign_host() {
        const auto& request = parser_->get();
        if (request.count(http::field::host) != 1) return Refusal{400, "a request has one Host", "head"};
        const std::string host = lower(view(request[http::field::host]));
        if (std::find(listener_->names.begin(), listener_->names.end(), host) != listener_->names.end())
            return {};
        if (!host.empty() && host == own_address()) return {};
        return Refusal{403,
                       fmt::format("Host {} is not a name of this server; start it with --host NAME if it is",
                                   in_quotes(host)),
                       "host"};
    }

    /// Where this connection arrived, of a listener at all addresses of the host.
    std::string own_address() {
        if (listener_->this_host) return {};
        sockaddr_storage address{};
        socklen_t length = sizeof address;
        if (::getsockname(wire_.plain().native_handle(), reinterpret_cast<sockaddr*>(&address), &length) != 0)
            return {};
        return bridge::numeric(address);
    }

    std::optional<Refusal> foreign_origin(const Access& access) {
        const auto& request = parser_->get();
        const std::size_t count = request.count(http::field::origin);
        allowed_origin_.clear();
        if (count == 0) return {};
        const std::string_view origin = view(request[http::field::origin]);
        if (count == 1) {
            if (lower(origin) ==
                fmt::format("{}://{}", listener_->scheme, lower(view(request[http::field::host]))))
                return {};
            for (const std::string& each : access.origins)
                if (lower(origin) == lower(each)) {
                    allowed_origin_ = each;
                    return {};
                }
        }
        return Refusal{
            403,
            fmt::format("Origin {} may not use {}; start the server with --allow-origin if it is to",
                        in_quotes(origin), words::printable(target_.path, most_quoted)),
            "origin"};
    }

    std::optional<Identity> by_cookie(Clock::time_point now) {
        return core_.sessions.by_cookie(
            cookie_of(view(parser_->get()[http::field::cookie]), listener_->cookie), now);
    }

    std::optional<Refusal> identify(const Access& access) {
        const auto& request = parser_->get();
        const auto now = Clock::now();
        std::optional<Identity> found;
        const std::string_view authorization = view(request[http::field::authorization]);
        if (!authorization.empty()) {
            constexpr std::string_view bearer = "bearer ";
            if (lower(authorization.substr(0, bearer.size())) == bearer)
                found = core_.sessions.by_key(authorization.substr(bearer.size()));
            if (!found)
                return Refusal{401, "Authorization: Bearer KEY takes a key of the keys file (--keys)", "key"};
        }
        if (!found) found = by_cookie(now);
        if (!found && access.without_key && listener_->this_host)
            found = Identity{.role = *access.without_key, .session = {}};
        if (!found)
            return Refusal{
                403,
                listener_->this_host
                    ? "no session: open the address with ?token= that the server printed; it prints another "
                      "on SIGUSR1"
                    : "no session: open this address with ?key=KEY, or send Authorization: Bearer KEY",
                "session"};
        if (found->role < access.needs) {
            constexpr const char* names[] = {"observe", "render", "control"};
            return Refusal{403,
                           fmt::format("your role is {}; this needs {}", names[static_cast<int>(found->role)],
                                       names[static_cast<int>(access.needs)]),
                           "role"};
        }
        identity_ = std::move(*found);
        return {};
    }

    std::optional<Refusal> look_at_upgrade() {
        const auto& request = parser_->get();
        const SocketRoute* route = nullptr;
        for (const SocketRoute& each : listener_->site.sockets)
            if (fits(each.path, target_.path)) route = &each;
        if (!route) return Refusal{404, "no WebSocket is here", ""};
        if (auto refusal = foreign_origin(route->access)) return refusal;
        if (auto refusal = identify(route->access)) return refusal;
        if (!websocket::is_upgrade(request) || parser_->chunked() ||
            parser_->content_length().value_or(0) > 0)
            return Refusal{400, "an upgrade is GET, HTTP/1.1, Upgrade: websocket, without a body", ""};
        if (request.count(http::field::sec_websocket_key) != 1 ||
            request.count(http::field::sec_websocket_version) != 1 ||
            view(request[http::field::sec_websocket_version]) != "13" ||
            request[http::field::sec_websocket_key].size() != 24)
            return Refusal{
                400, "an upgrade has one Sec-WebSocket-Key of 24 characters, and Sec-WebSocket-Version: 13",
                ""};
        std::string agreed;
        for (const auto& field : request)
            if (field.name() == http::field::sec_websocket_protocol)
                for (const std::string_view word : listed(view(field.value())))
                    for (const std::string& known : route->subprotocols)
                        if (agreed.empty() && word == known) agreed = known;
        if (agreed.empty() && !route->subprotocols.empty())
            return Refusal{400,
                           fmt::format("ask for the subprotocol {}", fmt::join(route->subprotocols, " or ")),
                           "subprotocol"};
        if (listener_->open[route] >= route->most_sockets)
            return Refusal{
                503, fmt::format("{} has {} sockets already; close one", route->path, route->most_sockets),
                "full"};
        upgrade(*route, std::move(agreed));
        return {};
    }

    void upgrade(const SocketRoute& route, std::string agreed) {
        const auto request = parser_->release();
        const auto rest = buffer_.data();
        wire_.unread({static_cast<const char*>(rest.data()), rest.size()});
        const auto channel = std::make_shared<Channel>(core_, listener_, route, std::move(wire_),
                                                       std::move(identity_), std::move(agreed), host_, peer_);
        moved_ = true;
        const auto self = shared_from_this();
        finish();  // its place goes to the channel
        core_.admit(channel);
        channel->start(request);
    }

    std::optional<Refusal> look_at_request() {
        const auto& request = parser_->get();
        head_only_ = request.method() == http::verb::head;
        const std::string method = head_only_ ? "GET" : std::string(view(request.method_string()));
        // Not HEAD: whoever previews an address must not use up its token.
        if (method == "GET" && !head_only_ && listener_->site.login && target_.path == "/" &&
            (target_.query.contains("token") || target_.query.contains("key")))
            return login();
        const HttpRoute* route = nullptr;
        std::size_t best = 0;
        bool other_method = false;
        for (const HttpRoute& each : listener_->site.http)
            if (const auto fit = fits(each.path, target_.path)) {
                if (each.method != method) {
                    other_method = true;
                } else if (!route || *fit > best) {
                    route = &each;
                    best = *fit;
                }
            }
        if (!route && other_method) return Refusal{405, method + " is not for this address", ""};
        if (!route) return Refusal{404, "nothing is here", ""};
        if (auto refusal = foreign_origin(route->access)) return refusal;
        if (auto refusal = identify(route->access)) return refusal;
        const std::uint64_t length = parser_->content_length().value_or(0);
        const std::size_t reserve = parser_->chunked() ? route->most_body : static_cast<std::size_t>(length);
        if (length > route->most_body)
            return Refusal{413, fmt::format("a body here has at most {} bytes", route->most_body), "body"};
        if (core_.bodies + reserve > core_.options.most_bodies)
            return Refusal{503, "too many bodies are being read; try again", "full"};
        core_.bodies += reserve;
        reserved_ = reserve;
        parser_->body_limit(route->most_body);
        route_ = route;
        // What somebody known sends is not cut off for callers who ask for nothing.
        if (!identity_.session.empty()) state_ = State::answers;
        deadline = Clock::now() + time_for(core_.options.request_time, reserve);
        if (reserve > 0 && lower(view(request[http::field::expect])) == "100-continue") {
            static constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
            asio::async_write(wire_, asio::buffer(go_on),
                              step([](Connection& self, std::size_t) { self.read_body(); }));
        } else {
            read_body();
        }
        return {};
    }

    void read_body() {
        http::async_read(
            wire_, buffer_, *parser_, [self = shared_from_this()](const ErrorCode& error, std::size_t) {
                if (self->finished_) return;
                self->guarded([&] {
                    if (error == http::error::body_limit)
                        return self->refuse(
                            {413, fmt::format("a body here has at most {} bytes", self->route_->most_body),
                             "body"});
                    if (error && (!is_http(error) || error == http::error::partial_message))
                        return self->finish();
                    if (error)
                        return self->refuse({400, "the body is no HTTP/1.1: " + error.message(), "head"});
                    self->call();
                });
            });
    }

    void call() {
        auto message = parser_->release();
        std::string type(view(message[http::field::content_type]));
        type = lower(type.substr(0, type.find(';')));
        while (type.ends_with(' ')) type.pop_back();
        Request request{.method = head_only_ ? "GET" : std::string(view(message.method_string())),
                        .path = std::move(target_.path),
                        .query = std::move(target_.query),
                        .content_type = std::move(type),
                        .body = std::move(message.body()),
                        .role = identity_.role,
                        .session = identity_.session,
                        .peer = peer_};
        Response response;
        bool keep = message.keep_alive();
        try {
            response = route_->answer(request);
        } catch (const std::exception& error) {
            core_.log("handler", fmt::format("{}: {} failed: {}", peer_, route_->path,
                                             words::printable(error.what(), 300)));
            response = {.status = 500, .body = "internal error\n"};
            keep = false;
        } catch (...) {
            core_.log("handler", fmt::format("{}: {} failed", peer_, route_->path));
            response = {.status = 500, .body = "internal error\n"};
            keep = false;
        }
        const auto has = [&](http::field name, std::string_view wanted) {
            for (const std::string_view each : listed(view(message[name])))
                if (each.substr(0, each.find(';')) == wanted ||
                    (name == http::field::if_none_match && each == "*"))
                    return true;
            return false;
        };
        std::string extra;
        if (!response.etag.empty()) {
            const std::string name = '"' + response.etag + '"';
            extra += "ETag: " + name + "\r\n";
            if (has(http::field::if_none_match, name) || has(http::field::if_none_match, "W/" + name)) {
                response.status = 304;
                response.fixed = response.fixed_gzip = {};
                response.body.clear();
            }
        }
        if (!response.fixed_gzip.empty()) {
            extra += "Vary: Accept-Encoding\r\n";
            if (has(http::field::accept_encoding, "gzip")) {
                response.fixed = response.fixed_gzip;
                extra += "Content-Encoding: gzip\r\n";
            }
        }
        if (!allowed_origin_.empty())
            extra += "Access-Control-Allow-Origin: " + allowed_origin_ + "\r\nVary: Origin\r\n";
        send(std::move(response), std::move(extra), keep);
    }

    /// GET /?token=... or ?key=...: a session, and the page without the secret in its address.
    std::optional<Refusal> login() {
        const auto now = Clock::now();
        const auto token = target_.query.find("token");
        const auto key = target_.query.find("key");
        const bool by_token = token != target_.query.end();
        std::optional<std::string> secret;
        if (!by_token)
            secret = core_.sessions.login_by_key(key->second, now);
        else if (listener_->this_host)
            secret = core_.sessions.login_by_token(token->second, now);
        std::string extra = "Location: /\r\n";
        if (secret)
            extra += fmt::format("Set-Cookie: {}={}; HttpOnly; SameSite=Strict; Path=/{}\r\n",
                                 listener_->cookie, *secret, listener_->this_host ? "" : "; Secure");
        else if (!by_cookie(now))  // who has a session may open an old address again
            return by_token ? Refusal{403,
                                      "this token was used already, is too old, or is none: the server "
                                      "prints a new one on "
                                      "SIGUSR1",
                                      "token"}
                            : Refusal{403, "no such key in the keys file (--keys)", "key"};
        Response response{.status = 303, .body = "begin at /\n"};
        send(std::move(response), std::move(extra), parser_->get().keep_alive() && parser_->is_done());
        return {};
    }

    void refuse(const Refusal& refusal) {
        if (*refusal.kind)
            core_.refused(refusal.kind, host_,
                          fmt::format("{}: {}: {}", peer_, refusal.status, refusal.line));
        std::string extra;
        if (refusal.status == 401) extra = "WWW-Authenticate: Bearer\r\n";
        // A peer that is in the middle of a body, or speaks no HTTP, would be misunderstood from here on.
        send({.status = refusal.status, .body = refusal.line + '\n'}, std::move(extra), false);
    }

    void send(Response response, std::string extra, bool keep) {
        release_body();
        state_ = State::answers;
        answer_ = std::move(response);
        const std::string_view body = answer_.fixed.empty() ? std::string_view(answer_.body) : answer_.fixed;
        const bool no_body = answer_.status == 304 || answer_.status == 204;
        head_ = fmt::format(
            "HTTP/1.1 {} {}\r\nServer: knurl\r\nConnection: {}\r\n{}{}"
            "Cache-Control: {}\r\n"
            "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; connect-src "
            "'self'; "
            "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"
            "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
            "Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Resource-Policy: same-origin\r\n{}\r\n",
            answer_.status, reason_of(answer_.status), keep ? "keep-alive" : "close",
            no_body ? "" : fmt::format("Content-Type: {}\r\n", answer_.content_type),
            no_body ? "" : fmt::format("Content-Length: {}\r\n", body.size()), answer_.cache_control, extra);
        const std::array<asio::const_buffer, 2> parts{
            asio::buffer(head_),
            no_body || head_only_ ? asio::const_buffer() : asio::const_buffer(body.data(), body.size())};
        deadline = Clock::now() + time_for(core_.options.request_time, body.size());
        asio::async_write(wire_, parts, step([keep](Connection& self, std::size_t) {
                              self.answer_ = {};
                              self.head_only_ = false;
                              if (!keep) return self.linger();
                              self.deadline = Clock::now() + self.core_.options.idle_time;
                              self.wait();
                          }));
    }

    /// What the peer still sends is read for a while: closing before that would take away the answer (RST).
    void linger() {
        state_ = State::lingers;
        since = Clock::now();
        deadline = Clock::now() + core_.options.closing_time;
        buffer_.consume(buffer_.size());
        ErrorCode ignored;
        wire_.plain().shutdown(asio::socket_base::shutdown_send, ignored);
        discard();
    }
    void discard() {
        if (lingered_ > most_lingering) return finish();
        wire_.plain().async_read_some(buffer_.prepare(read_size),
                                      step([](Connection& self, std::size_t bytes) {
                                          self.lingered_ += bytes;
                                          self.discard();
                                      }));
    }

    void failed(const ErrorCode& error) {
        if (error && !finished_ && wire_.secret() && state_ == State::waits &&
            error.category() == asio::error::get_ssl_category())
            core_.refused("tls", host_, fmt::format("{}: TLS: {}", peer_, error.message()));
        finish();
    }

    void release_body() {
        core_.bodies -= reserved_;
        reserved_ = 0;
    }

    void finish() noexcept {
        if (finished_) return;
        finished_ = true;
        release_body();
        if (!moved_) wire_.close();
        const auto self = weak_from_this().lock();
        core_.remove(this);
    }

    Server::Core& core_;
    std::shared_ptr<Listener> listener_;
    Wire wire_;
    beast::flat_buffer buffer_;
    std::optional<Parser> parser_;
    State state_ = State::waits;
    Target target_;
    Identity identity_;
    std::string allowed_origin_;
    const HttpRoute* route_ = nullptr;  // of listener_
    std::size_t reserved_ = 0;          // of Core::bodies
    bool head_only_ = false;
    std::string head_;
    Response answer_;
    std::size_t lingered_ = 0;
    bool moved_ = false, finished_ = false;
};

}  // namespace

void begin_connection(Server::Core& core, std::shared_ptr<Listener> listener, int fd, int family,
                      std::string host, std::string name) {
    std::shared_ptr<Connection> connection;
    try {
        connection = std::make_shared<Connection>(core, std::move(listener), fd, family, std::move(host),
                                                  std::move(name));
    } catch (...) {
        ::close(fd);
        throw;
    }
    core.admit(connection);
    connection->start();
}

}  // namespace knurl::gateway
