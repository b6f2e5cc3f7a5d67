#pragma once

/// @file
/// CLOCK_MONOTONIC, the clock of the servo's stamps.

#include <cstdint>
#include <ctime>

namespace knurl::detail {

inline std::int64_t monotonic_ns() {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

}  // namespace knurl::detail
