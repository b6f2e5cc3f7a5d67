#pragma once
// Limits how often the callers of one host are heard. A handshake with a key costs time of the one thread
// that all peers share; hanging up costs almost none. Each host may call `burst` times at once, and
// `per_second` over time. The rate is high enough for the applications of a host, each of which calls up to
// 50 times a second when it has lost a servo. It is low enough that a host of nothing but callers does not
// delay the others.

#include <algorithm>
#include <array>
#include <cstdint>

#include <sys/socket.h>

#include <knurl/bridge/endpoint.hpp>

namespace knurl::bridge {

class CallerRate {
  public:
    static constexpr std::int64_t burst = 128, per_second = 100;
    static constexpr std::size_t hosts =
        256;  // remembered; a new host replaces the one that has called least

    /// May a caller of that host speak? If it may, the call is counted.
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
        std::int64_t paid_ns = 0;  // the time at which its calls so far are paid for, at that rate
    };
    std::array<Host, hosts> hosts_{};
};

}  // namespace knurl::bridge
