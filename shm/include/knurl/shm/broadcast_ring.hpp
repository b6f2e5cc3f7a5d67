#pragma once

/// @file
/// Reports: one writer, any number of readers whose mapping is read-only. A slow reader never delays the
/// writer, and knows exactly how many reports it missed. One counter, `end`, the number of reports published;
/// report n lies in slot n mod slots; the last slots-1 can be read.
///
/// ~~~{.unparsed}
///   writer:  words of report n (each rel); end.store(n+1, rel)
///   reader:  h = end (acq); if report n is readable under h: copy its words (each acq);
///            e = end (relaxed): if n is readable under e the copy is whole, else it was overwritten meanwhile
///
///   writer:  end = n+slots ─sb─> word of report n+slots (rel)
///                                   ║ sw, if the reader saw that word
///   reader:                      reads the word (acq) ─sb─> reads end  ⇒ sees n+slots or more ⇒ rejects
/// ~~~
///
/// A word of the overwriting report carries `end` with it. Fences around relaxed words do the same; on x86
/// both compile to plain moves, and the sanitizer understands this one. An acquire on the second read of
/// `end` alone would not do. A writer killed anywhere leaves `end` true, and the one torn slot lies outside
/// the readable ones: no repair.

#include <algorithm>

#include <knurl/shm/words.hpp>

namespace knurl::shm {

/// Memory orders of the ring. The models in tests/shm weaken them one by one.
struct BroadcastOrders {
    /// Pairs with see_end: report n is whole.
    static constexpr auto publish_end = std::memory_order::release;
    /// Pairs with publish_end.
    static constexpr auto see_end = std::memory_order::acquire;
    /// Pairs with get_word.
    static constexpr auto put_word = std::memory_order::release;
    /// Pairs with put_word.
    static constexpr auto get_word = std::memory_order::acquire;
    /// Ordered by get_word.
    static constexpr auto check_end = std::memory_order::relaxed;

    /// True: report n can be read while `end` reports are published, since it is one of the last slots-1. The
    /// slot of report end-slots is the one that the writer is filling now. Unsigned: also false for n >= end.
    static constexpr bool readable(std::uint64_t n, std::uint64_t end, std::uint64_t slots) {
        return end - n - 1 < slots - 1;
    }
};

/// Where a ring lies in memory.
template <class Memory = HardwareMemory>
struct BroadcastPlaces {
    /// Number of reports published.
    typename Memory::Word* end;
    /// The slots.
    typename Memory::Payload* slots;
    /// Number of slots, a power of two.
    std::uint32_t count;
    /// Words from one slot to the next.
    std::size_t stride_words;
    /// Words of a slot's payload.
    std::size_t slot_words;
};

/// The writer of a ring.
template <class Memory = HardwareMemory, class Orders = BroadcastOrders>
class BasicBroadcastWriter {
  public:
    /// Goes on with the ring at these places.
    explicit BasicBroadcastWriter(BroadcastPlaces<Memory> places)
        : places_(places), end_(Memory::load(*places.end, std::memory_order::relaxed)) {}

    /// Publishes a report of slot_words words. Wait-free.
    void publish(const void* report) noexcept {
        Memory::store_payload(places_.slots + (end_ & (places_.count - 1)) * places_.stride_words, report,
                              places_.slot_words, Orders::put_word);
        Memory::store(*places_.end, ++end_, Orders::publish_end);
    }

    /// Number of reports published.
    std::uint64_t published() const noexcept { return end_; }

  private:
    BroadcastPlaces<Memory> places_;
    std::uint64_t end_;  // private; *places_.end is only its publication
};

/// A reader of a ring.
template <class Memory = HardwareMemory, class Orders = BroadcastOrders>
class BasicBroadcastReader {
  public:
    /// As `start`: begin with the newest report that is there (or the first one, if none is).
    static constexpr std::uint64_t newest = ~std::uint64_t{0};
    /// If the writer overtakes the reader so often in one call, the reader gives up until the next call.
    static constexpr int max_attempts = 64;

    /// Reads from report `start` on.
    explicit BasicBroadcastReader(BroadcastPlaces<Memory> places, std::uint64_t start = newest)
        : places_(places), next_(start) {
        if (start != newest) return;
        const std::uint64_t end = published();
        next_ = end == 0 ? 0 : end - 1;
    }

    /// The next report in order. Reports that were overwritten before they could be read are counted as
    /// missed and left out. False: nothing new; `out` may hold anything then.
    bool next(void* out) noexcept {
        for (int attempt = 0; attempt < max_attempts; ++attempt) {
            const std::uint64_t end = published();
            if (end <= next_) return false;
            const std::uint64_t oldest = end - next_ < places_.count ? next_ : end - (places_.count - 1);
            missed_ += oldest - next_;
            next_ = oldest;
            if (copy(next_, out)) {
                ++next_;
                return true;
            }
        }
        return false;
    }

