#include <knurl/shm/triple_buffer.hpp>

namespace knurl::shm {

namespace {

void prefetch_for_writing(const void* line) {
#if defined(__x86_64__)
    // The baseline has no flag for it, so __builtin_prefetch(p, 1) would be a prefetch for reading; every
    // x86-64 processor executes this instruction, the oldest as a no-op.
    asm volatile("prefetchw %0" : : "m"(*static_cast<const char*>(line)));
#else
    __builtin_prefetch(line, 1);
#endif
}

}  // namespace

void TripleReader::prefetch() const noexcept {
    constexpr std::size_t payload_lines = 4;  // the usual batch; a longer one has the stream's own prefetch
    constexpr std::size_t cache_line = 64;

    const std::uint64_t mid = HardwareMemory::load(*places_.mid, std::memory_order::relaxed);
    if (!TripleMid::fresh(mid)) return;
    prefetch_for_writing(places_.mid);
    // Only a hint, but it comes from the other side: bound it before it makes an address.
    const std::uint32_t index = TripleMid::index(mid);
    if (index > 2) return;
    const auto* payload = reinterpret_cast<const char*>(slot(index));
    const std::size_t bytes =
        std::min(payload_lines * cache_line, places_.slot_words * sizeof(std::uint64_t));
    for (std::size_t at = 0; at < bytes; at += cache_line) __builtin_prefetch(payload + at);
}

}  // namespace knurl::shm
