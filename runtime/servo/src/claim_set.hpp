#pragma once
// The claims of a device, awake or sleeping. Most claims of a crowd hold the device without sending, and
// their scenes are out of the hand's reach. A cycle would change nothing in such a claim until its
// application sends something, it counts as silent, or the hand comes nearer. So for a sleeping claim a cycle
// reads half a cache line here and one word of the claim's segment, and skips its rings and its scene. The
// result is the same to the last bit (set ServoOptions::sleep to false to compare).

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

/// A scene out of the hand's reach. While the hand stays in a ball and nobody changes the scene, an
/// evaluation would only let time pass. So it is skipped. Before the next evaluation the scene gets the
/// number of skipped ones (Scene::pass), and its result is the same.
struct SleepingScene {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m, device: the ball
    double within = 0;                             // m
    std::uint64_t since = 0;                       // cycle: the last evaluation

    bool holds(const Eigen::Vector3d& hand) const noexcept {
        return (hand - at).squaredNorm() < within * within;
    }
};

/// The time of a sleeping scene, updated for all of them in each cycle: half a cache line each.
struct alignas(32) SleepingClock {
    SceneTime time;
    double held_share = 1;  // of the time; 0: it is silent
};

/// What a sleeping claim contributes to a cycle.
struct Sleep {
    static constexpr Nanoseconds for_ever = std::numeric_limits<Nanoseconds>::max();

    Nanoseconds until = for_ever;  // the time at which it counts as silent
    std::uint32_t present = 0;     // representations in its sleeping scene; 0: none
    bool armed = false;            // requests force: the supervisor counts it
    bool keeps_on = false;         // keeps the device on
    bool surfaces = false;         // has surfaces, out of reach: the hand's budget reserves a share for them
};

/// All claims of a device, observers included. A claim is named by its place in the order of arrival, which
/// is valid until `let_go`.
class ClaimSet {
  public:
    /// Sums over the sleeping claims.
    struct Sleeping {
        int armed = 0;
        bool keep_on = false, surfaces = false;
        std::uint64_t present = 0;
    };

    /// Adds the claim, awake. False: the set is full.
    bool adopt(Claim& claim) noexcept;
    /// Removes the claims for which `goes(Claim&)` returns true; it may have freed them. Called in order of
    /// arrival. The other claims keep this order.
    template <class Goes>
    void let_go(Goes goes) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i)
            if (!goes(*claims_[i])) move(i, kept++);
        if (kept < size_) awake_size_ = 0;  // places have changed, so the list is empty until the next look
        size_ = kept;
    }

    std::size_t size() const noexcept { return size_; }
    Claim& claim(std::size_t place) noexcept { return *claims_[place]; }
    Claim::Impl& operator[](std::size_t place) noexcept { return *claims_[place]->impl; }
    /// Compares addresses only; the claim may be freed. size(): not found.
    std::size_t find(const Claim* claim) const noexcept;
    /// The clients that may wait for a report.
    std::span<const shm::WakeTarget> wake_targets() const noexcept { return {wake_targets_.data(), size_}; }

    /// Once in a cycle, before the rings are read: finds the claims that are awake. A null `hand` wakes all
    /// claims with a sleeping scene.
    void look(const Eigen::Vector3d* hand, Nanoseconds now) noexcept;
    /// The places of the claims that are awake, and the sums over the others, as of the last look or
    /// wake_all.
    std::span<const std::size_t> awake() const noexcept { return {awake_.data(), awake_size_}; }
    const Sleeping& sleeping() const noexcept { return sleeping_; }

    /// Takes effect at the next look.
    void wake(std::size_t place) noexcept { marks_[place].sleep = over; }
    /// Takes effect at once. `woken(Claim::Impl&)` is called for each claim that slept.
    template <class Woken>
    void wake_all(Woken woken) noexcept {
        for (awake_size_ = 0; awake_size_ < size_; ++awake_size_) {
            if (marks_[awake_size_].sleeping()) woken((*this)[awake_size_]);
            wake(awake_size_);
            awake_[awake_size_] = awake_size_;
        }
        sleeping_ = {};
    }
    /// Takes effect at the next look. A claim with representations needs put_scene_to_sleep first.
    void put_to_sleep(std::size_t place, const Sleep& sleep) noexcept;
    bool sleeps_unarmed(std::size_t place) const noexcept {
        return marks_[place].sleeping() && !marks_[place].sleep.armed;
    }

    /// Called in this cycle, before pass_time.
    void put_scene_to_sleep(std::size_t place, const SleepingScene& scene,
                            const SleepingClock& clock) noexcept {
        sleeping_scenes_[place] = scene;
        clocks_[place] = clock;
    }
    const SleepingScene& sleeping_scene(std::size_t place) const noexcept { return sleeping_scenes_[place]; }
    /// Lets the time of `cycle` pass for all sleeping scenes.
    void pass_time(std::uint64_t cycle, double dt) noexcept;
    /// The number of skipped cycles since the last evaluation, and the scene's time over them.
    std::uint64_t cycles_owed(std::size_t place) const noexcept {
        return passed_ - sleeping_scenes_[place].since;
    }
    const SceneTime& time(std::size_t place) const noexcept { return clocks_[place].time; }

  private:
    static constexpr Sleep over{.until = std::numeric_limits<Nanoseconds>::min()};
    /// Half a cache line: a cycle reads up to 128 of them.
    struct alignas(32) Mark {
        const shm::WaiterFlag* flag = nullptr;  // in its segment
        /// flag->sent as read before the last look at the rings. All that was counted up to then has been
        /// found; any other value requires a new look.
        std::uint64_t seen = 0;
        Sleep sleep = over;

        bool sleeping() const noexcept { return sleep.until != over.until; }
    };
    static_assert(sizeof(Mark) == 32);
    void move(std::size_t from, std::size_t to) noexcept;
    void wake_near(const Eigen::Vector3d* hand) noexcept;

    template <class T>
    using Each = std::array<T, protocol::max_clients>;  // by place

    // On separate cache lines: the waker reads the sleepers, each cycle reads all marks and clocks.
    std::size_t size_ = 0;
    Each<Claim*> claims_ = {};
    Each<shm::WakeTarget> wake_targets_ = {};
    Each<Mark> marks_;
    Each<SleepingScene> sleeping_scenes_;
    Each<SleepingClock> clocks_;

    Each<std::size_t> awake_ = {};
    std::size_t awake_size_ = 0;
    Sleeping sleeping_;

    // A ball inside those of all sleeping scenes, so that a cycle need not test each of them.
    Eigen::Vector3d sleep_center_ = Eigen::Vector3d::Zero();
    double sleep_radius_ = 0;

    std::uint64_t passed_ = 0;  // the last cycle whose time has passed
};

}  // namespace knurl::servo
