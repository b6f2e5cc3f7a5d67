#pragma once
// What the "probe" driver of the test build writes into a file that the test maps too: a device that outlives
// the servo, and can say whether the guardian came.

#include <atomic>
#include <cstdint>

namespace knurl::test {

struct ProbeRecord {
    std::atomic<std::uint64_t> writes;
    std::atomic<std::uint64_t> zeroings;     // make_safe, by whichever process
    std::atomic<std::uint64_t> zeroing_pid;  // the last one's
    std::atomic<std::uint64_t> writes_at_zeroing;
    std::atomic<std::uint64_t> zeroing_ns;  // CLOCK_MONOTONIC
    std::atomic<std::uint64_t> hang;        // not 0: read() does not return while this is so
};

}  // namespace knurl::test
