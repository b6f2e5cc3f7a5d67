#pragma once

#include <utility>

namespace knurl::shm {

/// Owns a file descriptor. Empty holds -1.
class UniqueFd {
  public:
    /// Empty.
    UniqueFd() = default;
    /// Owns `fd`.
    explicit UniqueFd(int fd) : fd_(fd) {}
    /// Moves; the other one holds nothing any more.
    UniqueFd(UniqueFd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    /// Moves; the other one holds nothing any more.
    UniqueFd& operator=(UniqueFd&& other) noexcept {
        UniqueFd(std::move(other)).swap(*this);
        return *this;
    }
    ~UniqueFd() { reset(); }

    /// The descriptor; -1: none.
    int get() const { return fd_; }
    /// True: it owns one.
    explicit operator bool() const { return fd_ >= 0; }
    /// Gives the descriptor to the caller.
    int release() { return std::exchange(fd_, -1); }
    /// Closes it.
    void reset();
    /// Exchanges two.
    void swap(UniqueFd& other) noexcept { std::swap(fd_, other.fd_); }

  private:
    int fd_ = -1;
};

}  // namespace knurl::shm
