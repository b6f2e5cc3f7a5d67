#include <knurl/shm/triple_buffer.hpp>

namespace knurl::shm {

namespace {

void prefetch_for_writing(const void* line) {
#if defined(__x86_64__)
    // The baseline lacks the flag for it, so __builtin_prefetch(p, 1) would prefetch for reading. Every
    // x86-64 processor executes this instruction, the oldest as a no-op.
    asm volatile("prefetchw %0" : : "m"(*static_cast<const char*>(line)));
#else
    __builtin_prefetch(line, 1);
#endif
}

}  // namespace

void TripleReader::prefetch() const noexcept {
    // The usual batch; for longer ones the processor's own prefetcher takes over.
    constexpr std::size_t payload_lines = 4;
    constexpr std::size_t line_words = 64 / sizeof(std::uint64_t);

    // First, so that the load below joins this transfer: a load alone would fetch the line as shared, and the
    // take would have to request it again.
    prefetch_for_writing(places_.mid);
    const std::uint64_t mid = HardwareMemory::load(*places_.mid, std::memory_order::relaxed);
    if (!TripleMid::fresh(mid)) return;
    // Only a hint, but from the other side: bound it before it becomes an address.
    const std::uint32_t index = TripleMid::index(mid);
    if (index > 2) return;
    const std::uint64_t* payload = slot(index);
    const std::size_t words = std::min(payload_lines * line_words, places_.slot_words);
    // Plain loads without a use of their values: as many run in parallel as the processor can track. Unlike
    // prefetch instructions they are never dropped beyond that (measured: 0.63 of a one-pass ring against
    // 0.76).
    for (std::size_t at = 0; at < words; at += line_words) {
        const std::uint64_t value = HardwareMemory::load(payload[at], std::memory_order::relaxed);
        asm volatile("" : : "r"(value));
    }
}

}  // namespace knurl::shm
