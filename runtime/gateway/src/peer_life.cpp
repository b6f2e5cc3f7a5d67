#include "peer_life.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <knurl/client/error.hpp>
#include <knurl/protocol/report_names.hpp>

namespace knurl::gateway {

namespace {

double seconds(std::chrono::nanoseconds time) {
    return std::chrono::duration<double>(time).count();
}

std::string names_of(std::uint32_t faults) {
    std::string text;
    for (const auto& name : protocol::fault_names)
        if (faults & name.value) text += (text.empty() ? "" : ", ") + std::string(name.name);
    return text.empty() ? "unknown" : text;
}

}  // namespace

void PeerLife::say(const std::string& subject, Said::Level level, const std::string& text) {
    std::string& last = last_said_[subject];
    if (last == text) return;
    last = text;
    said_.push_back({level, subject, text});
}

std::optional<TimePoint> PeerLife::step(TimePoint now, Orders orders) {
    const bool alive = orders.alive;
    take(now, orders);
    lapse(now);
    if (!open_ && want() && now >= try_open_ && !open(now)) return next(now);
    if (!open_) return next(now);
    if (look(now)) {
        apply(alive);
        if (want()) arm(now);
    }
    if (open_ && !want() && now >= heard_ + options_.release_after) close();
    return next(now);
}

void PeerLife::end() noexcept {
    if (open_) port_.close();
    open_ = false;
}

void PeerLife::take(TimePoint now, Orders& orders) {
    const TimePoint at = orders.alive ? orders.at : now;
    // Nothing at all, from a peer that holds nothing, is how clients of some protocols ask for a position.
    if (orders.push && (open_ || push_.value || !orders.push->is_nothing())) {
        push_ = {orders.push, at};
        heard_ = at;
    }
    if (orders.target) {
        target_ = {orders.target, at};
        heard_ = at;
    }
    for (ItemChange& change : orders.changes) {
        heard_ = at;
        switch (change.what) {
            case ItemChange::What::add:
                items_[change.name] = change;
                break;
            case ItemChange::What::set:
                if (const auto found = items_.find(change.name); found != items_.end())
                    found->second.params = change.params;
                break;
            case ItemChange::What::remove:
                items_.erase(change.name);
                break;
        }
        if (open_) changes_.push_back(std::move(change));
    }
}

void PeerLife::lapse(TimePoint now) {
    if (push_.lapsed(now, options_.lapse)) push_.value.reset();
    if (target_.lapsed(now, options_.lapse)) target_.value.reset();
    status_.commands = push_.value.has_value() || target_.value.has_value();
}

bool PeerLife::open(TimePoint now) {
    try {
        port_.open();
    } catch (const Error& error) {
        try_open_ = now + options_.retry;
        say("claim", Said::Level::warning, error.what());
        return false;
    }
    over("claim");
    open_ = true;
    connected_ = true;
    status_.claimed = true;
    status_.armed = false;
    try_arm_ = now;
    pushed_.reset();
    pulled_.reset();
    changes_.clear();
    for (auto& [name, item] : items_) {
        item.what = ItemChange::What::add;
        changes_.push_back(item);
    }
    return true;
}

bool PeerLife::look(TimePoint now) {
    Seen seen;
    try {
        seen = port_.look();
    } catch (const Error&) {
        // Not connected, and not to come back: the same as away.
    }
    if (std::exchange(connected_, seen.connected) && !seen.connected) {
        status_.armed = false;
        say("servo", Said::Level::warning,
            fmt::format(
                "the servo of device '{}' has gone; the force comes back with the servo, if it is still "
                "commanded then",
                options_.device));
    }
    if (!seen.connected) return false;
    over("servo");
    if (std::exchange(servos_, seen.servos) != seen.servos) {
        status_.armed = false;
        try_arm_ = now;
    }
    hand_ = seen.position;
    fault_ = seen.state == DeviceState::fault;
    if (fault_) {
        status_.armed = false;
        say("fault", Said::Level::error,
            fmt::format("device '{}' is in fault ({}): no force until somebody resets it (`knurl reset`)",
                        options_.device, names_of(seen.faults)));
    } else {
        over("fault");
    }
    return true;
}

void PeerLife::apply(bool alive) {
    bool changed = false;
    try {
        while (!changes_.empty()) {
            const ItemChange change = std::move(changes_.front());
            changes_.pop_front();
            changed = true;
            port_.change(change);
        }
        if (port_.progress()) changed = true;
        // A force that has lapsed goes to zero over the fade, and stays as a representation of nothing: the next one
        // begins without an answer of the servo.
        if (push_.value && pushed_ != push_.value) {
            port_.push(*push_.value, -1);
            pushed_ = push_.value;
            changed = true;
        } else if (!push_.value && pushed_ && !pushed_->is_nothing()) {
            port_.push({}, seconds(options_.fade));
            pushed_ = Push{};
            changed = true;
        }
        if (target_.value && pulled_ != target_.value) {
            const Vec3 from = pulled_.value_or(hand_.value_or(*target_.value));
            const double far = (to_eigen(*target_.value) - to_eigen(from)).norm();
            port_.pull(from, *target_.value, std::min(far / options_.target_speed, 1000.0));
            pulled_ = target_.value;
            changed = true;
        } else if (!target_.value && pulled_) {
            port_.let_go();
            pulled_.reset();
            changed = true;
        }
        if (alive || changed) port_.commit();
        if (!items_.empty() || !status_.representations.empty()) status_.representations = port_.feedback();
        over("command");
    } catch (const Error& error) {
        say("command", Said::Level::warning, error.what());
    }
}

void PeerLife::arm(TimePoint now) {
    if (status_.armed || fault_ || !options_.may_arm || now < try_arm_) return;
    // Representations alone are felt as well; nothing at all needs no motor.
    if (items_.empty() && !target_.value && (!push_.value || push_.value->is_nothing())) return;
    try {
        port_.arm();
        status_.armed = true;
        over("arm");
    } catch (const Error& error) {
        try_arm_ = now + options_.retry;
        say("arm", Said::Level::warning, error.what());
    }
}

void PeerLife::close() {
    end();
    status_ = {.claimed = false, .armed = false, .commands = status_.commands, .representations = {}};
    pushed_.reset();
    pulled_.reset();
    last_said_.clear();
}

std::optional<TimePoint> PeerLife::next(TimePoint now) const {
    std::optional<TimePoint> soonest;
    const auto at = [&](TimePoint time) {
        if (!soonest || time < *soonest) soonest = std::max(time, now);
    };
    if (push_.value) at(push_.at + options_.lapse);
    if (target_.value) at(target_.at + options_.lapse);
    if (!open_) {
        if (want()) at(try_open_);
        return soonest;
    }
    // Whatever is to be looked at again: the servo that is away, a fault, a hand that was too fast to arm.
    if (port_.busy()) at(now + options_.look_at_mesh);
    if (!connected_) at(now + options_.retry / 10);
    if (want() && !status_.armed && options_.may_arm) at(std::max(try_arm_, now + options_.retry / 10));
    if (!want()) at(heard_ + options_.release_after);
    return soonest;
}

}  // namespace knurl::gateway
