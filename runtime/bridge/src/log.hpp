#pragma once
// The bridge's log. A refused application tries again every 20 ms, and a scan comes from many hosts. Neither
// may fill the disk, nor hide who is connected.

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include <sys/socket.h>

namespace knurl::bridge {

class Log {
  public:
    static constexpr int lines_per_second = 20;  // for connections and disconnections, and again for refusals
    static constexpr std::int64_t repeat_ns = 60'000'000'000;
    static constexpr std::size_t most_refusals = 64;  // remembered

    /// `write` takes one line and never waits; false: it was not written.
    explicit Log(std::function<bool(const std::string&)> write) : write_(std::move(write)) {}

    /// Connections, disconnections, and the servo.
    void event(const std::string& line, std::int64_t now_ns);
    /// Somebody is refused. The same refusal of the same host is logged once per `repeat_ns`, with its number
    /// since. The number is logged earlier when another line about that host is written.
    void refused(const sockaddr_storage& host, const std::string& who, const std::string& why,
                 std::int64_t now_ns);
    /// Somebody of that host is admitted.
    void admitted(const sockaddr_storage& host, const std::string& line, std::int64_t now_ns);

  private:
    struct Allowance {
        std::int64_t second = -1;
        int used = 0;
    };
    struct RefusedHost {
        sockaddr_storage host{};
        std::string why{};
        std::int64_t said_ns = std::numeric_limits<std::int64_t>::min();
        std::uint64_t unsaid = 0;
    };

    bool say(const std::string& line, Allowance& allowance, std::int64_t now_ns);
    /// Logs the pending numbers of that host, except those of `except`.
    void catch_up(const sockaddr_storage& host, const RefusedHost* except, std::int64_t now_ns);

    std::function<bool(const std::string&)> write_;
    Allowance events_, refusals_;
    std::uint64_t left_out_ = 0;
    std::array<RefusedHost, most_refusals> refused_;
};

}  // namespace knurl::bridge
