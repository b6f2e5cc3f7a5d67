#pragma once
// What one claim has active, and the one place for what all representations share: the joint contact solution
// of each probe, the cross-fade from the old set's force to the new set's, the sum of effects, skipping.

#include <cstdint>
#include <memory>
#include <span>

#include <knurl/reps/all.hpp>
#include <knurl/reps/hand_budget.hpp>
#include <knurl/reps/scene_time.hpp>

namespace knurl {

/// Names one representation of a scene. One of an older generation names nothing any more.
struct RepresentationId {
    std::uint32_t slot = 0;
    std::uint32_t generation = 0;
    friend bool operator==(RepresentationId, RepresentationId) = default;
};

/// What a representation does when its application falls silent.
enum class OnSilence : std::uint32_t { fade = 0, hold = 1, move = 2 };

/// Beside its own parameters: how a representation is used. Fixed when it is added.
struct AddOptions {
    std::uint32_t probe = 0;  // which probe it acts on, 0-15
    OnSilence on_silence = OnSilence::fade;
    double silence_time = 0.1;   // s: `move` goes on for this time, then fades
    std::uint32_t feedback = 1;  // 0: its wrench and contact point are not reported
    std::uint32_t reserved = 0;
};

/// How changes reach the hand in this scene.
struct FadePolicy {
    double automatic = 0.01;  // s, what `recovery = automatic` means at the moment
    double rise_speed =
        0.1;  // m/s of the hand (Limits::metre), a surface rising under the hand is not faster; infinity: no such rule
};

/// What the application learns of one representation each cycle.
struct Feedback {
    RepresentationId id;
    // On the hand; the application's end feels the opposite; zero where it is not touched. Of a surface while
    // `fading` is set: its share in the new set, weighed as that is, though it be in the old one unchanged;
    // the force of the whole hand has no such gap. Of an effect it is all of it.
    Wrench wrench;
    // m, world; where it is not touched, the probe (see Scene::feedback for when)
    Eigen::Vector3d contact_point = Eigen::Vector3d::Zero();
    double stiffness = 0;             // N/m as applied, after clamping
    double tangential_stiffness = 0;  // N/m of its friction, as applied
    std::uint32_t flags = 0;          // Feedback::touching, ...
    std::uint32_t reserved = 0;

    static constexpr std::uint32_t touching = 1;           // the hand feels it in this cycle
    static constexpr std::uint32_t stiffness_clamped = 2;  // less stiff than asked for
    static constexpr std::uint32_t infeasible = 4;  // its set contradicts itself; the answer is bounded
    static constexpr std::uint32_t fading = 8;      // a change is still being cross-faded
    static constexpr std::uint32_t silent = 16;     // its application has fallen silent
};

/// Which entries of kept feedback were written: a bit each, 64 to a word, as many words as that takes.
struct Rewritten {
    std::span<std::uint64_t> wholly;  // all that is touched, and all that differs
    std::span<std::uint64_t> flags;   // nothing but `flags` was written, of what is not touched
};

/// What each stage did in the last cycle, so that skipping can be counted. What a scene does not need is 0.
struct SceneWork {
    std::uint32_t changes = 0;      // slots that were taken
    std::uint32_t collections = 0;  // broad phase: for a probe, of the surfaces or effects that are near
    std::uint32_t sets = 0;         // contact sets that were built
    std::uint32_t evaluated = 0;    // representations, surfaces and effects alike
    std::uint32_t layers = 0;       // joint contact: solutions, one for each stiffness of a set
    // Steps to where curved surfaces meet; at most max_curved_rounds a layer.
    std::uint32_t curved_rounds = 0;
    std::uint32_t tangential = 0;  // probes with friction, texture or a braking pulse
    friend bool operator==(const SceneWork&, const SceneWork&) = default;
};

class Scene {
  public:
    struct Capacity {
        std::uint32_t representations = 128;
        std::uint32_t probes = 16;
    };
    static constexpr std::uint32_t max_representations = knurl::max_representations;
    static constexpr std::uint32_t max_probes = knurl::max_probes;

    /// Allocates all it will ever need; every later call is noexcept and allocates nothing.
    Scene(Capacity capacity, const Limits& limits);
    ~Scene();
    Scene(Scene&&) noexcept;
    Scene& operator=(Scene&&) noexcept;

    void set_limits(const Limits& limits) noexcept;
    void set_fade(const FadePolicy& policy) noexcept;
    Verdict place_probe(std::uint32_t probe, const ProbePlacement& placement) noexcept;

