#pragma once

#include <cstddef>

namespace knurl::test {

/// How often this program has called operator new.
std::size_t allocations() noexcept;

}  // namespace knurl::test
