#pragma once
// A server in a thread of its own, and a caller that sends any bytes.

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/gateway/server.hpp>

namespace knurl::gateway {

constexpr int patience_s = 30;  // a caller that waits longer has found a mistake

/// A connection of a caller. What it reads it waits for.
class Caller {
  public:
    explicit Caller(std::uint16_t port, int receive_buffer = 0)
        : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        if (receive_buffer > 0)
            ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
        connect(port);
    }
    /// Without a connection yet: it has its descriptor.
    Caller() : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {}
    ~Caller() { hang_up(); }
    Caller(Caller&& other) noexcept : fd_(std::exchange(other.fd_, -1)), read_(std::move(other.read_)) {}
    Caller(const Caller&) = delete;
    Caller& operator=(const Caller&) = delete;

    void connect(std::uint16_t port) {
        timeval patience{.tv_sec = patience_s, .tv_usec = 0};
        ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        ::setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_port = htons(port);
        at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        if (::connect(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
            throw std::runtime_error(std::string("connect: ") + std::strerror(errno));
    }
    /// False: the server has closed.
    bool send(std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (sent <= 0) return false;
            bytes.remove_prefix(static_cast<std::size_t>(sent));
        }
        return true;
    }
    /// Waits for this many bytes, fewer if the server closes.
    std::string read(std::size_t size) {
        while (read_.size() < size && more()) {
        }
        std::string result = read_.substr(0, size);
        read_.erase(0, size);
        return result;
    }
    /// To and with `end`.
    std::string read_to(std::string_view end) {
        std::size_t at = 0;
        while ((at = read_.find(end)) == std::string::npos && more()) {
        }
        return at == std::string::npos ? read(read_.size()) : read(at + end.size());
    }
    std::string read_to_the_end() {
        while (more()) {
        }
        return std::exchange(read_, {});
    }
    /// The server has closed, and nothing is left.
    bool at_end() { return read(1).empty(); }
    /// The server has said that it sends no more: what it had said before is not lost by a reset.
    bool ends_well() {
        read_.clear();
        char byte = 0;
        return ::recv(fd_, &byte, 1, 0) == 0;
    }
    void hang_up() {
        if (fd_ >= 0) ::close(std::exchange(fd_, -1));
    }
    void say_no_more() { ::shutdown(fd_, SHUT_WR); }

  private:
    bool more() {
        std::array<char, 65536> bytes;
        const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), 0);
        if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
            throw std::runtime_error("the server neither answers nor closes");
        if (got <= 0) return false;
        read_.append(bytes.data(), static_cast<std::size_t>(got));
        return true;
    }
    int fd_;
    std::string read_;
};

struct Answer {
    int status = 0;
    std::string head, body;
    /// Value of a header; empty: it has none.
    std::string header(const std::string& name) const {
        const std::size_t at = head.find("\r\n" + name + ": ");
        if (at == std::string::npos) return {};
        const std::size_t begin = at + 4 + name.size();
        return head.substr(begin, head.find("\r\n", begin) - begin);
    }
};

inline Answer read_answer(Caller& caller, bool with_body = true) {
    Answer answer;
    answer.head = caller.read_to("\r\n\r\n");
    if (answer.head.size() > 12) answer.status = std::atoi(answer.head.c_str() + 9);
    const std::string length = answer.header("Content-Length");
    if (with_body && !length.empty()) answer.body = caller.read(std::stoul(length));
    return answer;
}

// Frames of RFC 6455, 5.2.
constexpr unsigned text_frame = 1, binary_frame = 2, close_frame = 8, ping_frame = 9, pong_frame = 10;

inline std::string frame(unsigned opcode, std::string_view payload, bool last = true, bool masked = true) {
    std::string bytes;
    bytes += static_cast<char>((last ? 0x80U : 0U) | opcode);
    const unsigned mask_bit = masked ? 0x80U : 0U;
    if (payload.size() < 126) {
        bytes += static_cast<char>(mask_bit | payload.size());
    } else if (payload.size() < 65536) {
        bytes += static_cast<char>(mask_bit | 126U);
        for (const int shift : {8, 0}) bytes += static_cast<char>(payload.size() >> shift);
    } else {
        bytes += static_cast<char>(mask_bit | 127U);
        for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(payload.size() >> shift);
    }
    const std::string mask = "\x12\x34\x56\x78";
    if (masked) bytes += mask;
    for (std::size_t i = 0; i < payload.size(); ++i)
        bytes += static_cast<char>(masked ? payload[i] ^ mask[i % 4] : payload[i]);
    return bytes;
}

