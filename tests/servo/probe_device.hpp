#pragma once
// The record that the "probe" driver of the test build writes into a file, which the test maps too: a device
// that outlives the servo, and shows whether the guardian acted.

#include <atomic>
#include <cstdint>

namespace knurl::test {

struct ProbeRecord {
    std::atomic<std::uint64_t> writes;
    std::atomic<std::uint64_t> zeroings;     // make_safe, in any process
    std::atomic<std::uint64_t> zeroing_pid;  // the last one's
    std::atomic<std::uint64_t> writes_at_zeroing;
    std::atomic<std::uint64_t> zeroing_ns;  // CLOCK_MONOTONIC
    std::atomic<std::uint64_t> hang;        // not 0: read() blocks
};

}  // namespace knurl::test
