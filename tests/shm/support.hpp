#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

#include <knurl/shm/words.hpp>

namespace knurl::shm::test {

/// Memory as a segment would give it: zero, aligned to a page's share.
class Memory {
  public:
    explicit Memory(std::size_t bytes) : storage_(bytes / sizeof(Line) + 1) {}
    std::byte* data() { return storage_.front().bytes; }

  private:
    struct alignas(line_bytes) Line {
        std::byte bytes[line_bytes] = {};
    };
    std::vector<Line> storage_;
};

/// Every word of a record says which record it is and where in it: a torn or misplaced copy shows.
inline std::uint64_t word_of(std::uint64_t number, std::size_t i) {
    return (number + 1) * 0x9E3779B97F4A7C15u ^ (i * 0xC2B2AE3D27D4EB4Fu);
}

template <std::size_t words>
struct Record {
    std::uint64_t word[words];

    static Record numbered(std::uint64_t number) {
        Record record;
        for (std::size_t i = 0; i < words; ++i) record.word[i] = word_of(number, i);
        return record;
    }
    bool is(std::uint64_t number) const {
        for (std::size_t i = 0; i < words; ++i)
            if (word[i] != word_of(number, i)) return false;
        return true;
    }
};

/// KNURL_SEED repeats a run, KNURL_LONG=1 makes it longer.
inline std::uint64_t seed() {
    const char* text = std::getenv("KNURL_SEED");
    return text != nullptr ? std::strtoull(text, nullptr, 0) : 20260117;
}
inline bool long_run() {
    return std::getenv("KNURL_LONG") != nullptr;
}

}  // namespace knurl::shm::test