struct Frame {
    unsigned opcode = 0;  // 0: the connection has ended
    std::string payload;
    unsigned code() const {
        return payload.size() < 2 ? 0
                                  : static_cast<unsigned>(static_cast<unsigned char>(payload[0])) * 256 +
                                        static_cast<unsigned char>(payload[1]);
    }
};

inline Frame read_frame(Caller& caller) {
    const std::string head = caller.read(2);
    if (head.size() < 2) return {};
    std::size_t size = static_cast<unsigned char>(head[1]);
    if (size >= 126) {
        const std::string length = caller.read(size == 126 ? 2 : 8);
        size = 0;
        for (const char c : length) size = size * 256 + static_cast<unsigned char>(c);
    }
    return {.opcode = static_cast<unsigned char>(head[0]) & 15U, .payload = caller.read(size)};
}

/// The next that is no ping.
inline Frame read_message(Caller& caller) {
    for (;;) {
        Frame next = read_frame(caller);
        if (next.opcode != ping_frame) return next;
    }
}

/// A handler that says what it is told, and does what it is asked.
class Echo final : public SocketHandler {
  public:
    Echo(Socket& socket, std::string subprotocol, std::atomic<int>& ended) : socket_(socket), ended_(ended) {
        constexpr const char* roles[] = {"observe", "render", "control"};
        socket_.send_text("hello " + subprotocol + ' ' + roles[static_cast<int>(socket.role())] + ' ' +
                          socket.session());
    }
    ~Echo() override { ++ended_; }
    void text(std::string_view message) override {
        if (message == "throw") throw std::runtime_error("asked to");
        if (message == "throw 7") throw 7;
        if (message == "close") return socket_.close(4001, "asked to");
        if (message == "flood") flood_ = true;
        if (message == "throw in a tick") throw_ = true;
        socket_.send_text(std::string(message));
    }
    void binary(std::span<const std::byte> message) override {
        socket_.send_binary({message.begin(), message.end()});
    }
    void tick(std::chrono::steady_clock::time_point) override {
        if (throw_) throw std::runtime_error("asked to, in a tick");
        if (flood_) socket_.send_binary(std::vector<std::byte>(256 * 1024));
    }

  private:
    Socket& socket_;
    std::atomic<int>& ended_;
    bool flood_ = false, throw_ = false;
};

/// Paths of the site: /, /app.js, /asset/*, /echo (POST), /large (POST, 1 MiB), /throw; sockets /live, /open (for all of
/// this host), /two (subprotocols one, two).
class Served {
  public:
    explicit Served(ServerOptions options = {}, const std::function<void(Site&)>& change = {},
                    const std::string& address = "127.0.0.1") {
        options.log = [this](const std::string& line) {
            const std::scoped_lock lock(mutex_);
            lines_.push_back(line);
        };
        server_ = std::make_unique<Server>(std::move(options));
        Site site = this->site();
        if (change) change(site);
        port = server_->listen(address, 0, std::move(site));
        server_->on_tick([this](std::chrono::steady_clock::time_point) {
            const std::scoped_lock lock(mutex_);
            ++ticks_;
            ticked_.notify_all();
        });
        token = server_->new_token();
        thread_ = std::thread([this] { server_->run(); });
    }
    ~Served() { stop(); }
    /// Ends its thread.
    void stop() {
        if (!thread_.joinable()) return;
        server_->stop();
        thread_.join();
    }
    /// And then the server.
    void end() { server_.reset(); }