    // Changes. Each call checks first and changes nothing when it refuses. All changes made between two calls
    // of `evaluate` are one change of the set: they take effect together, in one cross-fade.
    Verdict check_add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                      const AddOptions& options) const noexcept;
    Verdict add(RepresentationId id, Kind kind, const void* params, std::size_t bytes,
                const AddOptions& options) noexcept;
    /// `bytes`: of all parameters, or of the geometry alone (KindInfo::geometry_bytes): then the rest stays as it
    /// is.
    Verdict check_update(RepresentationId id, Kind kind, const void* params, std::size_t bytes) noexcept;
    Verdict update(RepresentationId id, Kind kind, const void* params, std::size_t bytes) noexcept;
    /// `update` of what check_update has accepted since the last add, update or remove: not checked again.
    /// All of a batch may be checked first; of several updates of one slot, all in the order of their checks.
    void update_checked(RepresentationId id, const void* params, std::size_t bytes) noexcept;
    Verdict remove(RepresentationId id) noexcept;
    void clear() noexcept;  // removes all, at once, with no fade

    /// The changes made since the last `evaluate` are there from the start: taken at once, with no fade or
    /// motion.
    void settle() noexcept;

    template <Listed R>
    Verdict add(RepresentationId id, const R& params, const AddOptions& options = {}) noexcept {
        return add(id, kind_of<R>, &params, sizeof params, options);
    }
    template <Listed R>
    Verdict update(RepresentationId id, const R& params) noexcept {
        return update(id, kind_of<R>, &params, sizeof params);
    }

    /// What `asset = number` means (1 to max_assets) to the representations that are added or changed from
    /// now on; null: nothing. It outlives all that refers to it.
    void set_asset(std::uint32_t number, const Asset* asset) noexcept;
    /// Something that is felt, or still fades, is made of it.
    bool refers_to(const Asset& asset) const noexcept;

    /// Scenes of more than some thousand bounded surfaces (spheres, boxes, ...): sorts them into a tree, so
    /// that those out of reach cost nothing. Call it after adding many, outside of any cycle: it allocates.
    /// What changes later is found all the same, only by a scan.
    void index();

    /// From now on; of a HandBudget.
    void set_scales(const HandScales& scales) noexcept;

    /// For how long the application has been silent (s); 0 or less: it is not. Acts through
    /// AddOptions::on_silence.
    void set_silence(double seconds) noexcept;

    /// The wrench on the hand, about the hand's position. `hand` is the device's tip in world coordinates;
    /// the probes are placed on it. dt in s (0: same wrench, no state advances).
    Wrench evaluate(const Probe& hand, double dt) noexcept;

    // A scene out of the hand's reach need not be evaluated.
    /// After `evaluate` and the feedback that is kept: nothing is felt, fades or moves, and so it stays while
    /// nothing is changed and the hand is nearer than this (m, world) to where it was then. 0: that cannot be
    /// said.
    double sleep_radius() const noexcept;
    /// It was told of a change, or of a silence that begins or ends, which `evaluate` has not seen.
    bool changed() const noexcept;
    SceneTime time() const noexcept;
    /// In place of so many calls of `evaluate`, in which time passed, while it slept: afterwards it is
    /// `time`, and the last of them had this hand. The same bits as if they had been made.
    void pass(std::uint64_t cycles, const SceneTime& time, const Probe& hand) noexcept;

    // After `evaluate`:
    Eigen::Vector3d contact_point() const noexcept;  // of probe 0, in the new set; else probe 0 itself
    std::uint32_t size() const noexcept;             // representations present
    std::uint32_t count(Kind kind) const noexcept;
    const SceneWork& work() const noexcept;
    std::uint32_t evaluated() const noexcept { return work().evaluated; }
    /// What the hand feels of all this in the last cycle at full strength, for a HandBudget; and at least its
    /// eigenvalues, for next to nothing. Of textures and of what pushes away nothing counts.
    SceneLoad load() const noexcept;
    LoadBound load_bound() const noexcept;
    /// Fills in feedback of the representations that ask for it; returns how many (at most out.size()).
    std::size_t feedback(std::span<Feedback> out) const noexcept;
    /// The same for a `kept` that holds what the call before left there: what is not touched and has not
    /// changed stays as it is, its contact point too. What was written it marks in `rewritten`.
    std::size_t feedback(std::span<Feedback> kept, const Rewritten& rewritten) noexcept;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl
