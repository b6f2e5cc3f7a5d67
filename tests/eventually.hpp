#pragma once
// For what can only be looked at: who has an event to wait for (a line, a report, a descriptor) waits for
// that.

#include <chrono>
#include <thread>

namespace knurl::test {

inline constexpr std::chrono::seconds patience{30};  // a loaded machine under a sanitizer

/// Looks again and again until it is so. False after `patience`.
template <class So>
[[nodiscard]] bool eventually(So so) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (!so()) {
        if (std::chrono::steady_clock::now() > deadline) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // between two looks, not instead of them
    }
    return true;
}

}  // namespace knurl::test
