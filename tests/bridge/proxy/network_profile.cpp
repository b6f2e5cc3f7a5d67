#include "network_profile.hpp"

#include <cmath>

namespace knurl::bridge::proxy {

namespace {

// Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014 (SplitMix64).
std::uint64_t mixed(std::uint64_t x) noexcept {
    x += 0x9e3779b97f4a7c15;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
}

/// Random numbers from 0 to 1, one for each question, so that a new question does not change the other
/// numbers.
struct Dice {
    std::uint64_t state;
    double roll(std::uint64_t question) const noexcept {
        return static_cast<double>(mixed(state ^ mixed(question)) >> 11) * 0x1p-53;
    }
};

Dice dice_of(std::uint64_t seed, Way way, std::uint32_t flow, std::uint64_t n) noexcept {
    const std::uint64_t who = (std::uint64_t{flow} << 1) | static_cast<std::uint64_t>(way);
    return {mixed(mixed(seed ^ mixed(who)) + n)};
}

double swing_at(const NetworkProfile& profile, std::uint64_t seed, Way way, double now) noexcept {
    if (profile.swing <= 0) return 0;
    const double place = now / profile.swing_period, from = std::floor(place);
    const auto knot = [&](double at) {
        return dice_of(~seed, way, 0, static_cast<std::uint64_t>(at)).roll(0);
    };
    return profile.swing * std::lerp(knot(from), knot(from + 1), place - from);
}

}  // namespace

Fate fate_of(const NetworkProfile& profile, std::uint64_t seed, Way way, std::uint32_t flow, std::uint64_t n,
             double now) noexcept {
    const Dice dice = dice_of(seed, way, flow, n);
    const double common = profile.delay + swing_at(profile, seed, way, now);
    Fate fate;
    if (dice.roll(0) < profile.loss) fate.copies = 0;
    if (fate.copies == 1 && dice.roll(1) < profile.duplicate) fate.copies = 2;
    for (int copy = 0; copy < fate.copies; ++copy) {
        const std::uint64_t at = 10 + 3 * static_cast<std::uint64_t>(copy);
        fate.delays[copy] = common + profile.jitter * dice.roll(at);
        if (dice.roll(at + 1) < profile.reorder) fate.delays[copy] += profile.held * dice.roll(at + 2);
    }
    return fate;
}

double stream_delay(const NetworkProfile& profile, std::uint64_t seed, Way way, std::uint32_t flow,
                    std::uint64_t n, double now) noexcept {
    const Dice dice = dice_of(seed, way, flow, n);
    const double once = profile.delay + swing_at(profile, seed, way, now) + profile.jitter * dice.roll(1);
    return dice.roll(0) < profile.loss ? once + 2 * (profile.delay + profile.jitter) + 0.01 : once;
}

}  // namespace knurl::bridge::proxy
