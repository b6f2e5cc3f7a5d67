#include <algorithm>

#include <knurl/shm/deadline.hpp>

namespace knurl::shm {

using std::chrono::nanoseconds;

Deadline deadline_after(nanoseconds timeout) noexcept {
    const auto now = std::chrono::steady_clock::now();
    return timeout >= Deadline::max() - now ? Deadline::max() : now + timeout;
}

int poll_until(std::span<pollfd> sources, Deadline deadline) noexcept {
    if (deadline == Deadline::max()) return ::ppoll(sources.data(), sources.size(), nullptr, nullptr);
    const nanoseconds left =
        std::max(nanoseconds(0), nanoseconds(deadline - std::chrono::steady_clock::now()));
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec span{.tv_sec = static_cast<time_t>(seconds.count()), .tv_nsec = (left - seconds).count()};
    return ::ppoll(sources.data(), sources.size(), &span, nullptr);
}

}  // namespace knurl::shm
