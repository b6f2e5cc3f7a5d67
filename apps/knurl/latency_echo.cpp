#include "latency_echo.hpp"

#include <cstdio>
#include <utility>

#include <fmt/format.h>

namespace knurl::cli {

namespace {

constexpr Nanoseconds patience = 1'000'000'000;  // TCP loses nothing, it is only late
constexpr int most_failures = 10;

void say_missing(const std::string& what) {
    fmt::print(stderr,
               "knurl latency: {}; start `knurl latency --serve-echo HOST:PORT` on the servo's host and give "
               "--echo HOST:PORT here; the rest is measured\n",
               what);
}

}  // namespace

NetworkFloors::NetworkFloors(const std::string& bridge, const std::string& echo, bridge::WireSizes sizes,
                             const Placement& placement)
    : sizes_(sizes) {
    if (bridge.empty()) return;
    if (!echo.empty()) {
        look_for(bridge::resolve(echo));
    } else if (bridge::resolve(bridge).loopback()) {
        own_udp_.emplace(placement);
        own_tcp_.emplace(bridge::resolve("127.0.0.1:0"), placement);
        udp_ = own_udp_->at();
        tcp_ = own_tcp_->at();
    } else {
        say_missing("no floor of the network");
    }
}

void NetworkFloors::look_for(const bridge::Endpoint& echo) {
    if (udp_echoes(echo)) udp_ = echo;
    TcpCaller caller(echo, sizes_.command, now_ns() + patience);
    if (caller.round_trip(now_ns() + patience)) tcp_ = echo;
    if (udp_ && tcp_) return;
    say_missing(fmt::format("nobody echoes at {} by {}", echo.text,
                            tcp_   ? "UDP"
                            : udp_ ? "TCP"
                                   : "UDP or TCP"));
}

void NetworkFloors::udp_block(Nanoseconds length) {
    if (udp_) udp_echo_block(*udp_, sizes_.datagram, length, udp_samples_);
}

void NetworkFloors::tcp_ping_pong(bool counts) {
    if (!tcp_) return;
    if (!caller_ || !caller_->connected()) {
        caller_.emplace(*tcp_, sizes_.command, now_ns() + patience);
        counts = false;
    }
    const auto took = caller_->round_trip(now_ns() + patience);
    if (took && counts) tcp_samples_.push_back(*took);
    if (took || ++failures_ < most_failures) return;
    say_missing(fmt::format("the echo at {} does not answer by TCP any more", tcp_->text));
    tcp_.reset();
}

void serve_echo(const std::string& at) {
    const TcpEcho tcp(bridge::resolve(at));
    shm::UniqueFd udp = udp_echo_socket(tcp.at());  // the port that was chosen, if none was given
    fmt::print("knurl latency: echoes at {} by UDP and TCP\n", tcp.at().text);
    std::fflush(stdout);
    serve_udp_echo(std::move(udp));
}

}  // namespace knurl::cli
