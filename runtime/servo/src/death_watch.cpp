#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>

#include <knurl/servo/death_watch.hpp>

namespace knurl::servo {

namespace {

constexpr std::uint64_t stopping = ~std::uint64_t{0};  // no connection has this number

void add(int epoll, int fd, std::uint32_t events, std::uint64_t number) {
    epoll_event event{.events = events, .data = {.u64 = number}};
    if (::epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event) != 0)
        throw std::runtime_error(fmt::format("knurld: death watch: {}", std::strerror(errno)));
}

}  // namespace

DeathWatch::DeathWatch() : epoll_(::epoll_create1(EPOLL_CLOEXEC)), stop_(::eventfd(0, EFD_CLOEXEC)) {
    if (!epoll_ || !stop_)
        throw std::runtime_error(fmt::format("knurld: death watch: {}", std::strerror(errno)));
    add(epoll_.get(), stop_.get(), EPOLLIN, stopping);
}

void DeathWatch::run() noexcept {
    for (;;) {
        std::array<epoll_event, 32> events;
        const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), -1);
        for (int i = 0; i < count; ++i) {
            const std::uint64_t number = events[static_cast<std::size_t>(i)].data.u64;
            if (number == stopping) return;
            died(number);
        }
    }
}

void DeathWatch::stop() noexcept {
    ::eventfd_write(stop_.get(), 1);
}

void DeathWatch::watch(std::uint64_t connection, int socket) {
    {
        const std::lock_guard lock(mutex_);
        connections_.try_emplace(connection);
    }
    // Once, since the hang-up stays. EPOLLHUP and EPOLLERR come unasked.
    add(epoll_.get(), socket, EPOLLRDHUP | EPOLLONESHOT, connection);
}

void DeathWatch::forget(std::uint64_t connection, int socket) noexcept {
    // An event that was taken before this finds no connection of that number: none is used twice.
    ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, socket, nullptr);
    const std::lock_guard lock(mutex_);
    connections_.erase(connection);
}

void DeathWatch::hold(std::uint64_t connection, Servo& servo, Claim& claim) {
    const std::lock_guard lock(mutex_);
    const auto found = connections_.find(connection);
    if (found == connections_.end()) return;
    found->second.held.push_back({&servo, &claim});
    if (found->second.dead) servo.abandon(&claim);
}

void DeathWatch::release(std::uint64_t connection, const Claim& claim) noexcept {
    const std::lock_guard lock(mutex_);
    if (const auto found = connections_.find(connection); found != connections_.end())
        std::erase_if(found->second.held, [&](const Held& held) { return held.claim == &claim; });
}

void DeathWatch::died(std::uint64_t connection) noexcept {
    const std::lock_guard lock(mutex_);
    const auto found = connections_.find(connection);
    if (found == connections_.end()) return;
    found->second.dead = true;
    // A full mailbox takes no more: then the claim fades when the broker drops it.
    for (const Held& held : found->second.held) held.servo->abandon(held.claim);
}

}  // namespace knurl::servo