    Server& server() { return *server_; }
    /// Runs in the server's thread, and waits for it.
    void in_server(const std::function<void()>& work) {
        std::mutex mutex;
        std::condition_variable changed;
        bool done = false;
        server_->post([&] {
            work();
            const std::scoped_lock lock(mutex);
            done = true;
            changed.notify_all();
        });
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return done; });
    }
    void wait_for_ticks(int count) {
        std::unique_lock lock(mutex_);
        const int until = ticks_ + count;
        ticked_.wait(lock, [&] { return ticks_ >= until; });
    }
    /// Lines of the log so far that hold this.
    int said(const std::string& part) {
        const std::scoped_lock lock(mutex_);
        int count = 0;
        for (const std::string& line : lines_) count += line.find(part) != std::string::npos ? 1 : 0;
        return count;
    }

    std::string host() const { return "127.0.0.1:" + std::to_string(port); }
    std::string origin() const { return "http://" + host(); }
    /// A request; `more`: further header lines, each with its line end.
    std::string request(const std::string& what, const std::string& more = {},
                        const std::string& body = {}) const {
        return what + " HTTP/1.1\r\nHost: " + host() + "\r\n" + more +
               (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" +
               body;
    }
    Answer ask(const std::string& bytes) const {
        Caller caller(port);
        caller.send(bytes);
        return read_answer(caller);
    }
    /// A Cookie header of a new session.
    std::string cookie() {
        std::string good;
        in_server([&] { good = server_->new_token(); });
        const std::string set = ask(request("GET /?token=" + good)).header("Set-Cookie");
        return "Cookie: " + set.substr(0, set.find(';')) + "\r\n";
    }
    std::string upgrade(const std::string& path, const std::string& more = {}) const {
        return request("GET " + path,
                       "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                       "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                           more);
    }
    /// An open socket, whose first message was read.
    Caller open(const std::string& path = "/open", int receive_buffer = 0) const {
        Caller caller(port, receive_buffer);
        caller.send(upgrade(path));
        const Answer answer = read_answer(caller);
        if (answer.status != 101) throw std::runtime_error("no upgrade: " + answer.head);
        read_message(caller);
        return caller;
    }

    std::uint16_t port = 0;
    std::string token;
    std::atomic<int> ended{0}, answered{0};

  private:
    Site site() {
        const auto text = [](std::string body) {
            return [body = std::move(body)](const Request&) { return Response{.body = body}; };
        };
        const MakeHandler echo = [this](Socket& socket, const std::string& subprotocol) {
            return std::make_unique<Echo>(socket, subprotocol, ended);
        };
        const auto back = [this](const Request& request) {
            ++answered;
            return Response{.content_type = "application/octet-stream", .body = request.body};
        };
        Site made{.login = true};
        made.http = {
            {.method = "GET", .path = "/", .answer = text("page")},
            route_of({.path = "/app.js",
                      .content_type = "text/javascript",
                      .etag = "abc",
                      .content = "plain",
                      .gzip = "packed"},
                     {}),
            {.method = "GET",
             .path = "/asset/*",
             .answer = [](const Request& request) { return Response{.body = "asset " + request.path}; }},
            {.method = "GET", .path = "/asset/special*", .answer = text("special")},
            {.method = "POST", .path = "/echo", .answer = back},
            {.method = "POST",
             .path = "/large",
             .access = {.needs = Role::render},
             .most_body = std::size_t{1} << 20,
             .answer = back},
            {.method = "GET",
             .path = "/throw",
             .answer = [](const Request&) -> Response { throw std::runtime_error("asked to"); }},
        };
        const Access everybody{.without_key = Role::observe, .origins = {"https://app.example"}};
        made.sockets = {
            {.path = "/live", .subprotocols = {"knurl.live.v1"}, .make = echo},
            {.path = "/open", .access = everybody, .most_message = 100000, .most_sockets = 40, .make = echo},
            {.path = "/two", .subprotocols = {"one", "two"}, .access = everybody, .make = echo},
            {.path = "/none",
             .access = everybody,
             .make = [](Socket&, const std::string&) { return nullptr; }},
            {.path = "/unborn",
             .access = everybody,
             .make = [](Socket&, const std::string&) -> std::unique_ptr<SocketHandler> {
                 throw std::runtime_error("not born");
             }},
        };
        return made;
    }

    std::mutex mutex_;
    std::condition_variable ticked_;
    int ticks_ = 0;
    std::vector<std::string> lines_;
    std::unique_ptr<Server> server_;
    std::thread thread_;
};

}  // namespace knurl::gateway
