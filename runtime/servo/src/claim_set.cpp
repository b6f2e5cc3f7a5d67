#include "claim_set.hpp"

#include <algorithm>

namespace knurl::servo {

namespace {

/// m: so much nearer than this to `from` is within the ball, whatever rounding does.
double room_in(const StillScene& still, const Eigen::Vector3d& from) noexcept {
    return (still.within - (from - still.at).norm()) * (1 - 1e-9) - 1e-9;
}

}  // namespace

bool ClaimSet::adopt(Claim& claim) noexcept {
    if (size_ == claims_.size()) return false;
    const shm::Sleeper& sleeper = claim.impl->sleeper;
    claims_[size_] = &claim;
    sleepers_[size_] = sleeper;
    marks_[size_] = {.flag = sleeper.flag};
    stills_[size_] = {};
    clocks_[size_] = {};
    ++size_;
    return true;
}

void ClaimSet::move(std::size_t from, std::size_t to) noexcept {
    if (from == to) return;
    claims_[to] = claims_[from];
    sleepers_[to] = sleepers_[from];
    marks_[to] = marks_[from];
    stills_[to] = stills_[from];
    clocks_[to] = clocks_[from];
}

std::size_t ClaimSet::find(const Claim* claim) const noexcept {
    const auto end = claims_.begin() + static_cast<std::ptrdiff_t>(size_);
    return static_cast<std::size_t>(std::find(claims_.begin(), end, claim) - claims_.begin());
}

void ClaimSet::look(const Eigen::Vector3d* hand, Nanoseconds now) noexcept {
    if (hand == nullptr || !((*hand - rest_at_).norm() < rest_within_)) wake_near(hand);
    // Two passes: the words of many applications arrive together. Those of claims that are awake are read at
    // the end of the cycle (shm::who_waits).
    for (std::size_t i = 0; i < size_; ++i) __builtin_prefetch(marks_[i].flag);
    awake_size_ = 0;
    resting_ = {};
    for (std::size_t i = 0; i < size_; ++i) {
        Mark& mark = marks_[i];
        if (mark.resting()) {
            const std::uint64_t count = shm::sent_so_far<>(mark.flag->sent);
            if (count == mark.seen && now < mark.rest.until) {
                resting_.present += mark.rest.present;
                resting_.armed += mark.rest.armed ? 1 : 0;
                resting_.keep_on = resting_.keep_on || mark.rest.keeps_on;
                resting_.surfaces = resting_.surfaces || mark.rest.surfaces;
                continue;
            }
            mark.seen = count;
            mark.rest = over;
        }
        awake_[awake_size_++] = i;
    }
}

void ClaimSet::wake_near(const Eigen::Vector3d* hand) noexcept {
    // Where the hand is not known, the next look looks at each.
    rest_within_ = hand != nullptr ? std::numeric_limits<double>::infinity() : 0;
    if (hand != nullptr) rest_at_ = *hand;
    for (std::size_t i = 0; i < size_; ++i) {
        if (!marks_[i].resting() || marks_[i].rest.present == 0) continue;
        if (hand == nullptr || !stills_[i].holds(rest_at_))
            wake(i);
        else
            rest_within_ = std::min(rest_within_, room_in(stills_[i], rest_at_));
    }
}

void ClaimSet::put_to_rest(std::size_t place, const Rest& rest) noexcept {
    marks_[place].rest = rest;
    if (rest.present > 0) rest_within_ = std::min(rest_within_, room_in(stills_[place], rest_at_));
}

void ClaimSet::pass_time(std::uint64_t cycle, double dt) noexcept {
    passed_ = cycle;
    for (std::size_t i = 0; i < size_; ++i) {
        clocks_[i].time.all += dt;
        clocks_[i].time.held += dt * clocks_[i].held_share;
    }
}

}  // namespace knurl::servo
