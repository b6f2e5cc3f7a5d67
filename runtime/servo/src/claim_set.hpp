#pragma once
// The claims of a device, awake or asleep. Most of a crowd holds the device and says nothing, and what it has
// there is out of the hand's reach: what a cycle does for one of those has no effect until its application
// sends something, until it counts as silent, or until the hand has come nearer. So of one that sleeps a
// cycle reads half a line here and one word of its segment, and leaves alone its rings and its scene. What
// comes out is the same to the last bit (ServoOptions::sleep is false for whoever wants to compare).

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <Eigen/Core>

#include <knurl/protocol/bounds.hpp>
#include <knurl/reps/scene_time.hpp>
#include <knurl/servo/clock.hpp>
#include <knurl/shm/waiter.hpp>

#include "claim_impl.hpp"

namespace knurl::servo {

/// A scene out of the hand's reach: while the hand stays in a ball, and nobody changes the scene, an
/// evaluation would do nothing but let time pass. So none is made; when one is due again the scene is told
/// how many were left out (Scene::pass), and nobody can tell.
struct SleepingScene {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m, device: the ball
    double within = 0;                             // m
    std::uint64_t since = 0;                       // cycle: the last evaluation

    bool holds(const Eigen::Vector3d& hand) const noexcept {
        return (hand - at).squaredNorm() < within * within;
    }
};

/// The time of a sleeping scene, kept for all of them in each cycle: half a line each.
struct alignas(32) SleepingClock {
    SceneTime time;
    double held_share = 1;  // of the time; 0: it is silent
};

/// What counts of a claim while it sleeps.
struct Sleep {
    static constexpr Nanoseconds for_ever = std::numeric_limits<Nanoseconds>::max();

    Nanoseconds until = for_ever;  // then it counts as silent
    std::uint32_t present = 0;     // representations, in a sleeping scene; 0: there are none
    bool armed = false;            // wants force: the supervisor counts it
    bool keeps_on = false;         // and keeps the device on
    bool surfaces = false;         // it has some, out of reach: the hand's budget keeps a share for them
};

/// Observers too. A claim is named by its place in the order of arrival, which holds until `let_go`.
class ClaimSet {
  public:
    /// The sum of those that sleep.
    struct Sleeping {
        int armed = 0;
        bool keep_on = false, surfaces = false;
        std::uint64_t present = 0;
    };

    /// Awake. False: there is no room.
    bool adopt(Claim& claim) noexcept;
    /// Those go for which `goes(Claim&)`, asked in order of arrival, is true: it may have freed them. The
    /// others close up in their order: who came first is asked first.
    template <class Goes>
    void let_go(Goes goes) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i)
            if (!goes(*claims_[i])) move(i, kept++);
        if (kept < size_) awake_size_ = 0;  // places have changed: until the next look
        size_ = kept;
    }

    std::size_t size() const noexcept { return size_; }
    Claim& claim(std::size_t place) noexcept { return *claims_[place]; }
    Claim::Impl& operator[](std::size_t place) noexcept { return *claims_[place]->impl; }
    /// By address, whatever stands there by now: size() if it is none of these.
    std::size_t find(const Claim* claim) const noexcept;
    /// Those who may wait for a report.
    std::span<const shm::WakeTarget> wake_targets() const noexcept { return {wake_targets_.data(), size_}; }

    /// Once in a cycle, before the rings are looked at: who is awake. `hand`: null wakes all whose scene
    /// sleeps.
    void look(const Eigen::Vector3d* hand, Nanoseconds now) noexcept;
    /// The places of those that are, and the sums of the others, as of the last look or wake_all.
    std::span<const std::size_t> awake() const noexcept { return {awake_.data(), awake_size_}; }
    const Sleeping& sleeping() const noexcept { return sleeping_; }

    /// From the next look on.
    void wake(std::size_t place) noexcept { marks_[place].sleep = over; }
    /// From here on. `woken(Claim::Impl&)` is called for each that slept.
    template <class Woken>
    void wake_all(Woken woken) noexcept {
        for (awake_size_ = 0; awake_size_ < size_; ++awake_size_) {
            if (marks_[awake_size_].sleeping()) woken((*this)[awake_size_]);
            wake(awake_size_);
            awake_[awake_size_] = awake_size_;
        }
        sleeping_ = {};
    }
    /// From the next look on. With representations, put_scene_to_sleep was called for it.
    void put_to_sleep(std::size_t place, const Sleep& sleep) noexcept;
    bool sleeps_unarmed(std::size_t place) const noexcept {
        return marks_[place].sleeping() && !marks_[place].sleep.armed;
    }

    /// In this cycle, before its time passes.
    void put_scene_to_sleep(std::size_t place, const SleepingScene& scene,
                            const SleepingClock& clock) noexcept {
        sleeping_scenes_[place] = scene;
        clocks_[place] = clock;
    }
    const SleepingScene& sleeping_scene(std::size_t place) const noexcept { return sleeping_scenes_[place]; }
    /// For all sleeping scenes: that of `cycle`.
    void pass_time(std::uint64_t cycle, double dt) noexcept;
    /// Cycles that passed since the last evaluation, and the time that it is for the scene.
    std::uint64_t cycles_owed(std::size_t place) const noexcept {
        return passed_ - sleeping_scenes_[place].since;
    }
    const SceneTime& time(std::size_t place) const noexcept { return clocks_[place].time; }

  private:
    static constexpr Sleep over{.until = std::numeric_limits<Nanoseconds>::min()};
    /// Half a line: 128 of them are gone through in every cycle.
    struct alignas(32) Mark {
        const shm::WaiterFlag* flag = nullptr;  // in its segment
        /// flag->sent, read before a look at the rings: what was counted up to here has been found. Whatever
        /// else stands there now is a reason to look.
        std::uint64_t seen = 0;
        Sleep sleep = over;

        bool sleeping() const noexcept { return sleep.until != over.until; }
    };
    static_assert(sizeof(Mark) == 32);
    void move(std::size_t from, std::size_t to) noexcept;
    void wake_near(const Eigen::Vector3d* hand) noexcept;

    template <class T>
    using Each = std::array<T, protocol::max_clients>;  // by place

    // Apart from each other: the waker reads the sleepers, each cycle all marks and clocks.
    std::size_t size_ = 0;
    Each<Claim*> claims_ = {};
    Each<shm::WakeTarget> wake_targets_ = {};
    Each<Mark> marks_;
    Each<SleepingScene> sleeping_scenes_;
    Each<SleepingClock> clocks_;

    Each<std::size_t> awake_ = {};
    std::size_t awake_size_ = 0;
    Sleeping sleeping_;

    // A ball within those of all sleeping scenes, so that not each of them is looked at.
    Eigen::Vector3d sleep_center_ = Eigen::Vector3d::Zero();
    double sleep_radius_ = 0;

    std::uint64_t passed_ = 0;  // the last cycle that has
};

}  // namespace knurl::servo
