#pragma once
// The seed of a test's random numbers.

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

namespace knurl::bridge::test {

/// A different one in each run. A failing test prints it; KNURL_SEED=N repeats that run.
inline std::uint32_t seed() {
    const char* text = std::getenv("KNURL_SEED");
    return text != nullptr ? static_cast<std::uint32_t>(std::strtoul(text, nullptr, 0))
                           : std::random_device{}();
}
inline std::string text_of_seed(std::uint32_t seed) {
    return "again with KNURL_SEED=" + std::to_string(seed);
}

}  // namespace knurl::bridge::test
