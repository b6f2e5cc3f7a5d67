// knurl_bench_inverse: the round trip of the Inverse Service over loopback, as its clients make it: a force goes, the
// state comes. Beside it, in alternating blocks of the same run: the same server with a fixed answer of the same length
// (what the transport costs), and a bare echo of as many bytes between two sockets (what the kernel costs).
//   knurl_bench_inverse [--blocks N] [--json FILE]

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <iostream>
#include <thread>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <knurl/gateway/inverse.hpp>
#include <knurl/gateway/server.hpp>
#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>

#include "../client/servo_process.hpp"

namespace {

using namespace client_test;
using namespace knurl::gateway;
namespace measure = knurl::measure;

constexpr int trips = 2000;  // of a block
constexpr double goal_ms = 0.3, goal_rate = 5000;

[[noreturn]] void fail(const char* what) {
    throw std::runtime_error(std::string(what) + ": " + std::strerror(errno));
}

int connect_to(std::uint16_t port) {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (fd < 0 || ::connect(fd, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0) fail("connect");
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return fd;
}

void send_all(int fd, const std::string& bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
        const ssize_t n = ::send(fd, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (n <= 0) fail("send");
        sent += static_cast<std::size_t>(n);
    }
}

void receive(int fd, char* out, std::size_t bytes) {
    for (std::size_t got = 0; got < bytes;) {
        const ssize_t n = ::recv(fd, out + got, bytes - got, 0);
        if (n <= 0) fail("recv");
        got += static_cast<std::size_t>(n);
    }
}

/// One blocking WebSocket: what any client has at least.
class WebSocket {
  public:
    explicit WebSocket(std::uint16_t port) : fd_(connect_to(port)) {
        send_all(fd_, "GET / HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                          "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: "
                          "dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n");
        std::string head;
        for (char c = 0; !head.ends_with("\r\n\r\n"); head += c) receive(fd_, &c, 1);
        if (head.find(" 101 ") == std::string::npos) throw std::runtime_error("no WebSocket: " + head);
    }
    ~WebSocket() { ::close(fd_); }
    WebSocket(const WebSocket&) = delete;
    WebSocket& operator=(const WebSocket&) = delete;

    void send(const std::string& text) {
        std::string frame = "\x81";  // a whole text; masked by zeros, which is legal
        if (text.size() < 126) {
            frame += static_cast<char>(0x80 | text.size());
        } else {
            frame += static_cast<char>(0x80 | 126);
            frame += static_cast<char>(text.size() >> 8);
            frame += static_cast<char>(text.size());
        }
        frame += std::string(4, '\0') + text;
        send_all(fd_, frame);
    }
    std::string receive_text() {
        for (;;) {
            unsigned char head[2];
            receive(fd_, reinterpret_cast<char*>(head), 2);
            std::size_t size = head[1] & 0x7f;
            if (size >= 126) {
                unsigned char more[8];
                const std::size_t count = size == 126 ? 2 : 8;
                receive(fd_, reinterpret_cast<char*>(more), count);
                size = 0;
                for (std::size_t i = 0; i < count; ++i) size = size << 8 | more[i];
            }
            std::string text(size, '\0');
            receive(fd_, text.data(), size);
            if ((head[0] & 0x0f) == 1) return text;
        }
    }

  private:
    int fd_;
};

/// Answers everything with the same text.
class Fixed final : public SocketHandler {
  public:
    Fixed(Socket& socket, std::string text) : socket_(socket), text_(std::move(text)) {}
    void text(std::string_view) override { socket_.send_text(text_); }
    void binary(std::span<const std::byte>) override {}
    void tick(std::chrono::steady_clock::time_point) override {}

  private:
    Socket& socket_;
    std::string text_;
};

/// Takes so many bytes, gives so many back.
class Bare {
  public:
    Bare(std::size_t takes, std::size_t gives) : takes_(takes), gives_(gives) {
        listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof at;
        if (::bind(listener_, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0 ||
            ::listen(listener_, 1) != 0 ||
            ::getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size) != 0)
            fail("listen");
        thread_ = std::thread([this] {
            const int fd = ::accept(listener_, nullptr, nullptr);
            const int on = 1;
            ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
            std::string in(takes_, '\0');
            const std::string out(gives_, 'x');
            try {
                for (;;) {
                    receive(fd, in.data(), in.size());
                    send_all(fd, out);
                }
            } catch (const std::runtime_error&) {  // the other end has closed
            }
            ::close(fd);
        });
        fd_ = connect_to(ntohs(at.sin_port));
    }
    ~Bare() {
        ::close(fd_);
        thread_.join();
        ::close(listener_);
    }
    Bare(const Bare&) = delete;
    Bare& operator=(const Bare&) = delete;

    void trip() {
        send_all(fd_, std::string(takes_, 'x'));
        std::string back(gives_, '\0');
        receive(fd_, back.data(), back.size());
    }

  private:
    std::size_t takes_, gives_;
    int listener_ = -1, fd_ = -1;
    std::thread thread_;
};

/// The server in a thread of its own, as knurl-web has it.
class Served {
  public:
    Served() {
        connect();  // the servo is there
        Inverse inverse = make_inverse({});
        Site site;
        site.sockets.push_back({.path = "/",
                                .access = {.without_key = Role::control},
                                .most_sockets = 64,
                                .make = inverse.simulation});
        port_ = server_.listen("127.0.0.1", 0, std::move(site));
        Site fixed;
        fixed.sockets.push_back({.path = "/",
                                 .access = {.without_key = Role::control},
                                 .make = [this](Socket& socket, const std::string&) {
                                     return std::make_unique<Fixed>(socket, answer_);
                                 }});
        fixed_port_ = server_.listen("127.0.0.1", 0, std::move(fixed));
        thread_ = std::thread([this] { server_.run(); });
    }
    ~Served() {
        server_.stop();
        thread_.join();
    }
    std::uint16_t port() const { return port_; }
    /// Of the one with the fixed answer, which is this one from now on.
    std::uint16_t fixed_port(std::string answer) {
        answer_ = std::move(answer);
        return fixed_port_;
    }

  private:
    Server server_;
    std::string answer_;
    std::uint16_t port_ = 0, fixed_port_ = 0;
    std::thread thread_;
};

template <class Trip>
std::vector<double> block(Trip trip) {
    std::vector<double> microseconds;
    microseconds.reserve(trips);
    for (int i = 0; i < trips; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        trip();
        microseconds.push_back(
            std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
    }
    return microseconds;
}

int run(int blocks, const char* file) {
    if (file) measure::require_writable(file);
    measure::Run run{.machine = measure::this_machine(), .results = {}};
    ServoProcess servo({"--device", "right=sim:premium15,grip=1"});
    Served served;
    WebSocket client(served.port());
    const knurl::Json inventory = knurl::Json::parse(client.receive_text());
    const std::string id = inventory["inverse3"][0]["device_id"];
    const std::string force = R"({"inverse3":[{"device_id":")" + id +
                              R"(","commands":{"set_cursor_force":{"vector":{"x":0,"y":0,"z":0.1}}}}]})";
    const auto inverse_trip = [&] {
        client.send(force);
        return client.receive_text();
    };
    const std::string answer = inverse_trip();
    WebSocket fixed(served.fixed_port(answer));
    Bare bare(force.size() + 8, answer.size() + 4);

    measure::Blocks ours, transport, kernel;
    double busy = 0;  // s
    for (int i = 0; i < blocks; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        ours.add(block(inverse_trip));
        busy += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        transport.add(block([&] {
            fixed.send(force);
            fixed.receive_text();
        }));
        kernel.add(block([&] { bare.trip(); }));
    }
    run.results = {measure::summarise_blocks("bare echo between two sockets", "us", kernel),
                   measure::summarise_blocks("this server, a fixed answer", "us", transport),
                   measure::summarise_blocks("a force there, the state back", "us", ours)};
    for (std::size_t i = 1; i < run.results.size(); ++i) measure::relate(run.results[i], run.results[0]);
    measure::print(std::cout, run);
    const double rate = blocks * trips / busy, median = run.results[2].p50.value_or(1e9) * 1e-3;
    std::printf(
        "%zu bytes there, %zu back; %.0f messages a second of one client that waits for each answer\n",
        force.size(), answer.size(), rate);
    std::printf("p50 at most %g ms: %s; %g messages a second: %s\n", goal_ms,
                median <= goal_ms ? "kept" : "not kept", goal_rate, rate >= goal_rate ? "kept" : "not kept");
    if (file) measure::write_file(file, measure::to_json(run));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    int blocks = 20;
    const char* file = nullptr;
    for (int i = 1; i < argc; i += 2) {
        const std::string word = argv[i];
        if ((word != "--blocks" && word != "--json") || i + 1 == argc) {
            std::fprintf(stderr, "knurl_bench_inverse: '%s': use [--blocks N] [--json FILE]\n", argv[i]);
            return 2;
        }
        if (word == "--json")
            file = argv[i + 1];
        else
            blocks = std::max(1, std::atoi(argv[i + 1]));
    }
    try {
        return run(blocks, file);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurl_bench_inverse: %s\n", error.what());
        return 1;
    }
}
