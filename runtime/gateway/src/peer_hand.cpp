#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <list>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include <knurl/client/error.hpp>
#include <knurl/gateway/peer_hand.hpp>
#include <knurl/reps/all.hpp>

#include "claim_port.hpp"

namespace knurl::gateway {

namespace {

/// A flood of messages costs the servo's cycle no more than one batch a cycle, and this thread little.
constexpr std::chrono::microseconds least_step{500};

/// Changes of representations that wait for a claim thread, which stands still for a second at most.
constexpr std::size_t most_changes = 4096;

std::string refusal(std::string_view field, std::string_view part, double value, double most,
                    std::string_view unit) {
    const std::string name = part.empty() ? std::string(field) : fmt::format("{}.{}", field, part);
    if (!std::isfinite(value))
        return fmt::format("{} is {}; it must be a finite number, {:g} to {:g} {}", name, value, -most, most,
                           unit);
    return fmt::format("{} is {:g} {}; it must be {:g} to {:g} {}", name, value, unit, -most, most, unit);
}

/// Empty: each component is within +-`most`.
std::string check(const Vec3& v, std::string_view field, double most, std::string_view unit) {
    const std::pair<std::string_view, double> parts[] = {{"x", v.x}, {"y", v.y}, {"z", v.z}};
    for (const auto& [part, value] : parts)
        if (!(std::abs(value) <= most)) return refusal(field, part, value, most, unit);
    return {};
}

}  // namespace

/// Mailbox and thread. The thread keeps it alive until it has released the device.
struct PeerHand::Impl {
    explicit Impl(PeerOptions given) : options(std::move(given)) {}

    const PeerOptions options;

    std::mutex mutex;
    std::condition_variable woken;
    // With the mutex.
    Orders orders;  // of complete messages
    bool ordered = false;
    bool ending = false;
    bool ended = false;
    PeerStatus status;
    std::vector<Said> said;

    // The peer's thread alone.
    Orders message;  // not complete yet
    std::set<std::string> names;
    std::thread thread;

    /// Empty, or why there are too many.
    std::string add(ItemChange change) {
        if (!names.contains(change.name) && names.size() >= most_representations)
            return fmt::format(
                "there are {} representations already, the most that a connection may have; remove one first",
                most_representations);
        if (message.changes.size() >= most_changes)
            return fmt::format("more than {} changes in one message; send them in several", most_changes);
        names.insert(change.name);
        message.changes.push_back(std::move(change));
        return {};
    }

    void run() {
        ClaimPort port(options);
        PeerLife life(port, options);
        std::unique_lock lock(mutex);
        while (!ending) {
            const Orders taken = std::exchange(orders, {});
            const bool by_order = std::exchange(ordered, false);
            lock.unlock();
            const auto again = life.step(options.clock(), taken);
            auto news = life.said();
            lock.lock();
            status = life.status();
            for (Said& line : news) said.push_back(std::move(line));
            // A step that a timer called for delays no order.
            if (by_order) woken.wait_for(lock, least_step, [this] { return ending; });
            const auto is_woken = [this] { return ordered || ending; };
            if (again)
                woken.wait_for(lock, *again - options.clock(), is_woken);
            else
                woken.wait(lock, is_woken);
        }
        lock.unlock();
        life.end();
        lock.lock();
        ended = true;
    }
};

namespace {

/// Threads that are releasing a device. Those that have ended are joined when the next one comes, all of them at the
/// program's end: no thread outlives the program's statics.
class Endings {
  public:
    ~Endings() {
        for (auto& [thread, has_ended] : threads_) thread.join();
    }
    void take(std::thread thread, std::function<bool()> has_ended) {
        const std::lock_guard lock(mutex_);
        for (auto it = threads_.begin(); it != threads_.end();) {
            if (it->second()) {
                it->first.join();
                it = threads_.erase(it);
            } else {
                ++it;
            }
        }
        threads_.emplace_back(std::move(thread), std::move(has_ended));
    }

