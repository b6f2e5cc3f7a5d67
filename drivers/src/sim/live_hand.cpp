#include "sim/live_hand.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace knurl::drivers {

namespace {

constexpr std::array<double, 3> metres_per_count = {0.2e-3, 0.2e-3, 2e-3};  // mouse, mouse, wheel
constexpr double metres_per_place = 10e-6;                                  // of absolute axes
constexpr double key_speed = 0.05;                                          // m/s
constexpr double follow_time = 0.03;  // s: a mouse moves in steps, a hand does not

constexpr std::array<std::uint16_t, 6> moving_keys = {KEY_LEFT, KEY_RIGHT,    KEY_DOWN,
                                                      KEY_UP,   KEY_PAGEDOWN, KEY_PAGEUP};
constexpr std::array<std::uint16_t, 4> button_keys = {BTN_LEFT, BTN_RIGHT, BTN_MIDDLE, KEY_SPACE};

constexpr const char* where_they_are =
    "/dev/input/by-id names mice (-event-mouse) and keyboards (-event-kbd)";

/// An event node, or a pipe with the same records from a program.
bool gives_events(int node) noexcept {
    int version = 0;
    if (ioctl(node, EVIOCGVERSION, &version) == 0) return true;
    struct stat status {};
    return fstat(node, &status) == 0 && S_ISFIFO(status.st_mode);
}

/// Only the listener writes, so no other store can come between load and store.
template <class T>
void add(std::atomic<T>& to, T value) noexcept {
    to.store(to.load(std::memory_order_relaxed) + value, std::memory_order_relaxed);
}
void put(std::atomic<std::uint32_t>& to, std::size_t bit, bool on) noexcept {
    const std::uint32_t mask = 1u << bit, now = to.load(std::memory_order_relaxed);
    to.store(on ? now | mask : now & ~mask, std::memory_order_relaxed);
}

}  // namespace

LiveHand::LiveHand(const std::string& paths, double reach) : reach_(reach) {
    const auto close_all = [this] {
        for (const int node : nodes_) close(node);
        if (stop_ >= 0) close(stop_);
    };
    for (std::size_t at = 0; at <= paths.size();) {
        const std::size_t end = std::min(paths.find(':', at), paths.size());
        const std::string path = paths.substr(at, end - at);
        at = end + 1;
        const int node = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        if (node < 0) {
            const std::string why = std::strerror(errno);
            const std::string mend = errno == EACCES
                                         ? "; sudo usermod --append --groups input $USER, then log in again"
                                         : std::string("; ") + where_they_are;
            close_all();
            throw std::runtime_error("live=" + paths + ": cannot open \"" + path + "\": " + why + mend);
        }
        nodes_.push_back(node);
        if (!gives_events(node)) {
            close_all();
            throw std::runtime_error("live=" + paths + ": \"" + path + "\" is no input device; " +
                                     where_they_are);
        }
    }
    stop_ = eventfd(0, EFD_CLOEXEC);
    if (stop_ < 0) {
        close_all();
        throw std::runtime_error("live=" + paths + ": eventfd: " + std::strerror(errno));
    }
    listener_ = std::thread([this] { listen(); });
}

LiveHand::~LiveHand() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = write(stop_, &one, sizeof one);  // an eventfd accepts it
    listener_.join();
    for (const int node : nodes_) close(node);
    close(stop_);
}

void LiveHand::listen() noexcept {
    constexpr std::size_t most = 8;
    std::array<pollfd, most + 1> waits{};
    const std::size_t n = std::min(nodes_.size(), most);
    for (std::size_t i = 0; i < n; ++i) waits[i] = {.fd = nodes_[i], .events = POLLIN, .revents = 0};
    waits[n] = {.fd = stop_, .events = POLLIN, .revents = 0};
    while (waits[n].revents == 0) {
        if (poll(waits.data(), n + 1, -1) < 0 && errno != EINTR) return;
        for (std::size_t i = 0; i < n; ++i) {
            if (waits[i].revents == 0) continue;
            input_event event{};
            ssize_t got = 0;
            while ((got = read(waits[i].fd, &event, sizeof event)) == static_cast<ssize_t>(sizeof event))
                take(event);
            // Unplugged, or its writer has gone: the hand stays where it is, and all keys count as released.
            if (got >= 0 || (errno != EAGAIN && errno != EINTR)) {
                waits[i].fd = -1;
                held_.store(0, std::memory_order_relaxed);
                buttons_.store(0, std::memory_order_relaxed);
            }
        }
    }
}

void LiveHand::take(const input_event& event) noexcept {
    if (event.type == EV_REL) {
        if (event.code == REL_X) add(counts_[0], std::int64_t{event.value});
        if (event.code == REL_Y) add(counts_[1], -std::int64_t{event.value});  // away from the user is up
        if (event.code == REL_WHEEL) add(counts_[2], std::int64_t{event.value});
    }
    if (event.type == EV_ABS && event.code <= ABS_Z) {
        // The place and its number in one word, so that the cycle takes the one with the other.
        const std::uint64_t before = places_[event.code].load(std::memory_order_relaxed);
        const auto place = static_cast<std::uint32_t>(event.value);
        places_[event.code].store(((before >> 32) + 1) << 32 | place, std::memory_order_relaxed);
    }
    if (event.type != EV_KEY || event.value == 2) return;  // 2: repetition
    for (std::size_t key = 0; key < moving_keys.size(); ++key)
        if (event.code == moving_keys[key]) put(held_, key, event.value != 0);
    for (std::size_t button = 0; button < button_keys.size(); ++button)
        if (event.code == button_keys[button]) put(buttons_, button % 3, event.value != 0);
}

MotionSample LiveHand::wanted(double h) noexcept {
    const std::uint32_t held = held_.load(std::memory_order_relaxed);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t counts = counts_[axis].load(std::memory_order_relaxed);
        const auto way =
            static_cast<int>(held >> (2 * axis + 1) & 1) - static_cast<int>(held >> (2 * axis) & 1);
        target_[static_cast<int>(axis)] +=
            static_cast<double>(counts - taken_[axis]) * metres_per_count[axis] + way * key_speed * h;
        taken_[axis] = counts;
        const std::uint64_t place = places_[axis].load(std::memory_order_relaxed);
        if (place == placed_[axis]) continue;
        placed_[axis] = place;
        target_[static_cast<int>(axis)] = static_cast<std::int32_t>(place & 0xffffffff) * metres_per_place;
    }
    const double length = target_.norm();
    if (length > reach_) target_ *= reach_ / length;
    const Eigen::Vector3d step = -std::expm1(-h / follow_time) * (target_ - place_);
    place_ += step;
    MotionSample sample;
    sample.position = place_;
    if (h > 0) sample.velocity = step / h;
    return sample;
}

}  // namespace knurl::drivers
