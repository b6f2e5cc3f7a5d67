#pragma once

/// @file
/// The command channel: a ring of 64-byte cells with one producer and one consumer. A message is a group of
/// cells, and a group is pushed whole or not at all. Full is an answer, nothing is ever dropped.
///
///     producer: words of cell t ─sb─> tail = t+1 (rel) ══sw══> tail read (acq) ─sb─> read words
///     consumer: read words of h ─sb─> head = h+1 (rel) ══sw══> head read (acq) ─sb─> overwrite cell h
///
/// The first line makes the data whole, the second keeps it from being overwritten too early.
///
/// Each side keeps its own index in private memory and only publishes it: the other side can write any value
/// into the shared words and harm nobody but itself. Counters are 64-bit and never wrap. A producer killed in
/// mid-write has not moved `tail`: nothing to repair.

#include <algorithm>

#include <knurl/shm/words.hpp>

namespace knurl::shm {

/// Bytes of a cell.
inline constexpr std::size_t cell_bytes = 64;
/// Words of a cell.
inline constexpr std::size_t cell_words = cell_bytes / sizeof(std::uint64_t);

/// Memory orders of the ring. The models in tests/shm weaken them one by one.
struct SpscOrders {
    /// Pairs with see_tail.
    static constexpr auto publish_tail = std::memory_order::release;
    /// Pairs with publish_tail.
    static constexpr auto see_tail = std::memory_order::acquire;
    /// Pairs with see_head.
    static constexpr auto publish_head = std::memory_order::release;
    /// Pairs with publish_head.
    static constexpr auto see_head = std::memory_order::acquire;
};

/// Where a ring lies in memory.
template <class Memory = HardwareMemory>
struct SpscPlaces {
    /// Cells pushed since the start; written by the producer.
    typename Memory::Word* tail;
    /// Cells popped since the start; written by the consumer.
    typename Memory::Word* head;
    /// The cells, a power of two of them.
    typename Memory::Payload* cells;
};

/// The producer of a ring.
template <class Memory = HardwareMemory, class Orders = SpscOrders>
class BasicSpscProducer {
  public:
    /// Goes on with the ring of `cells` cells at these places.
    BasicSpscProducer(SpscPlaces<Memory> places, std::uint32_t cells)
        : places_(places),
          cells_(cells),
          tail_(Memory::load(*places.tail, std::memory_order::relaxed)),
          head_(Memory::load(*places.head, std::memory_order::relaxed)) {}

    /// Copies n_cells * 64 bytes from `data` and makes them visible at once; false if they do not fit now.
    bool try_push(const void* data, std::size_t n_cells) noexcept {
        if (room() < n_cells) {  // only when the ring looks full is the consumer's line touched
            head_ = Memory::load(*places_.head, Orders::see_head);
            if (room() < n_cells) return false;
        }
        const auto* bytes = static_cast<const std::byte*>(data);
        for (std::size_t i = 0; i < n_cells; ++i)
            Memory::store_payload(places_.cells + ((tail_ + i) & (cells_ - 1)) * cell_words,
                                  bytes + i * cell_bytes, cell_words, std::memory_order::relaxed);
        tail_ += n_cells;
        Memory::store(*places_.tail, tail_, Orders::publish_tail);
        return true;
    }

    /// Cells that can be pushed now.
    std::uint32_t free_cells() noexcept {
        head_ = Memory::load(*places_.head, Orders::see_head);
        return room();
    }

    /// Cells of the ring.
    std::uint32_t capacity() const noexcept { return cells_; }

  private:
    /// None if the consumer's index is impossible: it has broken its own ring, which then stays full.
    std::uint32_t room() const noexcept {
        const std::uint64_t used = tail_ - head_;
        return used > cells_ ? 0 : cells_ - static_cast<std::uint32_t>(used);
    }