  private:
    std::mutex mutex_;
    std::list<std::pair<std::thread, std::function<bool()>>> threads_;
};

Endings& endings() {
    static Endings all;
    return all;
}

}  // namespace

PeerHand::PeerHand(PeerOptions options) : impl_(std::make_shared<Impl>(std::move(options))) {
    endings();  // so that it outlives what is made later
}

PeerHand::~PeerHand() {
    if (!impl_->thread.joinable()) return;
    {
        const std::lock_guard lock(impl_->mutex);
        impl_->ending = true;
    }
    impl_->woken.notify_all();
    endings().take(std::move(impl_->thread), [impl = impl_] {
        const std::lock_guard lock(impl->mutex);
        return impl->ended;
    });
}

std::string PeerHand::push(const Vec3& force, const Vec3& torque, std::string_view field) {
    std::string refused = check(force, field, impl_->options.most_force, "N");
    if (refused.empty()) refused = check(torque, field, impl_->options.most_torque, "N m");
    if (refused.empty()) impl_->message.push = Push{force, torque};
    return refused;
}

std::string PeerHand::pull(const Vec3& target, std::string_view field) {
    std::string refused = check(target, field, impl_->options.farthest, "m");
    if (refused.empty()) impl_->message.target = target;
    return refused;
}

std::string PeerHand::add(const std::string& name, Kind kind, const std::vector<std::byte>& params,
                          const AddOptions& options) {
    return impl_->add(
        {.what = ItemChange::What::add, .name = name, .kind = kind, .params = params, .options = options});
}

std::string PeerHand::mesh(const std::string& name, std::shared_ptr<const PeerMesh> mesh,
                           const std::vector<std::byte>& shape) {
    return impl_->add({.what = ItemChange::What::add,
                       .name = name,
                       .kind = kind_of<Shape>,
                       .params = shape,
                       .options = {},
                       .mesh = std::move(mesh)});
}

std::string PeerHand::set(const std::string& name, const std::vector<std::byte>& params) {
    if (!impl_->names.contains(name))
        return fmt::format("there is no representation '{}' to set; add it first", name);
    if (impl_->message.changes.size() >= most_changes)
        return fmt::format("more than {} changes in one message; send them in several", most_changes);
    impl_->message.changes.push_back(
        {.what = ItemChange::What::set, .name = name, .kind = 0, .params = params, .options = {}});
    return {};
}

std::string PeerHand::remove(const std::string& name) {
    if (impl_->names.erase(name) == 0) return fmt::format("there is no representation '{}' to remove", name);
    impl_->message.changes.push_back(
        {.what = ItemChange::What::remove, .name = name, .kind = 0, .params = {}, .options = {}});
    return {};
}

void PeerHand::clear() {
    for (const std::string& name : std::set<std::string>(impl_->names)) remove(name);
}

void PeerHand::sent() {
    Orders message = std::exchange(impl_->message, {});
    const bool felt =
        (message.push && !message.push->is_nothing()) || message.target || !message.changes.empty();
    if (!impl_->thread.joinable()) {
        if (!felt) return;  // claims nothing, so it needs no thread
        impl_->thread = std::thread([impl = impl_] { impl->run(); });
    }
    {
        const std::lock_guard lock(impl_->mutex);
        Orders& waiting = impl_->orders;
        if (message.push) waiting.push = message.push;
        if (message.target) waiting.target = message.target;
        for (ItemChange& change : message.changes) {
            // Newest wins: parameters that nobody took are not sent.
            const auto same = [&](const ItemChange& w) { return w.name == change.name; };
            const auto last = std::find_if(waiting.changes.rbegin(), waiting.changes.rend(), same);
            if (change.what == ItemChange::What::set && last != waiting.changes.rend() &&
                last->what != ItemChange::What::remove)
                last->params = std::move(change.params);
            else if (waiting.changes.size() < most_changes)
                waiting.changes.push_back(std::move(change));
            else if (impl_->said.size() < 100)
                impl_->said.push_back(
                    {Said::Level::error, "command", "more changes wait than the servo takes; some are lost"});
        }
        waiting.alive = true;
        waiting.at = impl_->options.clock();
        impl_->ordered = true;
    }
    impl_->woken.notify_all();
}

PeerStatus PeerHand::status() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->status;
}

std::vector<Said> PeerHand::said() {
    const std::lock_guard lock(impl_->mutex);
    return std::exchange(impl_->said, {});
}

}  // namespace knurl::gateway
