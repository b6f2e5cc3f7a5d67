#pragma once
// What the test program and the other process, started by exec, agree on.

#include <cstdint>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>
#include <knurl/shm/waiter.hpp>

#include "support.hpp"

namespace knurl::shm::test {

using Report = Record<48>;
using Batch = Record<32>;
using Cell = Record<cell_words>;

inline constexpr std::uint32_t report_slots = 64;
inline constexpr std::uint32_t ring_cells = 64;

inline constexpr std::size_t report_segment_bytes = broadcast_bytes(report_slots, sizeof(Report));

// The client's own segment.
inline constexpr std::size_t flag_at = 0;
inline constexpr std::size_t commands_at = flag_at + sizeof(WaiterFlag);
inline constexpr std::size_t replies_at = commands_at + spsc_bytes(ring_cells);
inline constexpr std::size_t batches_at = replies_at + spsc_bytes(ring_cells);
inline constexpr std::size_t claim_segment_bytes = batches_at + triple_bytes(sizeof(Batch));

}  // namespace knurl::shm::test