    SpscPlaces<Memory> places_;
    std::uint32_t cells_;
    std::uint64_t tail_;  // private; *places_.tail is only its publication
    std::uint64_t head_;  // as last seen
};

/// The consumer of a ring.
template <class Memory = HardwareMemory, class Orders = SpscOrders>
class BasicSpscConsumer {
  public:
    /// Goes on with the ring of `cells` cells at these places.
    BasicSpscConsumer(SpscPlaces<Memory> places, std::uint32_t cells)
        : places_(places), cells_(cells), head_(Memory::load(*places.head, std::memory_order::relaxed)) {}

    /// Cells that can be read now, at most the ring's capacity. If the producer's index is impossible the
    /// ring is corrupt, and stays so: 0 for ever.
    std::uint32_t available() noexcept {
        if (corrupt_) return 0;
        const std::uint64_t used = Memory::load(*places_.tail, Orders::see_tail) - head_;
        corrupt_ = used > cells_;
        available_ = corrupt_ ? 0 : static_cast<std::uint32_t>(used);
        return available_;
    }

    /// Copies the cells head+at .. head+at+n_cells without consuming them; false if the last call of
    /// available() did not promise that many. Copy once, then validate the copy: a hostile producer may write
    /// at any time.
    bool peek(std::uint32_t at, void* out, std::size_t n_cells) noexcept {
        if (at > available_ || n_cells > available_ - at) return false;
        auto* bytes = static_cast<std::byte*>(out);
        for (std::size_t i = 0; i < n_cells; ++i)
            Memory::load_payload(bytes + i * cell_bytes,
                                 places_.cells + ((head_ + at + i) & (cells_ - 1)) * cell_words, cell_words,
                                 std::memory_order::relaxed);
        return true;
    }

    /// Gives n_cells back to the producer, at most as many as the last call of available() promised.
    void pop(std::uint32_t n_cells) noexcept {
        const std::uint32_t n = std::min(n_cells, available_);
        if (n == 0) return;
        head_ += n;
        available_ -= n;
        Memory::store(*places_.head, head_, Orders::publish_head);
    }

    /// True: the producer's index was impossible.
    bool corrupt() const noexcept { return corrupt_; }

  private:
    SpscPlaces<Memory> places_;
    std::uint32_t cells_;
    std::uint32_t available_ = 0;  // as last seen, less what was popped since
    std::uint64_t head_;           // private; *places_.head is only its publication
    bool corrupt_ = false;
};

/// How the ring lies in a segment, before its cells.
struct alignas(line_bytes) SpscShared {
    /// Cells pushed.
    alignas(line_bytes) std::uint64_t tail;
    /// Cells popped.
    alignas(line_bytes) std::uint64_t head;
};
static_assert(sizeof(SpscShared) == 2 * line_bytes);

/// Bytes of a ring.
constexpr std::size_t spsc_bytes(std::uint32_t cells) {
    return sizeof(SpscShared) + cells * cell_bytes;
}

/// Makes an empty ring. Once, by the process that creates the segment, before it hands it over.
void spsc_init(std::byte* memory);

/// Where a ring lies in `memory`. Checks alignment and `cells` (a power of two); throws
/// std::invalid_argument.
SpscPlaces<> spsc_places(std::byte* memory, std::uint32_t cells);

/// The producer of a ring in a segment. One object per ring and side: an index is private, so a second
/// producer would overwrite the first one's cells.
class SpscProducer : public BasicSpscProducer<> {
  public:
    /// As spsc_places.
    SpscProducer(std::byte* memory, std::uint32_t cells)
        : BasicSpscProducer(spsc_places(memory, cells), cells) {}
};

/// The consumer of a ring in a segment.
class SpscConsumer : public BasicSpscConsumer<> {
  public:
    /// As spsc_places.
    SpscConsumer(std::byte* memory, std::uint32_t cells)
        : BasicSpscConsumer(spsc_places(memory, cells), cells) {}
};

}  // namespace knurl::shm
