#pragma once
// What a bad network does to datagrams and streams, as a pure function of a seed: the n-th datagram of a way
// has the same fate in every run, whatever the other way does and however fast the machine is.

#include <cstdint>

namespace knurl::bridge::proxy {

struct NetworkProfile {
    double loss = 0;  // chance of a datagram to vanish; of a piece of a stream, to be sent again by its end
    double duplicate = 0;  // chance to arrive twice
    double reorder = 0;    // chance to be overtaken: a further delay, up to `held`
    double held = 0.005;   // s
    double delay = 0;      // s, of each
    double jitter = 0;     // s, uniform, each datagram by itself
    double swing = 0;  // s, a delay that goes up and down: by straight lines between random values 0 to this
    double swing_period = 0.1;  // s between those values
};

enum class Way : std::uint8_t { forth = 0, back = 1 };

struct Fate {
    int copies = 1;             // 0: lost
    double delays[2] = {0, 0};  // s, of each copy
    bool operator==(const Fate&) const = default;
};

/// Of datagram number `n` of flow `flow` on its way, which comes in `now` s after the start (for `swing`
/// alone).
Fate fate_of(const NetworkProfile& profile, std::uint64_t seed, Way way, std::uint32_t flow, std::uint64_t n,
             double now) noexcept;

/// Of a piece of a stream: nothing is lost, doubled or overtaken; what was lost on the way is sent again
/// after a round trip and 10 ms, and all that follows waits behind it.
double stream_delay(const NetworkProfile& profile, std::uint64_t seed, Way way, std::uint32_t flow,
                    std::uint64_t n, double now) noexcept;

}  // namespace knurl::bridge::proxy
