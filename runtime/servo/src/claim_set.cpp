#include "claim_set.hpp"

#include <algorithm>

namespace knurl::servo {

namespace {

/// m: a point closer to `from` than this is inside the ball, whatever rounding does.
double room_in(const SleepingScene& scene, const Eigen::Vector3d& from) noexcept {
    return (scene.within - (from - scene.at).norm()) * (1 - 1e-9) - 1e-9;
}

}  // namespace

bool ClaimSet::adopt(Claim& claim) noexcept {
    if (size_ == claims_.size()) return false;
    const shm::WakeTarget& wake_target = claim.impl->wake_target;
    claims_[size_] = &claim;
    wake_targets_[size_] = wake_target;
    marks_[size_] = {.flag = wake_target.flag};
    sleeping_scenes_[size_] = {};
    clocks_[size_] = {};
    ++size_;
    return true;
}

void ClaimSet::move(std::size_t from, std::size_t to) noexcept {
    if (from == to) return;
    claims_[to] = claims_[from];
    wake_targets_[to] = wake_targets_[from];
    marks_[to] = marks_[from];
    sleeping_scenes_[to] = sleeping_scenes_[from];
    clocks_[to] = clocks_[from];
}

std::size_t ClaimSet::find(const Claim* claim) const noexcept {
    const auto end = claims_.begin() + static_cast<std::ptrdiff_t>(size_);
    return static_cast<std::size_t>(std::find(claims_.begin(), end, claim) - claims_.begin());
}

void ClaimSet::look(const Eigen::Vector3d* hand, Nanoseconds now) noexcept {
    if (hand == nullptr || !((*hand - sleep_center_).norm() < sleep_radius_)) wake_near(hand);
    // Two passes, so that the cache misses of many applications' words overlap. The words of claims that are
    // awake are read at the end of the cycle (shm::who_waits).
    for (std::size_t i = 0; i < size_; ++i) __builtin_prefetch(marks_[i].flag);
    awake_size_ = 0;
    sleeping_ = {};
    for (std::size_t i = 0; i < size_; ++i) {
        Mark& mark = marks_[i];
        if (mark.sleeping()) {
            const std::uint64_t count = shm::sent_so_far<>(mark.flag->sent);
            if (count == mark.seen && now < mark.sleep.until) {
                sleeping_.present += mark.sleep.present;
                sleeping_.armed += mark.sleep.armed ? 1 : 0;
                sleeping_.keep_on = sleeping_.keep_on || mark.sleep.keeps_on;
                sleeping_.surfaces = sleeping_.surfaces || mark.sleep.surfaces;
                continue;
            }
            mark.seen = count;
            mark.sleep = over;
        }
        awake_[awake_size_++] = i;
    }
}

void ClaimSet::wake_near(const Eigen::Vector3d* hand) noexcept {
    // If the hand is unknown, the next look tests each scene.
    sleep_radius_ = hand != nullptr ? std::numeric_limits<double>::infinity() : 0;
    if (hand != nullptr) sleep_center_ = *hand;
    for (std::size_t i = 0; i < size_; ++i) {
        if (!marks_[i].sleeping() || marks_[i].sleep.present == 0) continue;
        if (hand == nullptr || !sleeping_scenes_[i].holds(sleep_center_))
            wake(i);
        else
            sleep_radius_ = std::min(sleep_radius_, room_in(sleeping_scenes_[i], sleep_center_));
    }
}

void ClaimSet::put_to_sleep(std::size_t place, const Sleep& sleep) noexcept {
    marks_[place].sleep = sleep;
    if (sleep.present > 0)
        sleep_radius_ = std::min(sleep_radius_, room_in(sleeping_scenes_[place], sleep_center_));
}

void ClaimSet::pass_time(std::uint64_t cycle, double dt) noexcept {
    passed_ = cycle;
    for (std::size_t i = 0; i < size_; ++i) {
        clocks_[i].time.all += dt;
        clocks_[i].time.held += dt * clocks_[i].held_share;
    }
}

}  // namespace knurl::servo
