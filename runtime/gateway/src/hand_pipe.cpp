#include "hand_pipe.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fcntl.h>
#include <linux/input.h>
#include <sys/stat.h>
#include <unistd.h>

namespace knurl::gateway {

HandPipe::HandPipe(const std::string& address) {
    constexpr std::string_view key = ",live=";
    const std::size_t at = address.find(key);
    if (!address.starts_with("sim:") || at == std::string::npos) return;
    std::string paths = address.substr(at + key.size());
    paths.resize(std::min(paths.find(','), paths.size()));
    for (std::size_t from = 0; from <= paths.size() && !can_pull();) {
        const std::size_t end = std::min(paths.find(':', from), paths.size());
        const std::string path = paths.substr(from, end - from);
        from = end + 1;
        struct stat status {};
        if (::stat(path.c_str(), &status) != 0 || !S_ISFIFO(status.st_mode)) continue;
        // Fails where nobody reads.
        pipe_ = shm::UniqueFd(::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
    }
}

void HandPipe::pull(const Vec3& target) const noexcept {
    if (!can_pull()) return;
    constexpr double unit = 10e-6, most = 10;  // m
    const std::array<double, 3> places{target.x, target.y, target.z};
    std::array<input_event, 3> events{};
    for (std::size_t axis = 0; axis < places.size(); ++axis) {
        if (!std::isfinite(places[axis])) return;
        events[axis].type = EV_ABS;
        events[axis].code = static_cast<std::uint16_t>(ABS_X + axis);
        events[axis].value =
            static_cast<std::int32_t>(std::lround(std::clamp(places[axis], -most, most) / unit));
    }
    // Three records are less than PIPE_BUF: all of them or none.
    [[maybe_unused]] const ssize_t written = ::write(pipe_.get(), events.data(), sizeof events);
}

}  // namespace knurl::gateway
