#include <algorithm>
#include <fstream>

#include <unistd.h>

#include <knurl/servo/memory_budget.hpp>

namespace knurl::servo {

// The second term was measured for 1 to 1024 representations; tests/servo/process_memory.cpp compares it.
std::uint64_t claim_bytes(const protocol::ClaimCapacity& capacity) noexcept {
    constexpr std::uint64_t of_any_scene = 200'000, of_each_representation = 4'100;
    const std::uint64_t segment = protocol::claim_layout(capacity).total;
    if (capacity.representations == 0) return segment;
    return segment + of_any_scene + of_each_representation * capacity.representations;
}

std::uint64_t default_memory_budget() {
    auto memory = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                  static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    std::uint64_t limit = 0;  // "max", which is no number: there is none
    if (std::ifstream("/sys/fs/cgroup/memory.max") >> limit) memory = std::min(memory, limit);
    return memory / 4;
}

}  // namespace knurl::servo
