#include "core.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/epoll.h>

#include <knurl/client/error.hpp>

namespace knurl::vrpn {

Loop::Loop() : epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
    if (!epoll_) throw std::runtime_error(fmt::format("epoll_create1: {}", std::strerror(errno)));
}

void Loop::add(int fd, std::uint32_t events, Ready& ready) {
    epoll_event event{.events = events, .data = {.ptr = &ready}};
    if (::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, fd, &event) != 0)
        throw std::runtime_error(fmt::format("epoll_ctl: {}", std::strerror(errno)));
}

void Loop::change(int fd, std::uint32_t events, Ready& ready) {
    epoll_event event{.events = events, .data = {.ptr = &ready}};
    ::epoll_ctl(epoll_.get(), EPOLL_CTL_MOD, fd, &event);
}

void Loop::wait(int milliseconds, std::mutex& mutex, const std::function<void()>& woken) {
    std::array<epoll_event, 32> events{};
    const int count =
        ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), milliseconds);
    const std::lock_guard lock(mutex);
    woken();
    for (int i = 0; i < count; ++i) {
        const epoll_event& event = events[static_cast<std::size_t>(i)];
        static_cast<Ready*>(event.data.ptr)->call(event.events);
    }
}

void Log::say(std::string_view kind, const std::string& line, Time now) {
    if (!write_) return;
    auto found = kinds_.find(kind);
    if (found == kinds_.end()) found = kinds_.emplace(kind, Kind{}).first;
    Kind& of = found->second;
    if (of.when && now - *of.when < std::chrono::seconds(1)) {
        ++of.unsaid;
        return;
    }
    write_(of.unsaid == 0 ? line : fmt::format("{} (and {} more of this kind)", line, of.unsaid));
    of = {.when = now, .unsaid = 0};
}

Devices::Devices(std::mutex& mutex, Log& log, const ServerOptions& options)
    : mutex_(mutex), log_(log), options_(options) {
    for (const SenderName& each : options.senders) {
        senders_.push_back({.name = each.name});
        watched_.push_back(std::make_unique<Watched>());
    }
}

void Devices::tick(Time now, bool wanted) {
    const bool over =
        std::any_of(watched_.begin(), watched_.end(), [](const auto& each) { return each->over.load(); });
    if (!wanted || over) end();
    if (!wanted) tried_.reset();
    if (wanted && !client_) connect(now);
}

void Devices::end() {
    for (const auto& each : watched_) {
        if (each->observer) each->observer->release();  // a call that waits throws
        if (each->thread.joinable()) each->thread.join();
        each->observer.reset();
        each->over = false;
    }
    client_.reset();
}

void Devices::connect(Time now) {
    if (tried_ && now - *tried_ < std::chrono::seconds(1)) return;
    tried_ = now;
    try {
        client_.emplace(Client::connect(
            options_.servo, {.name = "knurl-vrpn", .wait = std::chrono::milliseconds(0), .hints = false}));
        for (std::size_t i = 0; i < watched_.size(); ++i) {
            Watched& each = *watched_[i];
            each.observer.emplace(client_->observe(options_.senders[i].device));
            {
                const std::lock_guard lock(mutex_);
                senders_[i].device = each.observer->device();
                senders_[i].newest = each.observer->latest();
            }
            each.thread = std::thread([this, i] { watch(i); });
        }
    } catch (const std::exception& error) {
        end();
        const std::lock_guard lock(mutex_);
        log_.say("servo", error.what(), now);
    }
}

void Devices::watch(std::size_t sender) {
    Watched& each = *watched_[sender];
    std::vector<HandReport> block(64);
    try {
        for (;;) {
            const auto first = each.observer->next_report(std::chrono::seconds(1));
            if (!first) continue;
            block[0] = *first;
            const std::size_t count =
                first->unread == 0 ? 1 : 1 + each.observer->drain(std::span(block).subspan(1));
            const std::lock_guard lock(mutex_);
            // The client waits: what else is to be done comes behind its datagram.
            if (on_reports) on_reports(sender, std::span(block).first(count));
            senders_[sender].newest = block[count - 1];
        }
    } catch (const Error&) {
        each.over = true;  // released, or the servo has gone for good: a new one is looked for
    }
}

Core::Core(ServerOptions given)
    : options(std::move(given)),
      log(options.log),
      devices(mutex, log, options),
      holders(options.senders.size(), nullptr) {}

std::string text_of(const sockaddr_in& address) {
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    return fmt::format("{}:{}", text.data(), ntohs(address.sin_port));
}

std::int64_t wall_clock_ns() {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

HostRange host_range(const std::string& text) {
    if (text == "localhost" || text == "loopback") return {.network = 0x7f000000, .mask = 0xff000000};
    const std::size_t slash = text.find('/');
    in_addr address{};
    int bits = 32;
    bool good = ::inet_pton(AF_INET, text.substr(0, slash).c_str(), &address) == 1;
    if (good && slash != std::string::npos) {
        const std::string digits = text.substr(slash + 1);
        good = !digits.empty() && digits.size() <= 2 &&
               digits.find_first_not_of("0123456789") == std::string::npos;
        bits = good ? std::stoi(digits) : 0;
        good = good && bits >= 1 && bits <= 32;
    }
    if (!good)
        throw std::runtime_error(
            fmt::format("'{}' is no address: write 192.168.1.7, 10.1.0.0/16, or localhost", text));
    return {.network = ntohl(address.s_addr), .mask = 0xffffffffu << (32 - bits)};
}

}  // namespace knurl::vrpn
