#pragma once
// The effect of a bad network on datagrams and streams, as a pure function of a seed. The n-th datagram of a
// direction has the same fate in every run, whatever the other direction does and however fast the machine
// is.

#include <cstdint>

namespace knurl::bridge::proxy {

struct NetworkProfile {
    double loss = 0;  // chance that a datagram vanishes; for a piece of a stream, that its end sends it again
    double duplicate = 0;  // chance to arrive twice
    double reorder = 0;    // chance to be overtaken: a further delay, up to `held`
    double held = 0.005;   // s
    double delay = 0;      // s, of each
    double jitter = 0;     // s, uniform, each datagram by itself
    double swing = 0;      // s, a delay that rises and falls: linear between random values from 0 to this
    double swing_period = 0.1;  // s between those values
};

enum class Way : std::uint8_t { forth = 0, back = 1 };

struct Fate {
    int copies = 1;             // 0: lost
    double delays[2] = {0, 0};  // s, of each copy
    bool operator==(const Fate&) const = default;
};

/// The fate of datagram `n` of flow `flow` in one direction, which arrives `now` s after the start (only for
/// `swing`).
Fate fate_of(const NetworkProfile& profile, std::uint64_t seed, Way way, std::uint32_t flow, std::uint64_t n,
             double now) noexcept;

/// For a piece of a stream: nothing is lost, doubled or overtaken. A lost piece is sent again after a round
/// trip and 10 ms, and all that follows waits for it.
double stream_delay(const NetworkProfile& profile, std::uint64_t seed, Way way, std::uint32_t flow,
                    std::uint64_t n, double now) noexcept;

}  // namespace knurl::bridge::proxy
