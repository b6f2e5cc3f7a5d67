#pragma once

/// @file
/// What one claim has active, and the one place for what all representations share: the joint contact
/// solution of each probe, the cross-fade from the old set's force to the new set's, the sum of effects,
/// skipping.

#include <cstdint>
#include <memory>
#include <span>

#include <knurl/reps/bounds.hpp>
#include <knurl/reps/hand_budget.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/reps/probe.hpp>
#include <knurl/reps/scene_time.hpp>
#include <knurl/reps/wrench.hpp>

namespace knurl {

struct Asset;  // knurl/geometry/asset.hpp

/// Names one representation of a scene. One of an older generation names nothing any more.
struct RepresentationId {
    /// Place in the scene, from 0.
    std::uint32_t slot = 0;
    /// Counts how often the slot was used anew, from 1.
    std::uint32_t generation = 0;
    friend bool operator==(RepresentationId, RepresentationId) = default;
};

/// What a representation does when its application falls silent.
enum class OnSilence : std::uint32_t {
    /// Fades out.
    fade = 0,
    /// Stands still and goes on acting.
    hold = 1,
    /// Moves on for `silence_time`, then fades out.
    move = 2,
};

/// Beside its own parameters: how a representation is used. Fixed when it is added.
struct AddOptions {
    /// Probe on which it acts, 0 to 15.
    std::uint32_t probe = 0;
    /// What it does when its application falls silent.
    OnSilence on_silence = OnSilence::fade;
    /// Time for which `move` goes on (s).
    double silence_time = 0.1;
    /// 0: its wrench and contact point are not reported.
    std::uint32_t feedback = 1;
    /// Padding; 0.
    std::uint32_t reserved = 0;
};

/// How changes reach the hand in this scene.
struct FadePolicy {
    /// Present meaning of `recovery = automatic` (s).
    double automatic = 0.01;
    /// Largest speed with which a surface rises under the hand (m/s of the hand, Limits::metre); infinity: no
    /// such rule.
    double rise_speed = 0.1;
};

/// What the application learns of one representation each cycle.
struct Feedback {
    /// Which representation.
    RepresentationId id;
    /// Wrench on the hand (N, N m), world frame; the application's end feels the opposite; zero where it is
    /// not touched. Of a surface while `fading` is set: its share in the new set, weighted as that is, though
    /// it may be in the old set unchanged; the force of the whole hand has no such gap. Of an effect all of
    /// it.
    Wrench wrench;
    /// Contact point (m), world frame; where it is not touched, the probe (see Scene::feedback for when).
    Eigen::Vector3d contact_point = Eigen::Vector3d::Zero();
    /// Stiffness as applied, after clamping (N/m).
    double stiffness = 0;
    /// Stiffness of its friction, as applied (N/m).
    double tangential_stiffness = 0;
    /// Bit mask of `touching` and the others.
    std::uint32_t flags = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;

    /// Flag: it acts on the hand in this cycle.
    static constexpr std::uint32_t touching = 1;
    /// Flag: less stiff than the application set.
    static constexpr std::uint32_t stiffness_clamped = 2;
    /// Flag: its contact set contradicts itself; the force is bounded.
    static constexpr std::uint32_t infeasible = 4;
    /// Flag: a change is still being cross-faded.
    static constexpr std::uint32_t fading = 8;
    /// Flag: its application has fallen silent.
    static constexpr std::uint32_t silent = 16;
};

/// Which entries of kept feedback were written: a bit each, 64 to a word, as many words as that takes.
struct Rewritten {
    /// Entries that were written wholly: those that are touched, and those that differ.
    std::span<std::uint64_t> wholly;
    /// Entries of which `flags` alone was written, of what is not touched.
    std::span<std::uint64_t> flags;
};

/// What each stage did in the last cycle, so that skipping can be counted. What a scene does not need is 0.
struct SceneWork {
    /// Slots that were changed.
    std::uint32_t changes = 0;
    /// Broad phase: searches for the surfaces or effects near a probe.
    std::uint32_t collections = 0;
    /// Contact sets that were built.
    std::uint32_t sets = 0;
    /// Representations that were evaluated, surfaces and effects alike.
    std::uint32_t evaluated = 0;
    /// Solutions of the joint contact, one for each stiffness of a set.
    std::uint32_t layers = 0;
    /// Steps to where curved surfaces meet; at most max_curved_rounds a layer.
    std::uint32_t curved_rounds = 0;
    /// Probes with friction, texture or a braking pulse.
    std::uint32_t tangential = 0;
    friend bool operator==(const SceneWork&, const SceneWork&) = default;
};

/// All representations of one claim, and the stages that evaluate them. Used by one thread; nothing but the
/// constructor and index() allocates.
class Scene {
  public:
    /// How much a scene has room for.
    struct Capacity {
        /// Representations, 1 to max_representations.
        std::uint32_t representations = 128;
        /// Probes, 1 to max_probes.
        std::uint32_t probes = 16;
    };
    /// Most representations.
    static constexpr std::uint32_t max_representations = knurl::max_representations;
    /// Most probes.
    static constexpr std::uint32_t max_probes = knurl::max_probes;

    /// Allocates all that it will ever need; every later call but index() is noexcept and allocates nothing.
    Scene(Capacity capacity, const Limits& limits);
    ~Scene();
    /// Moves; the other one holds nothing any more.
    Scene(Scene&&) noexcept;
    /// Moves; the other one holds nothing any more.
    Scene& operator=(Scene&&) noexcept;

