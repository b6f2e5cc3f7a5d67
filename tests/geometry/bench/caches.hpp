#pragma once
// The time of a cycle after something else has used the caches.

#include <cstddef>
#include <vector>

namespace knurl::test {

inline constexpr std::size_t flushed_bytes = std::size_t{48} << 20;

inline void flush_caches() {
    static std::vector<char> flushed(flushed_bytes);
    static char value = 0;
    ++value;
    for (std::size_t i = 0; i < flushed.size(); i += 64) flushed[i] = value;
}

}  // namespace knurl::test
