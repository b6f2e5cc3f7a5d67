#pragma once
// What a reader of shared memory may have the kernel do to it.

#include <cerrno>
#include <cstddef>
#include <cstdint>

#include <sys/mman.h>

namespace knurl::test {

/// A read-only mapping that begins where a huge page may.
class HugeView {
  public:
    HugeView(int fd, std::size_t bytes) : bytes_((bytes + huge - 1) / huge * huge) {
        around_ = ::mmap(nullptr, bytes_ + huge, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (around_ == MAP_FAILED) return;
        const auto from = (reinterpret_cast<std::uintptr_t>(around_) + huge - 1) / huge * huge;
        memory_ = ::mmap(reinterpret_cast<void*>(from), bytes_, PROT_READ, MAP_SHARED | MAP_FIXED, fd, 0);
    }
    ~HugeView() { ::munmap(around_, bytes_ + huge); }
    HugeView(const HugeView&) = delete;
    HugeView& operator=(const HugeView&) = delete;
    bool valid() const { return memory_ != MAP_FAILED; }
    /// Has the kernel gather the pages into huge ones, which unmaps them everywhere. Returns 0 or the errno.
    int gather() {
        constexpr int collapse = 25;  // MADV_COLLAPSE, which older headers lack
        return ::madvise(memory_, bytes_, collapse) == 0 ? 0 : errno;
    }

  private:
    static constexpr std::size_t huge = std::size_t{2} << 20;
    std::size_t bytes_;
    void* around_ = MAP_FAILED;
    void* memory_ = MAP_FAILED;
};

}  // namespace knurl::test
