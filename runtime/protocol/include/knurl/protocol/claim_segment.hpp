#pragma once

/// @file
/// The segment of one claim (or observer): where its rings lie. Written by both sides; it can hurt only its
/// owner, since the servo copies once, then validates the copy, and keeps its own indexes in private memory.
///
/// ~~~{.unparsed}
///   header | waiter flag | command ring -> servo | batches -> servo | replies -> client | feedback -> client
/// ~~~

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <knurl/protocol/bounds.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::protocol {

/// Size of a claim. Both sides compute the same layout from it, and never read it from the segment.
struct ClaimCapacity {
    /// Most representations; 0: an observer, which has no rings at all.
    std::uint32_t representations = default_representations;
    /// Most bytes of a batch's entries.
    std::uint32_t batch_bytes = default_batch_bytes;
};

/// Where the parts of a claim's segment lie (bytes from its beginning).
struct ClaimLayout {
    /// Waiter flag.
    std::size_t waiter = 0;
    /// Command ring.
    std::size_t commands = 0;
    /// Triple buffer of batches.
    std::size_t batches = 0;
    /// Reply ring.
    std::size_t replies = 0;
    /// Triple buffer of feedback.
    std::size_t feedback = 0;
    /// Bytes of a batch's slot.
    std::size_t batch_slot_bytes = 0;
    /// Bytes of a feedback's slot.
    std::size_t feedback_slot_bytes = 0;
    /// Cells of the command ring: all representations can be added in one cycle.
    std::uint32_t command_cells = 0;
    /// Bytes of the segment.
    std::size_t total = 0;
};

/// The layout of a claim's segment.
constexpr ClaimLayout claim_layout(const ClaimCapacity& capacity) {
    const auto align = [](std::size_t n) { return (n + 127) / 128 * 128; };
    ClaimLayout layout;
    layout.waiter = 128;
    std::size_t end = layout.waiter + align(sizeof(shm::WaiterFlag));
    if (capacity.representations > 0) {
        layout.batch_slot_bytes = align(sizeof(BatchHeader) + capacity.batch_bytes);
        layout.feedback_slot_bytes =
            align(sizeof(FeedbackHeader) + capacity.representations * sizeof(FeedbackEntry));
        layout.commands = end;
        layout.command_cells =
            std::clamp(std::bit_ceil(8 * capacity.representations), 4096u, max_command_cells);
        end += align(shm::spsc_bytes(layout.command_cells));
        layout.batches = end;
        end += align(shm::triple_bytes(layout.batch_slot_bytes));
        layout.replies = end;
        end += align(shm::spsc_bytes(reply_cells));
        layout.feedback = end;
        end += align(shm::triple_bytes(layout.feedback_slot_bytes));
    }
    layout.total = (end + 4095) / 4096 * 4096;
    return layout;
}

}  // namespace knurl::protocol
