#pragma once
// Shared by the fake device's process and the driver "shared-sim": one mapped file. Every word has one
// meaning and fits one atomic, so nothing is ever torn, whichever process is killed at any time.
//
//      servo ----effort----> |           |
//   guardian ----effort----> | the file  | ----> fake device: integrates, logs what it saw with its own clock
//      servo <---sample----- |           |
//
// The critical race: a servo is stopped (SIGSTOP) between two writes, the guardian writes zero, the servo
// continues and overwrites the zero. Nothing here hides that: the log has both, with the writer, and the
// oracle decides whether the servo was allowed to.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <knurl/drivers/link_config.hpp>

namespace knurl::drivers::shared_sim {

inline constexpr std::uint64_t magic = 0x324d49534c52554eU;
inline constexpr int joints = 3;

enum class Writer : std::uint32_t { nobody = 0, servo = 1, guardian = 2 };

/// Effort word: three int16 (of 32767 = the joint's limit) | 14 bits of write count | 2 bits of writer.
struct EffortWord {
    std::array<std::int16_t, joints> share = {};
    std::uint32_t count = 0;  // modulo 2^14
    Writer writer = Writer::nobody;

    std::uint64_t pack() const {
        std::uint64_t word = 0;
        for (std::size_t i = 0; i < joints; ++i) {
            word |= std::uint64_t{static_cast<std::uint16_t>(share[i])} << (16 * i);
        }
        return word | std::uint64_t{count & 0x3fffU} << 48 |
               std::uint64_t{static_cast<std::uint32_t>(writer)} << 62;
    }
    static EffortWord unpack(std::uint64_t word) {
        EffortWord efforts;
        for (std::size_t i = 0; i < joints; ++i) {
            efforts.share[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(word >> (16 * i)));
        }
        efforts.count = static_cast<std::uint32_t>(word >> 48) & 0x3fffU;
        efforts.writer = static_cast<Writer>(word >> 62);
        return efforts;
    }
};

/// Sample word: three 21-bit encoder counts (offset by 2^20) | 1 bit homed.
inline std::uint64_t pack_counts(const std::array<std::int64_t, joints>& counts, bool homed) {
    std::uint64_t word = std::uint64_t{homed} << 63;
    for (std::size_t i = 0; i < joints; ++i) {
        const std::int64_t kept = std::clamp<std::int64_t>(counts[i], -(1 << 20), (1 << 20) - 1);
        word |= static_cast<std::uint64_t>(kept + (1 << 20)) << (21 * i);
    }
    return word;
}
inline std::int64_t unpack_count(std::uint64_t word, std::size_t joint) {
    return static_cast<std::int64_t>((word >> (21 * joint)) & 0x1fffffU) - (1 << 20);
}

enum class Event : std::uint32_t {
    servo_write = 1,
    guardian_write = 2,
    watchdog = 3,     // the device's own watchdog switched the motors off
    hand_begins = 4,  // Notice::claim_active arrived
    hand_rests = 5,   // Notice::disabled arrived
    unplugged = 6,
    plugged = 7,
};

/// One entry of the log: what the device saw, when it saw it.
struct Record {
    std::int64_t t = 0;  // ns, CLOCK_MONOTONIC of the fake device's process
    Event event = {};
    std::uint32_t missed = 0;                  // writes of the same writer that were overwritten between two
                                               // looks
    std::array<double, joints> effort = {};    // N m (N) asked for
    std::array<double, joints> force = {};     // N at the tip that these would be
    std::array<double, joints> position = {};  // m, the true tip
    std::array<double, joints> velocity = {};  // m/s
};

/// Bits of `control`, which a test sets.
inline constexpr std::uint64_t control_unplug = 1;  // reads say unplugged, writes fail
inline constexpr std::uint64_t control_stall = 2;   // no new samples
inline constexpr std::uint64_t control_leave = 4;   // the process ends

inline constexpr std::uint64_t state_running = 1;
inline constexpr std::uint64_t state_unplugged = 2;
inline constexpr std::uint64_t state_gone = 3;  // the process has ended in order

struct Shared {
    std::uint64_t magic_number = magic;
    std::uint64_t capacity = 0;          // of the log, records
    std::array<char, 256> profile = {};  // as in "sim:PROFILE"; the driver makes the same LinkConfig from it

    // Written by servo and guardian, read by the device: pairs with its acquire load in the loop.
    alignas(64) std::atomic<std::uint64_t> effort = 0;
    // Written by the servo: number << 1 | 1 for claim_active, | 0 for disabled. Pairs likewise.
    std::atomic<std::uint64_t> notice = 0;
    // Written by a test, read by the device.
    alignas(64) std::atomic<std::uint64_t> control = 0;
    // Written by the device. `sample` is whole by itself; `steps` is stored after it with release and loaded
    // before it with acquire, so a new number never comes with an old sample (a newer sample is welcome).
    alignas(64) std::atomic<std::uint64_t> sample = 0;
    std::atomic<std::uint64_t> steps = 0;
    // The last `control` that was executed: stored with release after it, loaded with acquire in tests.
    std::atomic<std::uint64_t> obeyed = 0;
    std::atomic<std::uint64_t> state = state_running;
    std::atomic<std::uint64_t> writes = 0;  // seen, from any writer, equal ones too
    // Records [0, records) are complete: stored with release after the record, pairs with the acquire of a
    // reader.
    alignas(64) std::atomic<std::uint64_t> records = 0;
    std::atomic<std::uint64_t> lost = 0;  // the log was full
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
static_assert(sizeof(Shared) % alignof(Record) == 0);

inline std::size_t file_size(std::uint64_t capacity) {
    return sizeof(Shared) + capacity * sizeof(Record);
}
inline Record* log_of(Shared* shared) {
    return reinterpret_cast<Record*>(shared + 1);
}
inline const Record* log_of(const Shared* shared) {
    return reinterpret_cast<const Record*>(shared + 1);
}

}  // namespace knurl::drivers::shared_sim
