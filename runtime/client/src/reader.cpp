#include "reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <knurl/client/error.hpp>
#include <knurl/link/clock.hpp>
#include <knurl/link/text.hpp>
#include <knurl/shm/deadline.hpp>

#include "client_state.hpp"
#include "frame.hpp"

namespace knurl::detail {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

// The limits of a next_report() that permanently falls behind.
constexpr std::uint64_t behind_from = 16;                                    // unread reports
constexpr std::int64_t behind_by = 250'000'000, behind_for = 1'000'000'000;  // ns
// Reports that are copied between two looks at the writer's counter: 12 kB, which the nearest cache holds.
constexpr std::size_t drain_block = 32;

}  // namespace

Reader::Reader(std::shared_ptr<ClientState> client, std::string device, const protocol::ClaimRequest& request)
    : client_(std::move(client)), device_(std::move(device)), request_(request) {}

Reader::Lock Reader::enter() {
    require_own(made_in_);
    Lock lock(mutex_);
    if (closed_)
        throw Error(Error::Kind::stale_handle,
                    detail::format("device '{}' was released; claim it again with Client::claim", device_));
    if (!given_up_.empty()) throw Error(Error::Kind::disconnected, given_up_);
    return lock;
}

void Reader::throw_disconnected() const {
    throw Error(
        Error::Kind::disconnected,
        detail::format("device '{}': {}; once connected() is true again, call arm()", device_, lost_));
}

bool Reader::hints() const noexcept {
    return client_->hints();
}

void Reader::fill(HandReport& report) const {
    report.missed = missed_before_ + attachment_->reports->missed();
    report.unread = attachment_->reports->unread();
}

HandReport Reader::taken(const Report& report) {
    HandReport result;
    static_cast<Report&>(result) = last_.emplace(to_world(attachment_->terms.frame, report));
    fill(result);
    if (hints()) on_read();
    return result;
}

std::optional<HandReport> Reader::latest() {
    const Lock lock = enter();
    if (!attachment_) {
        notify_loop(false);
        return std::nullopt;
    }
    Report report;
    const bool fresh = attachment_->reports->latest(report);
    settle(lock, false);
    if (fresh) {
        since_.add(report);
        return taken(report);
    }
    if (!last_) return std::nullopt;
    HandReport again;
    static_cast<Report&>(again) = *last_;
    fill(again);
    return again;
}

std::optional<HandReport> Reader::next_report(nanoseconds timeout) {
    Lock lock = enter();
    const std::optional<Report> report = await(lock, timeout);
    if (!report) return std::nullopt;
    if (hints() && !behind_.said()) look_behind(*report);
    return taken(*report);
}

std::optional<HandFrame> Reader::newest(nanoseconds timeout) {
    Lock lock = enter();
    std::optional<Report> report = await(lock, timeout);
    if (!report) return std::nullopt;
    // One by one, since a press between two calls may be several. At most the present number, so that a fast
    // servo does not keep a slow machine here.
    for (std::uint64_t left = attachment_->reports->unread(); left > 0; --left) {
        Report next;
        if (!attachment_->reports->next(next)) break;
        since_.add(*report = next);
    }
    settle(lock, false);
    HandFrame frame;
    static_cast<HandReport&>(frame) = taken(*report);
    since_.tell(frame);
    return frame;
}

std::size_t Reader::drain(std::byte* first, std::size_t stride, std::size_t most) {
    const Lock lock = enter();
    if (!attachment_) {
        notify_loop(false);
        return 0;
    }
    ReportSource& reports = *attachment_->reports;
    const ToWorld into_world(attachment_->terms.frame);
    const auto row = [&](std::size_t i) -> HandReport& {
        return *reinterpret_cast<HandReport*>(first + i * stride);
    };
    std::size_t count = 0;
    while (count < most) {
        // Straight into the caller's memory, and the rest while it is in the cache.
        auto* const into = reinterpret_cast<std::byte*>(static_cast<Report*>(&row(count)));
        const std::size_t got = reports.next_some(into, stride, std::min(most - count, drain_block));
        if (got == 0) break;
        const std::uint64_t missed = missed_before_ + reports.missed(), unread = reports.unread();
        for (std::size_t left = got; left-- > 0; ++count) {
            HandReport& each = row(count);
            since_.add(each);
            into_world(each);
            each.missed = missed;
            each.unread = unread + left;
        }
    }
    settle(lock, false);
    if (count == 0) return 0;
    last_ = row(count - 1);
    if (hints()) on_read();
    return count;
}

std::optional<Report> Reader::await(Lock& lock, nanoseconds timeout) {
    const auto deadline = shm::deadline_after(timeout);
    bool waited = false;
    for (;;) {
        if (!attachment_) {
            notify_loop(false);
            const auto attached = [this] { return attachment_.has_value() || closed_ || !given_up_.empty(); };
            const bool changed = deadline == Clock::time_point::max()
                                     ? (changed_.wait(lock, attached), true)
                                     : changed_.wait_until(lock, deadline, attached);
            if (!changed) return std::nullopt;
            lock.unlock();
            lock = enter();  // throws if the servo is gone for good
            continue;
        }
        Report report;
        const bool got = attachment_->reports->next(report);
        const nanoseconds left = deadline - Clock::now();
        if (got || left <= nanoseconds(0)) {
            settle(lock, waited);
            if (!got) return std::nullopt;
            since_.add(report);
            return report;
        }
        const std::shared_ptr<ReportSource> source = attachment_->reports;  // stays mapped during the sleep
        lock.unlock();
        source->wait(std::min(left, longest_sleep));
        waited = true;
        lock = enter();
    }
}