    /// As next(), of up to `most` reports at once: report i goes to out + i * stride (bytes). Returns how many;
    /// what was missed lies before the first of them. Room beyond may hold anything then.
    ///
    /// The writer's counter is looked at once before and once after all of them, since each look takes its line
    /// away from the writer. The oldest is overwritten first: if it was whole at the end, so are the others.
    std::size_t next_some(std::byte* out, std::size_t stride, std::size_t most) noexcept {
        for (int attempt = 0; attempt < max_attempts; ++attempt) {
            const std::uint64_t end = published();
            if (end <= next_) return 0;
            const std::uint64_t oldest = end - next_ < places_.count ? next_ : end - (places_.count - 1);
            missed_ += oldest - next_;
            next_ = oldest;
            const std::size_t some = std::min<std::uint64_t>(most, end - next_);
            for (std::size_t i = 0; i < some; ++i) {
                // From the writer's cache; none beyond the last, where the writer is at work.
                if (i + ahead < some) Memory::prefetch(slot(next_ + i + ahead), places_.slot_words);
                load(next_ + i, out + i * stride);
            }
            if (is_readable(next_)) {
                next_ += some;
                return some;
            }
            // Overtaken: the fewer, the sooner they are copied.
            most = (some + 1) / 2;
        }
        return 0;
    }

    /// The newest report, if it is newer than the last one that was read. Those between are counted as
    /// skipped, not as missed: the caller did not want them. False: nothing new; `out` may hold anything
    /// then.
    bool latest(void* out) noexcept {
        for (int attempt = 0; attempt < max_attempts; ++attempt) {
            const std::uint64_t end = published();
            if (end <= next_) return false;
            if (copy(end - 1, out)) {
                skipped_ += end - 1 - next_;
                next_ = end;
                return true;
            }
        }
        return false;
    }

    /// Report n, if it can still (and already) be read; moves nothing. Reads a flight recorder.
    bool at(std::uint64_t n, void* out) const noexcept {
        return Orders::readable(n, published(), places_.count) && copy(n, out);
    }

    /// True: next() or latest() has something to read (or the writer has restarted).
    bool fresh() const noexcept { return published() != next_; }
    /// How many reports that is, those that were overwritten included.
    std::uint64_t unread() const noexcept {
        const std::uint64_t end = published();
        return end > next_ ? end - next_ : 0;
    }
    /// Number of reports published.
    std::uint64_t published() const noexcept { return Memory::load(*places_.end, Orders::see_end); }
    /// The number of the report that next() would read. position() - start == read + missed() + skipped().
    std::uint64_t position() const noexcept { return next_; }
    /// Reports that were overwritten before they were read.
    std::uint64_t missed() const noexcept { return missed_; }
    /// Reports that latest() passed over.
    std::uint64_t skipped() const noexcept { return skipped_; }
    /// True: the counter is behind this reader, so this is not the ring to which it attached. Attach again.
    bool restarted() const noexcept { return published() < next_; }

    /// The word that the writer publishes last.
    const typename Memory::Word& end_word() const noexcept { return *places_.end; }

  private:
    /// Reports that next_some() asks for before it copies them.
    static constexpr std::size_t ahead = 4;

    /// Whole, or false. The test comes after the copy: a reader that is preempted in the middle is the normal
    /// case.
    bool copy(std::uint64_t n, void* out) const noexcept {
        load(n, out);
        return is_readable(n);
    }
    void load(std::uint64_t n, void* out) const noexcept {
        Memory::load_payload(out, slot(n), places_.slot_words, Orders::get_word);
    }
    const typename Memory::Payload* slot(std::uint64_t n) const noexcept {
        return places_.slots + (n & (places_.count - 1)) * places_.stride_words;
    }
    bool is_readable(std::uint64_t n) const noexcept {
        return Orders::readable(n, Memory::load(*places_.end, Orders::check_end), places_.count);
    }

    BroadcastPlaces<Memory> places_;
    std::uint64_t next_;
    std::uint64_t missed_ = 0;
    std::uint64_t skipped_ = 0;
};

/// Slots begin on a cache line (bytes).
inline constexpr std::size_t broadcast_slot_unit = 64;

/// Bytes of a ring.
constexpr std::size_t broadcast_bytes(std::uint32_t slots, std::size_t slot_bytes) {
    return line_bytes + slots * round_up(slot_bytes, broadcast_slot_unit);
}

/// Makes an empty ring. Once, by the process that creates the segment, before it hands it over.
void broadcast_init(std::byte* memory);

/// Where a ring lies in `memory`. Checks alignment, `slots` (a power of two) and `slot_bytes` (a multiple of
/// 8); throws std::invalid_argument.
BroadcastPlaces<> broadcast_places(const std::byte* memory, std::uint32_t slots, std::size_t slot_bytes);

/// The writer of a ring in a segment.
class BroadcastWriter : public BasicBroadcastWriter<> {
  public:
    /// As broadcast_places.
    BroadcastWriter(std::byte* memory, std::uint32_t slots, std::size_t slot_bytes)
        : BasicBroadcastWriter(broadcast_places(memory, slots, slot_bytes)) {}
};

/// Only loads: `memory` may be mapped read-only. Objects are independent; each has its own position.
class BroadcastReader : public BasicBroadcastReader<> {
  public:
    /// As broadcast_places; reads from report `start` on.
    BroadcastReader(const std::byte* memory, std::uint32_t slots, std::size_t slot_bytes,
                    std::uint64_t start = newest)
        : BasicBroadcastReader(broadcast_places(memory, slots, slot_bytes), start) {}
};

}  // namespace knurl::shm
