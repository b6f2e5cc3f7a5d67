#pragma once

#include <cstdint>

namespace knurl::bridge::test {

std::uint64_t allocations() noexcept;          // calls of operator new by this program so far
std::uint64_t openssl_allocations() noexcept;  // calls of OpenSSL's allocator
std::int64_t openssl_blocks() noexcept;        // OpenSSL's blocks that are not freed yet

}  // namespace knurl::bridge::test
