#pragma once

/// @file
/// Newest wins: one writer, one reader, three slots and one word `mid`. The writer owns the slot `back`, the
/// reader owns `front`, and `mid` names the third, says whether it is fresh, and carries the writer's tag.
/// Publishing and taking are one exchange each: a batch arrives whole or not at all, nothing is ever full,
/// and nothing waits.
///
/// ~~~{.unparsed}
///   writer: write back ────────────sb──> exchange(mid) ══sw══> exchange(mid) ─sb─> reader reads front
///   reader: last read of old front ─sb─> exchange(mid) ══sw══> exchange(mid) ─sb─> writer reuses it as back
/// ~~~
///
/// Publishing tells the writer whether the batch before was taken. If it was not, it has just been replaced,
/// and a writer that must lose nothing has to have merged it into the new one.
///
/// The tag lets the reader decline: each parameter batch is tagged with the number of commands issued before
/// it, and the servo takes it only once it has done those. A tag beside `mid` could change between looking
/// and taking, hence it lies inside: the reader takes by compare-exchange, so that what it takes is what it
/// looked at.

#include <algorithm>
#include <optional>
#include <span>

#include <knurl/shm/words.hpp>

namespace knurl::shm {

/// Memory orders of the buffer. The models in tests/shm weaken them one by one.
struct TripleOrders {
    /// Pairs with take, both ways.
    static constexpr auto publish = std::memory_order::acq_rel;
    /// Pairs with publish, both ways.
    static constexpr auto take = std::memory_order::acq_rel;
};

/// The word `mid`: which slot, whether it is fresh, and the tag.
struct TripleMid {
    /// Bits of the slot.
    static constexpr std::uint64_t index_mask = 3;
    /// Set: not taken yet.
    static constexpr std::uint64_t fresh_bit = 4;
    /// Where the tag begins.
    static constexpr unsigned tag_shift = 8;

    /// Makes the word.
    static constexpr std::uint64_t make(std::uint64_t index, bool fresh, std::uint64_t tag) {
        return index | (fresh ? fresh_bit : 0) | (tag << tag_shift);
    }
    /// Its slot.
    static constexpr std::uint32_t index(std::uint64_t mid) {
        return static_cast<std::uint32_t>(mid & index_mask);
    }
    /// True: not taken yet.
    static constexpr bool fresh(std::uint64_t mid) { return (mid & fresh_bit) != 0; }
    /// Its tag.
    static constexpr std::uint64_t tag(std::uint64_t mid) { return mid >> tag_shift; }
};

/// Largest tag; tags have 56 bits.
inline constexpr std::uint64_t max_triple_tag = (std::uint64_t{1} << 56) - 1;

/// Where a buffer lies in memory.
template <class Memory = HardwareMemory>
struct TriplePlaces {
    /// The word `mid`.
    typename Memory::Word* mid;
    /// Three slots.
    typename Memory::Payload* slots;
    /// Words of a slot's payload.
    std::size_t slot_words;
    /// Words from one slot to the next.
    std::size_t stride_words;
};

/// Slot that the writer owns at first.
inline constexpr std::uint32_t triple_first_back = 0;
/// Slot that `mid` names at first.
inline constexpr std::uint32_t triple_first_mid = 1;
/// Slot that the reader owns at first.
inline constexpr std::uint32_t triple_first_front = 2;

/// The writer of a buffer.
template <class Memory = HardwareMemory, class Orders = TripleOrders>
class BasicTripleWriter {
  public:
    /// Begins with the empty buffer at these places.
    explicit BasicTripleWriter(TriplePlaces<Memory> places) : places_(places) {}

    /// Copies the parts one after the other (each a multiple of 8 bytes, together at most a slot; what goes
    /// beyond is cut off) and makes them visible at once. Returns whether the batch before this one was
    /// taken.
    bool publish(std::uint64_t tag, std::span<const std::span<const std::byte>> parts) noexcept {
        auto* to = places_.slots + back_ * places_.stride_words;
        std::size_t room = places_.slot_words;
        for (const std::span<const std::byte> part : parts) {
            const std::size_t words = std::min(part.size() / sizeof(std::uint64_t), room);
            Memory::store_payload(to, part.data(), words, std::memory_order::relaxed);
            to += words;
            room -= words;
        }
        return hand_over(tag);
    }
    /// The same with the tag 0.
    bool publish(std::span<const std::span<const std::byte>> parts) noexcept { return publish(0, parts); }

    /// One part; `bytes` is a multiple of 8.
    bool publish(const void* data, std::size_t bytes, std::uint64_t tag = 0) noexcept {
        const std::span<const std::byte> part(static_cast<const std::byte*>(data), bytes);
        return publish(tag, {&part, 1});
    }

    /// For a writer that keeps its slots up to date instead of copying all anew. Only it ever writes them, so
    /// each still holds what was published from it: write() what differs from that, then publish_written().
    /// This is the slot that both are about, 0 to 2.
    std::uint32_t back() const noexcept { return back_; }
    /// Writes a part of the slot back(). `offset` and `bytes` are multiples of 8; what goes beyond the slot
    /// is cut off.
    void write(std::size_t offset, const void* data, std::size_t bytes) noexcept {
        const std::size_t first = std::min(offset / sizeof(std::uint64_t), places_.slot_words);
        const std::size_t words = std::min(bytes / sizeof(std::uint64_t), places_.slot_words - first);
        Memory::store_payload(places_.slots + back_ * places_.stride_words + first, data, words,
                              std::memory_order::relaxed);
    }
    /// Publishes the slot back(). Returns whether the batch before this one was taken.
    bool publish_written(std::uint64_t tag = 0) noexcept { return hand_over(tag); }

