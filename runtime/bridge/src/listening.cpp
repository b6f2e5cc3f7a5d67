#include "listening.hpp"

#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include <netinet/in.h>
#include <sys/socket.h>

#include <knurl/link/text.hpp>

#include "datagram_socket.hpp"

namespace knurl::bridge {

namespace {

[[noreturn]] void cannot(const std::string& what) {
    const char* remedy = errno == EADDRINUSE
                             ? "; another program has this port: end it, or give another --listen"
                         : errno == EADDRNOTAVAIL ? "; give --listen an address that this host has"
                         : errno == EACCES        ? "; ports below 1024 are root's"
                                                  : "";
    throw std::runtime_error(detail::format("{}: {}{}", what, std::strerror(errno), remedy));
}

/// Nothing: the port is free for TCP, but another program has it for UDP.
std::optional<Listening> listen_once(const Endpoint& endpoint, const std::string& what) {
    Listening result{
        .callers = shm::UniqueFd(::socket(endpoint.family(), SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)),
        .datagrams = make_datagram_socket(endpoint.family())};
    const int on = 1;
    ::setsockopt(result.callers.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    // Each datagram carries the local address to which it was sent (peer_address.hpp).
    if (endpoint.family() == AF_INET)
        ::setsockopt(result.datagrams.get(), IPPROTO_IP, IP_PKTINFO, &on, sizeof on);
    else
        ::setsockopt(result.datagrams.get(), IPPROTO_IPV6, IPV6_RECVPKTINFO, &on, sizeof on);
    Endpoint at = endpoint;
    if (!result.callers || ::bind(result.callers.get(), at.get(), at.length) != 0 ||
        ::listen(result.callers.get(), SOMAXCONN) != 0)
        cannot(what);
    at.length = sizeof at.address;  // after port 0 the port is known here; datagrams use the same
    ::getsockname(result.callers.get(), at.get(), &at.length);
    if (!result.datagrams || ::bind(result.datagrams.get(), at.get(), at.length) != 0) {
        if (errno == EADDRINUSE) return {};
        cannot(what + " (UDP)");
    }
    result.at = numeric(at.address);
    return result;
}

Listening listen_at(const Endpoint& endpoint, bool keys) {
    const std::string what = detail::format("cannot listen at {}", endpoint.text);
    if (!endpoint.loopback() && !keys)
        throw std::runtime_error(detail::format(
            "{}: whoever reaches it could move the hand, so an address that is not this host's "
            "own (127.0.0.1, [::1]) "
            "needs keys: `knurl-bridge keygen --name NAME --role control`, then --keys FILE",
            what));
    // The kernel chooses a port that is free for TCP. On a host with many sockets it may be taken for UDP, so
    // further ports are tried.
    const int choices = endpoint.port() == 0 ? 100 : 1;
    for (int choice = 0; choice < choices; ++choice)
        if (auto result = listen_once(endpoint, what)) return std::move(*result);
    errno = EADDRINUSE;
    cannot(what + " (UDP)");
}

}  // namespace

Listening listen_at(std::span<const Endpoint> endpoints, bool keys) {
    std::string reason;
    for (const Endpoint& each : endpoints) {
        try {
            return listen_at(each, keys);
        } catch (const std::runtime_error& error) {
            if (endpoints.size() == 1) throw;
            if (reason.empty()) reason = error.what();
        }
    }
    throw std::runtime_error(detail::format("{} (tried {} addresses)", reason, endpoints.size()));
}

}  // namespace knurl::bridge
