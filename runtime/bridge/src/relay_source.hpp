#pragma once
// The values that the relay's epoll set returns: the source, its index, and the place's use counter at that time.

#include <cstddef>
#include <cstdint>

namespace knurl::bridge {

enum class Source : std::uint64_t {
    listener,
    signals,
    datagrams,
    servo,
    device,
    caller,
    errands,
    peer,
    peers_servo,
    peers_assets
};

constexpr std::uint64_t source(Source what, std::size_t which = 0, std::uint32_t use = 0) {
    return static_cast<std::uint64_t>(what) << 56 | static_cast<std::uint64_t>(which) << 32 | use;
}

}  // namespace knurl::bridge