    /// True: the reader has written nonsense into `mid`. Publishing stays harmless and reaches nobody.
    bool corrupt() const noexcept { return corrupt_; }

  private:
    bool hand_over(std::uint64_t tag) noexcept {
        const std::uint64_t old = Memory::exchange(
            *places_.mid, TripleMid::make(back_, true, std::min(tag, max_triple_tag)), Orders::publish);
        const std::uint32_t index = TripleMid::index(old);
        if (index > 2 || index == back_)
            corrupt_ = true;  // keep `back`: whatever the reader reads there is its own fault
        else
            back_ = index;
        return !TripleMid::fresh(old);
    }

    TriplePlaces<Memory> places_;
    std::uint32_t back_ = triple_first_back;  // private: never read from shared memory
    bool corrupt_ = false;
};

/// The reader of a buffer.
template <class Memory = HardwareMemory, class Orders = TripleOrders>
class BasicTripleReader {
  public:
    /// A take that the writer interrupts so often gives up until the next call: the reader is wait-free.
    static constexpr int max_attempts = 4;

    /// Begins with the empty buffer at these places.
    explicit BasicTripleReader(TriplePlaces<Memory> places) : places_(places) {}

    /// True: something can be taken. A relaxed look at `mid`.
    bool fresh() const noexcept {
        return TripleMid::fresh(Memory::load(*places_.mid, std::memory_order::relaxed));
    }

    /// The tag of what can be taken now, if anything can. It may have been replaced by the time of the take.
    std::optional<std::uint64_t> pending_tag() const noexcept {
        const std::uint64_t mid = Memory::load(*places_.mid, std::memory_order::relaxed);
        if (!TripleMid::fresh(mid)) return std::nullopt;
        return TripleMid::tag(mid);
    }

    /// Takes the newest batch if there is one and its tag is at most `max_tag`. False: front() is as it was.
    bool take(std::uint64_t max_tag = max_triple_tag) noexcept {
        if (corrupt_) return false;
        std::uint64_t mid = Memory::load(*places_.mid, std::memory_order::relaxed);
        for (int attempt = 0; attempt < max_attempts; ++attempt) {
            if (!TripleMid::fresh(mid) || TripleMid::tag(mid) > max_tag) return false;
            const std::uint32_t index = TripleMid::index(mid);
            if (index > 2 || index == front_) {
                corrupt_ = true;
                return false;
            }
            if (Memory::compare_exchange(*places_.mid, mid, TripleMid::make(front_, false, 0),
                                         Orders::take)) {
                front_ = index;
                front_tag_ = TripleMid::tag(mid);
                return true;
            }
        }
        return false;
    }

    /// Copies `bytes` of what was taken last, from `offset` on; both multiples of 8, within the slot (what
    /// goes beyond is left alone). A hostile writer may scribble meanwhile: copy once, then validate the
    /// copy.
    void copy(void* out, std::size_t offset, std::size_t bytes) const noexcept {
        const std::size_t first = std::min(offset / sizeof(std::uint64_t), places_.slot_words);
        const std::size_t words = std::min(bytes / sizeof(std::uint64_t), places_.slot_words - first);
        Memory::load_payload(out, slot(front_) + first, words, std::memory_order::relaxed);
    }

    /// Tag of what was taken last.
    std::uint64_t front_tag() const noexcept { return front_tag_; }

    /// True: the writer has written nonsense into `mid`, and nothing will be taken any more.
    bool corrupt() const noexcept { return corrupt_; }

  protected:
    /// Memory of a slot.
    const typename Memory::Payload* slot(std::uint32_t index) const noexcept {
        return places_.slots + index * places_.stride_words;
    }

    /// Where the buffer lies.
    TriplePlaces<Memory> places_;
    /// Slot that the reader owns; never read from shared memory.
    std::uint32_t front_ = triple_first_front;
    /// As front_tag().
    std::uint64_t front_tag_ = 0;
    /// As corrupt().
    bool corrupt_ = false;
};

/// Bytes of a buffer: three slots of `slot_bytes` (a multiple of 8) behind the line of `mid`.
constexpr std::size_t triple_bytes(std::size_t slot_bytes) {
    return line_bytes + 3 * round_up(slot_bytes, line_bytes);
}

/// Makes an empty buffer. Once, by the process that creates the segment, before it hands it over.
void triple_init(std::byte* memory);

/// Where a buffer lies in `memory`. Checks alignment and `slot_bytes`; throws std::invalid_argument.
TriplePlaces<> triple_places(std::byte* memory, std::size_t slot_bytes);

/// The writer of a buffer in a segment. One object per side for the life of the segment: which slot is whose
/// is private and cannot be found out again.
class TripleWriter : public BasicTripleWriter<> {
  public:
    /// As triple_places.
    TripleWriter(std::byte* memory, std::size_t slot_bytes)
        : BasicTripleWriter(triple_places(memory, slot_bytes)) {}
};

/// The reader of a buffer in a segment.
class TripleReader : public BasicTripleReader<> {
  public:
    /// As triple_places.
    TripleReader(std::byte* memory, std::size_t slot_bytes)
        : BasicTripleReader(triple_places(memory, slot_bytes)) {}

    /// The first of two passes over many buffers: starts the transfers of `mid` (for writing) and of the
    /// first lines of what is pending. By the time of the second pass, take and copy, all of them have
    /// arrived together.
    void prefetch() const noexcept;

    /// The slot taken last, until the next take. For looking at; copy() is the access that races with nobody.
    const std::byte* front() const noexcept { return reinterpret_cast<const std::byte*>(slot(front_)); }
};

}  // namespace knurl::shm
