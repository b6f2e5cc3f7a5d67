#pragma once
// What a test draws its numbers from.

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

namespace knurl::bridge::test {

/// Another one in each run, which a failing test prints; KNURL_SEED=N repeats that run.
inline std::uint32_t seed() {
    const char* text = std::getenv("KNURL_SEED");
    return text != nullptr ? static_cast<std::uint32_t>(std::strtoul(text, nullptr, 0))
                           : std::random_device{}();
}
inline std::string text_of_seed(std::uint32_t seed) {
    return "again with KNURL_SEED=" + std::to_string(seed);
}

}  // namespace knurl::bridge::test
