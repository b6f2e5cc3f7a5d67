#pragma once

#include <cstddef>

namespace knurl::test {

/// The number of calls of operator new in this program.
std::size_t allocations() noexcept;

}  // namespace knurl::test
