#pragma once

/// @file
/// Waiting for descriptors until a point in time.

#include <chrono>
#include <span>

#include <poll.h>

namespace knurl::shm {

/// A point in time.
using Deadline = std::chrono::steady_clock::time_point;

/// `timeout` from now; nanoseconds::max(), and whatever else the clock does not reach, is for ever.
Deadline deadline_after(std::chrono::nanoseconds timeout) noexcept;

/// ppoll(2), at most until then; a deadline in the past only looks.
int poll_until(std::span<pollfd> sources, Deadline deadline) noexcept;

}  // namespace knurl::shm