    /// The device's limits in world units. Changed limits are a change of all representations, in one
    /// cross-fade.
    void set_limits(const Limits& limits) noexcept;
    /// How changes reach the hand from now on.
    void set_fade(const FadePolicy& policy) noexcept;
    /// Places a probe on the hand.
    Verdict place_probe(std::uint32_t probe, const ProbePlacement& placement) noexcept;

    /// What `add` would answer. Each change is checked first, and one that is refused changes nothing. All
    /// changes made between two calls of `evaluate` take effect together, in one cross-fade.
    Verdict check_add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                      const AddOptions& options) const noexcept;
    /// Adds a representation.
    Verdict add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                const AddOptions& options) noexcept;
    /// What `update` would answer. `bytes`: of all parameters, or of the geometry alone
    /// (KindInfo::geometry_bytes); then the rest stays as it is.
    Verdict check_update(RepresentationId id, Kind kind, const void* params, std::size_t bytes) noexcept;
    /// New parameters of a representation; `bytes` as for check_update.
    Verdict update(RepresentationId id, Kind kind, const void* params, std::size_t bytes) noexcept;
    /// `update` of what check_update has accepted since the last add, update or remove: not checked again.
    /// All of a batch may be checked first; of several updates of one slot, all in the order of their checks.
    void update_checked(RepresentationId id, const void* params, std::size_t bytes) noexcept;
    /// Removes a representation: it fades over its `recovery`.
    Verdict remove(RepresentationId id) noexcept;
    /// Removes all, at once, with no fade.
    void clear() noexcept;

    /// The changes made since the last `evaluate` take effect at once, with no fade or motion.
    void settle() noexcept;

    /// Adds a representation.
    template <Described R>
    Verdict add(RepresentationId id, const R& params, const AddOptions& options = {}) noexcept {
        return add(id, kind_number<R>(), &params, sizeof params, options);
    }
    /// New parameters of a representation.
    template <Described R>
    Verdict update(RepresentationId id, const R& params) noexcept {
        return update(id, kind_number<R>(), &params, sizeof params);
    }

    /// Meaning of `asset = number` (1 to max_assets) for the representations that are added or changed from
    /// now on; null: no asset. The asset outlives all that refers to it.
    void set_asset(std::uint32_t number, const Asset* asset) noexcept;
    /// True: something that acts, or still fades, is made of this asset.
    bool refers_to(const Asset& asset) const noexcept;

    /// Scenes of more than some thousand bounded surfaces (spheres, boxes, ...): sorts them into a tree, so
    /// that those out of reach cost nothing. Call it after adding many, outside of any cycle: it allocates.
    /// What changes later is found all the same, only by a scan.
    void index();

    /// Scales from now on; from a HandBudget.
    void set_scales(const HandScales& scales) noexcept;

    /// For how long the application has been silent (s); 0 or less: it is not. Acts through
    /// AddOptions::on_silence.
    void set_silence(double seconds) noexcept;

    /// The wrench on the hand, about the hand's position. `hand` is the device's tip in world coordinates;
    /// the probes are placed on it. dt in s (0: same wrench, no state advances).
    Wrench evaluate(const Probe& hand, double dt) noexcept;

    /// After `evaluate` and the feedback that is kept: nothing acts, fades or moves, and so it stays while
    /// nothing is changed and the hand is nearer than this (m, world) to where it was then. Until then the
    /// scene need not be evaluated. 0: that cannot be said.
    double sleep_radius() const noexcept;
    /// True: a change, or a silence that began or ended, waits for the next `evaluate`.
    bool changed() const noexcept;
    /// Time for which the scene has been evaluated.
    SceneTime time() const noexcept;
    /// In place of so many calls of `evaluate`, in which time passed, while it slept: afterwards it is
    /// `time`, and the last of them had this hand. The same bits as if they had been made.
    void pass(std::uint64_t cycles, const SceneTime& time, const Probe& hand) noexcept;

    /// After `evaluate`: contact point (m) of probe 0 in the new set; else probe 0 itself.
    Eigen::Vector3d contact_point() const noexcept;
    /// What lies in a slot, as it was added and changed; for programs that show it.
    struct Shown {
        /// Slot and generation.
        RepresentationId id;
        /// Its kind.
        Kind kind = 0;
        /// How it is used.
        AddOptions options;
        /// Its parameters; valid until the next change.
        std::span<const std::byte> params;
    };
    /// What lies in this slot; no parameters: nothing does.
    Shown shown(std::uint32_t slot) const noexcept;
    /// Where a probe was placed.
    ProbePlacement placement(std::uint32_t probe) const noexcept;

    /// Number of representations.
    std::uint32_t size() const noexcept;
    /// Number of representations of this kind.
    std::uint32_t count(Kind kind) const noexcept;
    /// What each stage did in the last cycle.
    const SceneWork& work() const noexcept;
    /// Representations that were evaluated in the last cycle.
    std::uint32_t evaluated() const noexcept { return work().evaluated; }
    /// Load of all this on the hand in the last cycle at full strength, for a HandBudget. Textures, and what
    /// pushes away, do not count.
    SceneLoad load() const noexcept;
    /// Bound of the eigenvalues of load(), for next to nothing.
    LoadBound load_bound() const noexcept;
    /// Fills in feedback of the representations whose options ask for it; returns how many (at most
    /// out.size()).
    std::size_t feedback(std::span<Feedback> out) const noexcept;
    /// The same for a `kept` that holds what the call before left there: what is not touched and has not
    /// changed stays as it is, its contact point too. What was written it marks in `rewritten`.
    std::size_t feedback(std::span<Feedback> kept, const Rewritten& rewritten) noexcept;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl
