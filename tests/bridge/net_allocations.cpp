// Replaces operator new, and hooks OpenSSL's allocator before it has allocated anything.

#include "net_allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

#include <openssl/crypto.h>

namespace {

std::atomic<std::uint64_t> by_new{0}, by_openssl{0};
std::atomic<std::int64_t> blocks{0};

void* counted_malloc(std::size_t bytes, const char*, int) {
    ++by_openssl;
    ++blocks;
    return std::malloc(bytes);
}
void* counted_realloc(void* memory, std::size_t bytes, const char*, int) {
    ++by_openssl;
    blocks += memory == nullptr;
    return std::realloc(memory, bytes);
}
void counted_free(void* memory, const char*, int) {
    blocks -= memory != nullptr;
    std::free(memory);
}

const bool openssl_counts =
    CRYPTO_set_mem_functions(counted_malloc, counted_realloc, counted_free) == 1 || (std::abort(), false);

}  // namespace

namespace knurl::bridge::test {

std::uint64_t allocations() noexcept {
    return by_new;
}
std::uint64_t openssl_allocations() noexcept {
    return by_openssl;
}
std::int64_t openssl_blocks() noexcept {
    return blocks;
}

}  // namespace knurl::bridge::test

void* operator new(std::size_t bytes) {
    ++by_new;
    if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
    throw std::bad_alloc();
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    ++by_new;
    return std::malloc(bytes == 0 ? 1 : bytes);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
