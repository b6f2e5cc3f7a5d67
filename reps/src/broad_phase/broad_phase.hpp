#pragma once
// Broad phase: which surfaces a probe might touch, and which effects may act on it. A collection is exact
// until the probe has moved by a margin. Whatever it leaves out is not evaluated.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "broad_phase/bounding_tree.hpp"
#include "scene/kind_ops.hpp"
#include "scene/scene_state.hpp"

namespace knurl::detail {

/// A collection made at `at` contains all that is near until a probe has moved by `margin`.
struct Coverage {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m
    double margin = -1;                            // m; negative: must be collected anew
    double wanted = 0;                             // m, the next margin

    static constexpr double rounding = 1 - 5e-5;  // of the margin, so that rounding of positions does not
                                                  // exceed it
    void expire() noexcept { margin = -1; }
    bool expired() const noexcept { return margin < 0; }
    /// Does it hold for a probe at p whose contact reaches `deep` (m) farther than the probe?
    bool holds(const Eigen::Vector3d& p, double deep) const noexcept {
        const double within = margin * rounding - deep;
        return within > 0 && (p - at).squaredNorm() < within * within;
    }
    /// How far the probe may move before it ceases to hold (m).
    double left(const Eigen::Vector3d& p, double deep) const noexcept {
        return margin * rounding - deep - (p - at).norm();
    }
};

/// The present place of the ball around the record; nothing: the surface is endless.
std::optional<Bound> ball_now(const Record& record, const Clock& clock) noexcept;
/// A surface that was not evaluated in the last cycle that took time was out of reach then. Gives its state
/// what that evaluation would have left: no path before that cycle, and the probe where it was. `held`: m, by
/// which its set held the probe then.
void catch_up(Record& record, const SceneState& state, const Eigen::Vector3d& held) noexcept;

/// Candidates among the surfaces. A surface that is endless and moves is always a candidate.
class SurfaceCandidates {
  public:
    SurfaceCandidates(std::size_t slots, std::size_t probes);

    void place(std::uint32_t slot, const SceneState& state) noexcept;
    void forget(std::uint32_t slot, const Record& current) noexcept;  // starting from where it was placed
    /// For a surface that was always a candidate: it stays one, unless it may be out of reach from now on.
    void place_again(std::uint32_t slot, const SceneState& state) noexcept;
    void index() { tree_.index(); }
    void reset() noexcept;

    /// True if a probe has moved out of its collection. depth_of(probe): m, how far its proxies may lie from
    /// it.
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
    /// Do the candidates cover the way of a proxy that is so far from its probe (m)?
    bool covers(std::uint32_t probe, const SceneState& state, double depth) const noexcept {
        return probes_[probe].coverage.holds(state.probes[probe].probe.position, depth);
    }
    /// True: the candidates have changed. `deepest` (m): of the present and the fading set.
    bool collect(std::uint32_t probe, SceneState& state, double deepest) noexcept;
    /// True: the probe cannot reach this fading ball. It is evaluated again when the probe may reach it.
    bool passes_by(std::uint32_t probe, const Bound& ball, const SceneState& state) noexcept;

    std::uint32_t probes() const noexcept {
        return used_;
    }  // bit mask: those with surfaces that may be out
       // of reach
    bool may_be_near(std::uint32_t slot) const noexcept {
        return !slots_[slot].bounded || slots_[slot].candidate;
    }
    bool bounded(std::uint32_t slot) const noexcept { return slots_[slot].bounded; }
    bool any(std::uint32_t probe) const noexcept { return probes_[probe].bounded > 0; }
    std::span<const std::uint32_t> always() const noexcept { return always_; }
    std::span<const std::uint32_t> of(std::uint32_t probe) const noexcept { return probes_[probe].list; }
    /// How far the probe may move until other surfaces may be near (m); 0: unknown.
    double sleep_radius(std::uint32_t probe, const SceneState& state, double deepest) const noexcept;
    void lose_sight(std::uint32_t slot) noexcept { slots_[slot].candidate = false; }

  private:
    struct SurfaceSlot {
        bool bounded = false;    // it may be out of reach, so it is in a set only while it is a candidate
        bool candidate = false;  // it is one at present
        bool endless = false;    // it has no ball; its clearance says how far away it is
        std::uint32_t place = 0;
    };
    struct Candidates {
        Coverage coverage;
        double until = 0;  // s, of the scene's time, at which other surfaces may come near
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

/// Candidates among the effects with a finite reach.
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
    /// `effects`: all active ones; `scratch`: room for as many.
    void collect(std::uint32_t probe, std::span<const std::uint32_t> effects,
                 std::span<std::uint32_t> scratch, SceneState& state) noexcept;

    std::uint32_t probes() const noexcept { return used_; }  // bit mask: those with effects of finite reach
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
