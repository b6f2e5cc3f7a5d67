#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include <knurl/link/fork_guard.hpp>

namespace knurl::capi {

/// The one T of this process: the child of a fork gets a fresh one, since the parent's may be locked by a
/// thread that the child has not. For the same reason no lock is taken to make it. Never freed: threads may
/// use it while the process ends.
template <class T>
T& of_this_process() {
    struct Made {
        std::uint64_t in = detail::fork_generation();
        T value;
    };
    static std::atomic<Made*> current{nullptr};
    Made* found = current.load(std::memory_order_acquire);
    while (found == nullptr || found->in != detail::fork_generation()) {
        auto fresh = std::make_unique<Made>();
        if (current.compare_exchange_strong(found, fresh.get(), std::memory_order_acq_rel))
            return fresh.release()->value;
    }
    return found->value;
}

}  // namespace knurl::capi
