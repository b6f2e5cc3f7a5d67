#pragma once
// Broad phase: which surfaces a probe might touch, and which effects it may feel. Collected once, and exact until the
// probe has moved by a margin; what is left out then is neither evaluated nor looked at.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "broad_phase/bounding_tree.hpp"
#include "scene/kind_ops.hpp"
#include "scene/scene_state.hpp"

namespace knurl::detail {

/// Until a probe has moved by `margin` from `at` what was collected there is all that is near.
struct Coverage {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m
    double margin = -1;                            // m; negative: to be collected anew
    double wanted = 0;                             // m, the next margin

    static constexpr double rounding = 1 - 5e-5;  // of the margin: what rounding of positions may not eat
    void expire() noexcept { margin = -1; }
    bool expired() const noexcept { return margin < 0; }
    /// It holds for a probe at p that reaches `deep` (m) farther than itself.
    bool holds(const Eigen::Vector3d& p, double deep) const noexcept {
        const double within = margin * rounding - deep;
        return within > 0 && (p - at).squaredNorm() < within * within;
    }
    /// How far the probe may move until it does not (m).
    double left(const Eigen::Vector3d& p, double deep) const noexcept {
        return margin * rounding - deep - (p - at).norm();
    }
};

/// Where the ball around it has moved on to by now; nothing: it has no end.
std::optional<Bound> ball_now(const Record& record, const Clock& clock) noexcept;
/// A surface that was not evaluated in the last cycle that took time was out of reach then. Its state is made what it
/// would be had it been evaluated: no path before that cycle, and the probe where it was in it.
/// `held`: m, by which its set held the probe then.
void catch_up(Record& record, const SceneState& state, const Eigen::Vector3d& held) noexcept;

/// Of the surfaces. Those without an end that do not stand still are always candidates.
class SurfaceCandidates {
  public:
    SurfaceCandidates(std::size_t slots, std::size_t probes);

    void place(std::uint32_t slot, const SceneState& state) noexcept;
    void forget(std::uint32_t slot, const Record& current) noexcept;  // from where it was placed
    /// One that was always a candidate, and stays there, unless it may be out of reach from now on.
    void place_again(std::uint32_t slot, const SceneState& state) noexcept;
    void index() { tree_.index(); }
    void reset() noexcept;

    /// A probe has moved out of what was collected for it. depth_of(probe): m, how far its proxies may lie from it.
    template <class DepthOf>
    bool left(const SceneState& state, DepthOf depth_of) noexcept {
        bool any = false;
        for_each_bit(used_, [&](std::uint32_t p) {
            if (!outdated(p, state, depth_of(p))) return;
            probes_[p].coverage.expire();
            any = true;
        });
        return any;
    }
    void expire(std::uint32_t probe) noexcept { probes_[probe].coverage.expire(); }
    bool expired(std::uint32_t probe) const noexcept { return probes_[probe].coverage.expired(); }
    /// They cover the way of a proxy, too, which is so far from its probe (m).
    bool covers(std::uint32_t probe, const SceneState& state, double depth) const noexcept {
        return probes_[probe].coverage.holds(state.probes[probe].probe.position, depth);
    }
    /// True: they are others than they were. `deepest` (m): of the present and the fading set.
    bool collect(std::uint32_t probe, SceneState& state, double deepest) noexcept;
    /// A ball that fades out does not matter to the probe: it is evaluated again when it may.
    bool passes_by(std::uint32_t probe, const Bound& ball, const SceneState& state) noexcept;

    std::uint32_t probes() const noexcept { return used_; }  // bit mask: with some that may be out of reach
    bool may_be_near(std::uint32_t slot) const noexcept {
        return !slots_[slot].bounded || slots_[slot].candidate;
    }
    bool bounded(std::uint32_t slot) const noexcept { return slots_[slot].bounded; }
    bool any(std::uint32_t probe) const noexcept { return probes_[probe].bounded > 0; }
    std::span<const std::uint32_t> always() const noexcept { return always_; }
    std::span<const std::uint32_t> of(std::uint32_t probe) const noexcept { return probes_[probe].list; }
    /// How far the probe may move until others may be near (m); 0: that cannot be said.
    double sleep_radius(std::uint32_t probe, const SceneState& state, double deepest) const noexcept;
    void lose_sight(std::uint32_t slot) noexcept { slots_[slot].candidate = false; }

  private:
    struct SurfaceSlot {
        bool bounded = false;    // it may be out of reach: in a set only while a candidate
        bool candidate = false;  // ... which it is
        bool endless = false;    // ... not by a ball: it says how far away it is
        std::uint32_t place = 0;
    };
    struct Candidates {
        Coverage coverage;
        double until = 0;  // s, of the scene's time: then others may have come near
        std::uint32_t bounded = 0;
        SlotList list;
    };
    bool may_be_far(const Record& surface, const SceneState& state) const noexcept;
    bool outdated(std::uint32_t probe, const SceneState& state, double deepest) const noexcept;
    bool too_many(const Candidates& candidates, double deepest) const noexcept {
        return candidates.coverage.margin > candidates.coverage.wanted &&
               2 * deepest <= candidates.coverage.wanted;
    }
    void fetch(std::span<const std::uint32_t> slots, const SceneState& state) const noexcept;
    auto place_of() noexcept {
        return [this](std::uint32_t i) -> std::uint32_t& { return slots_[i].place; };
    }

    std::vector<SurfaceSlot> slots_;
    std::vector<Candidates> probes_;
    std::uint32_t used_ = 0;
    SlotList always_, endless_;
    BoundingTree tree_;
    std::vector<std::uint32_t> found_;  // scratch
};

/// Of the effects that have an end.
class EffectCandidates {
  public:
    EffectCandidates(std::size_t slots, std::size_t probes);

    void place(std::uint32_t slot, const Record& current) noexcept;
    void forget(std::uint32_t slot, const Record& current) noexcept;
    void index() { tree_.index(); }
    void reset() noexcept;

    bool left(const SceneState& state) noexcept;
    void expire(std::uint32_t probe) noexcept { probes_[probe].coverage.expire(); }
    bool expired(std::uint32_t probe) const noexcept { return probes_[probe].coverage.expired(); }
    /// `effects`: all that are felt; `scratch`: room for as many.
    void collect(std::uint32_t probe, std::span<const std::uint32_t> effects,
                 std::span<std::uint32_t> scratch, SceneState& state) noexcept;

    std::uint32_t probes() const noexcept { return used_; }  // bit mask: with some that have an end
    bool may_be_near(std::uint32_t slot) const noexcept {
        return !slots_[slot].bounded || slots_[slot].candidate;
    }
    double sleep_radius(const SceneState& state) const noexcept;

  private:
    struct EffectSlot {
        bool bounded = false, candidate = false;
    };
    struct Candidates {
        Coverage coverage;
        std::uint32_t bounded = 0;
    };
    std::vector<EffectSlot> slots_;
    std::vector<Candidates> probes_;
    std::uint32_t used_ = 0;
    BoundingTree tree_;
};

}  // namespace knurl::detail
