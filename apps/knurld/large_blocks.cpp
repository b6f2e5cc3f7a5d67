// Large blocks of memory come from the kernel one by one, and go back to it one by one. All memory of knurld is
// locked, and malloc cannot give back locked pages in the middle of its heap: twelve full houses of clients once
// left 470 MB. Only small blocks, which fit into each other's gaps, are malloc's.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <map>
#include <mutex>
#include <new>

#include <sys/mman.h>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

constexpr std::size_t large = 16 * 1024;
constexpr std::size_t page = 4096;

template <class T>
struct FromMalloc {
    using value_type = T;
    FromMalloc() = default;
    template <class U>
    FromMalloc(const FromMalloc<U>&) noexcept {}
    T* allocate(std::size_t n) {
        if (void* memory = std::malloc(n * sizeof(T))) return static_cast<T*>(memory);
        throw std::bad_alloc();
    }
    void deallocate(T* memory, std::size_t) noexcept { std::free(memory); }
    bool operator==(const FromMalloc&) const noexcept { return true; }
};

/// The blocks that are mappings of their own, with their sizes. Real-time threads allocate nothing, so none of
/// them waits for this.
struct Mappings {
    std::mutex mutex;
    std::map<void*, std::size_t, std::less<>, FromMalloc<std::pair<void* const, std::size_t>>> sizes;
};
// Never destroyed: static objects free their memory after it would be.
Mappings& mappings() {
    alignas(Mappings) static std::byte memory[sizeof(Mappings)];
    static Mappings* const made = new (memory) Mappings;
    return *made;
}

void* map_block(std::size_t bytes) {
    const std::size_t size = (bytes + page - 1) / page * page;
    void* const block = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (block == MAP_FAILED) return nullptr;
    Mappings& all = mappings();
    const std::lock_guard lock(all.mutex);
    all.sizes.emplace(block, size);
    return block;
}

void* new_block(std::size_t bytes, std::size_t alignment) {
    if (bytes >= large && bytes < PTRDIFF_MAX && alignment <= page) return map_block(bytes);
    if (alignment <= alignof(std::max_align_t)) return std::malloc(bytes > 0 ? bytes : 1);
    return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
}

void* block_or_throw(std::size_t bytes, std::size_t alignment) {
    for (;;) {
        if (void* block = new_block(bytes, alignment)) return block;
        const std::new_handler handler = std::get_new_handler();
        if (handler == nullptr) throw std::bad_alloc();
        handler();
    }
}

void give_back(void* block) noexcept {
    // Few of malloc's blocks begin with a page.
    if (reinterpret_cast<std::uintptr_t>(block) % page == 0 && block != nullptr) {
        Mappings& all = mappings();
        const std::lock_guard lock(all.mutex);
        if (const auto found = all.sizes.find(block); found != all.sizes.end()) {
            ::munmap(block, found->second);
            all.sizes.erase(found);
            return;
        }
    }
    std::free(block);
}

}  // namespace

// The standard library's other forms (arrays, nothrow) call these.
void* operator new(std::size_t bytes) {
    return block_or_throw(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return block_or_throw(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* block) noexcept {
    give_back(block);
}
void operator delete(void* block, std::size_t) noexcept {
    give_back(block);
}
void operator delete(void* block, std::align_val_t) noexcept {
    give_back(block);
}
void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
    give_back(block);
}

#endif
