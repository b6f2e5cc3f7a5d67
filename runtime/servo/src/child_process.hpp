#pragma once
// A process of our own program for work that must not hold up this one.

#include <array>
#include <string>
#include <vector>

#include <sys/types.h>

namespace knurl::servo {

/// Starts `program` with these arguments, and with these descriptors as its standard input and output (-1:
/// ours). It does not run in real time, even if the caller does, and no signal is blocked. `policy`: how it is
/// scheduled. Returns 0 or an errno.
int start_child(const std::string& program, const std::vector<std::string>& arguments,
                const std::array<int, 2>& standard, int policy, pid_t& child);

/// For such a process, first thing: when memory runs short, its size counts as anybody's. The servo's unit
/// protects all its processes (knurld.service: OOMScoreAdjust).
void leave_protection() noexcept;

}  // namespace knurl::servo
