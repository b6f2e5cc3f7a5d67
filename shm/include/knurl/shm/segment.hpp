#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include <knurl/shm/fd.hpp>

namespace knurl::shm {

/// Bytes by which a segment is larger, for its colour. Segments begin on a page, so the same place of every
/// segment falls into the same set of the first-level cache: a servo that reads one word of each of 128
/// segments misses each time (measured: 380 ns instead of 90).
inline constexpr std::size_t segment_colour_bytes = 4096;
/// So much further on lies what is read in segment number n of many (bytes).
constexpr std::size_t segment_colour(std::size_t n) {
    return n * 128 % segment_colour_bytes;
}

/// A mapped piece of memory that two processes share: an anonymous file (memfd), so nothing stays behind in
/// the file system after a crash. Its size is sealed: nobody can shrink it under a reader (which would be a
/// SIGBUS).
class Segment {
  public:
    /// How a segment is mapped.
    enum class Access {
        /// For reading and writing.
        read_write,
        /// For reading.
        read_only,
        /// Private pages: writes stay in this process.
        private_copy,
    };

    /// A new segment of `bytes` zero bytes, mapped for writing, its pages present. `name` shows in
    /// /proc/PID/maps. Throws std::runtime_error.
    static Segment create(std::string_view name, std::size_t bytes);

    /// Maps a segment received from another process. Duplicates `fd`. Refuses, before it maps anything, a
    /// descriptor whose size is not exactly `expected_bytes` or is not sealed. Throws std::runtime_error.
    static Segment open(int fd, std::size_t expected_bytes, Access access);

    /// Maps what another process has written and sealed for good: from here on nobody changes a byte of it,
    /// so it may be checked where it lies. Refuses a descriptor whose size is another or that is not sealed
    /// against writing. Private pages: kernels before 6.7 map it no other way. Throws std::runtime_error.
    static Segment open_sealed(int fd, std::size_t expected_bytes);

    /// The writer's end of that: unmaps `written`, seals it and returns its descriptor. Throws
    /// std::runtime_error.
    static UniqueFd seal(Segment written);

    /// Empty: size() is 0.
    Segment() noexcept;
    /// Moves; the other one holds nothing any more.
    Segment(Segment&&) noexcept;
    /// Moves; the other one holds nothing any more.
    Segment& operator=(Segment&&) noexcept;
    ~Segment();

    /// From here on nobody can map it writable, make a read-only mapping writable, or write through the
    /// descriptor. Mappings made before stay writable. Throws std::runtime_error.
    void seal_against_new_writers();

    /// Its descriptor.
    int fd() const { return fd_.get(); }
    /// Its memory.
    std::byte* data() { return data_; }
    /// Its memory.
    const std::byte* data() const { return data_; }
    /// Its size (bytes).
    std::size_t size() const { return size_; }

  private:
    struct Mapping;  // keeps Boost out of this header
    Segment(UniqueFd fd, std::size_t bytes, Access access, std::string_view what);

    UniqueFd fd_;
    std::unique_ptr<Mapping> mapping_;
    std::byte* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace knurl::shm
