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
///
/// A real-time thread may read it once no other process can take a page away, which would be a page fault:
///
///   the other process only reads:  create, seal_against_new_writers, hold_pages, then hand it over
///   it writes as well:             create, hold_pages, hand it over; it maps it and seals it against new
///                                  writers; then here sealed_against_new_writers and has_every_page
///
/// In the second case the other process seals, since its mapping has to exist before. Besides, sealing takes
/// a lock of the file that the other process can hold for any time; looking at the seals takes none.
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

    /// From here on nobody can map it writable, make a read-only mapping writable, write through the
    /// descriptor, or take pages away (fallocate, MADV_REMOVE). Mappings made before stay writable. Waits
    /// while another process holds the file's lock. Throws std::runtime_error.
    void seal_against_new_writers();

    /// Is it sealed like that? Takes no lock. True: no page has been taken away since it was sealed.
    bool sealed_against_new_writers() const noexcept;

    /// Keeps the pages where they are for as long as this object lives: locks them, where that is allowed,
    /// and holds one page of each huge page. Else whoever maps the segment, if only for reading, could have
    /// the kernel gather it into huge pages (MADV_COLLAPSE), which unmaps it everywhere. Throws
    /// std::runtime_error.
    void hold_pages();

    /// Is every page present in this mapping? Reads a byte of each; those that were taken away since the
    /// mapping was made are back afterwards.
    bool has_every_page() const noexcept;

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
    UniqueFd held_pages_;  // a pipe with a page of each huge page in it; empty: none is held
    std::unique_ptr<Mapping> mapping_;
    std::byte* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace knurl::shm
