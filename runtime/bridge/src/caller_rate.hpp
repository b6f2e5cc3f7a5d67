#pragma once
// How often callers of one host are heard. A handshake with a key is work for the one thread that all peers
// share; to hang up is next to none. Each host may call `burst` times at once, and `per_second` for good:
// enough that the applications of a host, which ask up to 50 times a second each when they have lost a servo,
// wait for each other a little only, and little enough that a host which does nothing but call does not keep
// the others waiting.

#include <algorithm>
#include <array>
#include <cstdint>

#include <sys/socket.h>

#include <knurl/bridge/endpoint.hpp>

namespace knurl::bridge {

class CallerRate {
  public:
    static constexpr std::int64_t burst = 128, per_second = 100;
    static constexpr std::size_t hosts = 64;  // remembered; of more the one that has called least gives way

    /// A caller of that host: may it speak? It counts if it may.
    bool allows(const sockaddr_storage& from, std::int64_t now) noexcept {
        Host* host = &hosts_.front();
        for (Host& each : hosts_) {
            if (same_host(each.address, from)) {
                host = &each;
                break;
            }
            if (each.paid_ns < host->paid_ns) host = &each;
        }
        if (!same_host(host->address, from)) *host = {.address = from};
        const std::int64_t paid = std::max(host->paid_ns, now);
        if (paid - now > (burst - 1) * interval_ns) return false;
        host->paid_ns = paid + interval_ns;
        return true;
    }

  private:
    static constexpr std::int64_t interval_ns = 1'000'000'000 / per_second;
    struct Host {
        sockaddr_storage address{};
        std::int64_t paid_ns = 0;  // when its calls so far would be done at that rate
    };
    std::array<Host, hosts> hosts_{};
};

}  // namespace knurl::bridge
