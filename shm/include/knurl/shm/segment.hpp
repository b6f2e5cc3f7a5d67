#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include <knurl/shm/fd.hpp>

namespace knurl::shm {

/// Segments begin on a page, so the same place of every segment falls into the same set of the first-level
/// cache: a servo that looks at one word of each of 128 segments misses each time (measured: 380 ns instead
/// of 90). So what is looked at in segment number n of many lies this much further on; the segment is
/// segment_colour_bytes larger.
inline constexpr std::size_t segment_colour_bytes = 4096;
constexpr std::size_t segment_colour(std::size_t n) {
    return n * 128 % segment_colour_bytes;
}

/// A mapped piece of memory that two processes share: an anonymous file (memfd), so nothing stays behind in
/// the file system after a crash. Its size is sealed: nobody can shrink it under a reader (which would be a
/// SIGBUS).
class Segment {
  public:
    enum class Access { read_write, read_only, private_copy };

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

    Segment() noexcept;  // empty: size() is 0
    Segment(Segment&&) noexcept;
    Segment& operator=(Segment&&) noexcept;
    ~Segment();

    /// From here on nobody can map it writable, make a read-only mapping writable, or write through the
    /// descriptor. Mappings made before stay writable. Throws std::runtime_error.
    void seal_against_new_writers();

    int fd() const { return fd_.get(); }
    std::byte* data() { return data_; }
    const std::byte* data() const { return data_; }
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