void Reader::look_behind(const Report& read) {
    const std::uint64_t unread = attachment_->reports->unread();
    Report newest;
    const std::int64_t behind =
        unread > behind_from && attachment_->reports->newest(newest) ? newest.read_ns - read.read_ns : 0;
    // A reader that was delayed once and continues to read catches up sooner.
    if (!behind_.now(behind > behind_by, monotonic_ns(), behind_for)) return;
    hint(device_, detail::format("next_report() gave a report that is {:.2f} s older than the newest, and {} "
                                 "are unread: it gives every report in order, and is called less often than "
                                 "they come; newest() gives the newest, with all that happened to buttons "
                                 "and contacts since",
                                 static_cast<double>(behind) * 1e-9, unread));
}

std::optional<Report> Reader::peek(const Lock&) const {
    Report report;
    if (!attachment_ || !attachment_->reports->newest(report)) return std::nullopt;
    return to_world(attachment_->terms.frame, report);
}

void Reader::settle(const Lock&, bool waited) {
    // Unread reports without a wait: the event that announced them is still raised.
    if (loop_ && attachment_ && (waited || !attachment_->reports->fresh())) attachment_->reports->rearm();
}

int Reader::fd() {
    const Lock lock = enter();
    if (loop_) return loop_.get();
    notice_ = shm::UniqueFd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
    shm::UniqueFd loop(::epoll_create1(EPOLL_CLOEXEC));
    epoll_event event{.events = EPOLLIN, .data = {}};
    if (!notice_ || !loop || ::epoll_ctl(loop.get(), EPOLL_CTL_ADD, notice_.get(), &event) != 0)
        throw Error(Error::Kind::refused,
                    detail::format("fd of device '{}': {}; see the limit of open files (ulimit -n)", device_,
                                   std::strerror(errno)));
    loop_ = std::move(loop);
    if (attachment_) {
        watch_event(EPOLL_CTL_ADD);
        attachment_->reports->rearm();
    }
    return loop_.get();
}

void Reader::watch_event(int operation) {
    epoll_event event{.events = EPOLLIN, .data = {}};
    if (loop_) ::epoll_ctl(loop_.get(), operation, attachment_->reports->event(), &event);
}

void Reader::notify_loop(bool raise) {
    if (!loop_ || raise == noticed_) return;
    noticed_ = raise;
    std::uint64_t count = 1;
    [[maybe_unused]] const ssize_t done =
        raise ? ::write(notice_.get(), &count, sizeof count) : ::read(notice_.get(), &count, sizeof count);
}

std::uint64_t Reader::missed() {
    const Lock lock = enter();
    return missed_before_ + (attachment_ ? attachment_->reports->missed() : 0);
}

DeviceDescription Reader::description() {
    const Lock lock = enter();
    if (!attachment_) throw_disconnected();
    return attachment_->device;
}

Network Reader::network() {
    const Lock lock = enter();
    if (!attachment_) throw_disconnected();
    return attachment_->reports->network();
}

Age Reader::age(const Report& report) {
    const Network between = network();
    return {.age = nanoseconds(monotonic_ns() - report.read_ns) + between.clock_offset,
            .uncertainty = between.clock_uncertainty};
}

bool Reader::connected() {
    require_own(made_in_);
    const Lock lock(mutex_);
    return attachment_.has_value();
}

std::uint64_t Reader::reattachments() {
    const Lock lock = enter();
    return reattachments_;
}

void Reader::close() {
    if (made_in_ != fork_generation()) return;
    leaving_ = true;
    client_->leave(*this);
    const Lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
}

bool Reader::is_leaving() const noexcept {
    return leaving_ || client_->stopping();
}

void Reader::attach(Attachment& attachment) {
    bring(attachment);
    const Lock lock(mutex_);
    const bool again = was_attached_;
    on_attach(attachment, again);  // may throw: then nothing has changed
    attachment_ = std::move(attachment);
    was_attached_ = true;
    last_.reset();
    since_ = {};
    reattachments_ += again ? 1 : 0;
    notify_loop(false);
    watch_event(EPOLL_CTL_ADD);
    if (loop_) attachment_->reports->rearm();
    changed_.notify_all();
}

std::optional<Attachment> Reader::detach() {
    const Lock lock(mutex_);
    if (!attachment_) return std::nullopt;
    on_detach();
    missed_before_ += attachment_->reports->missed();
    watch_event(EPOLL_CTL_DEL);
    std::optional<Attachment> old = std::move(attachment_);
    attachment_.reset();
    last_.reset();
    notify_loop(true);
    changed_.notify_all();
    return old;
}

void Reader::give_up(const std::string& reason) {
    const Lock lock(mutex_);
    given_up_ = reason;
    changed_.notify_all();
}

void Reader::note_loss(const std::string& why) {
    const Lock lock(mutex_);
    lost_ = why;
}

void Reader::on_attach(Attachment&, bool) {}

}  // namespace knurl::detail
