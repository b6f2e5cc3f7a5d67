#pragma once
#include <cstdint>

namespace knurl::drivers {

/// Calls of malloc and its relatives by this thread so far, operator new included.
std::uint64_t allocations() noexcept;

}  // namespace knurl::drivers
