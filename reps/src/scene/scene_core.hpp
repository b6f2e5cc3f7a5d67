#pragma once
// The pipeline of one scene. Calls from outside write only the model. The next evaluation takes all changes
// together, as one change of the set with one cross-fade:
//
//   model ── changes ──> broad phase ──> contact sets ──> contact stage (narrow phase, joint contact, cross-fade,
//                                                          tangential) ─┐
//                  └──> effect stage ──────────────────────────────────┴──> wrench ──> load, feedback
//
// The constructor allocates everything.

#include <array>
#include <cstddef>

#include "broad_phase/broad_phase.hpp"
#include "contact/contact_sets.hpp"
#include "contact/contact_stage.hpp"
#include "effects/effect_stage.hpp"
#include "load/load_stage.hpp"
#include "scene/feedback_stage.hpp"
#include "scene/scene_model.hpp"
#include "scene/scene_state.hpp"

namespace knurl::detail {

class SceneCore {
  public:
    SceneCore(Scene::Capacity capacity, const Limits& limits);
    SceneCore(const SceneCore&) = delete;
    SceneCore& operator=(const SceneCore&) = delete;

    SceneModel& model() noexcept { return model_; }
    const SceneModel& model() const noexcept { return model_; }
    FeedbackStage& feedback() noexcept { return feedback_; }
    const FeedbackStage& feedback() const noexcept { return feedback_; }
    const LoadStage& load() const noexcept { return load_; }

    void clear() noexcept;
    void settle() noexcept { state_.settles = true; }
    void index();
    void set_limits(const Limits& limits) noexcept;
    void set_fade(const FadePolicy& policy) noexcept { state_.policy = policy; }
    void set_scales(const HandScales& scales) noexcept { state_.scales = scales; }
    void set_asset(std::uint32_t number, const Asset* asset) noexcept;
    bool refers_to(const Asset& asset) const noexcept;
    void set_silence(double seconds) noexcept;

    Wrench evaluate(const Probe& hand, double dt) noexcept;
    const SceneWork& work() const noexcept { return state_.work; }
    const SceneTime& time() const noexcept { return state_.clock.now; }

    // scene_sleep.cpp
    bool changed() const noexcept;
    double sleep_radius() const noexcept;
    void pass(std::uint64_t cycles, const SceneTime& time, const Probe& hand) noexcept;

  private:
    void advance_clock(double dt) noexcept;
    void place_probes(const Probe& hand) noexcept;
    bool has_changed() noexcept;
    void advance_weights(double dt) noexcept;
    double sleep_radius_of(std::uint32_t probe) const noexcept;

    // scene_changes.cpp
    void take_changes() noexcept;
    void take_placements() noexcept;
    void take_slot(std::uint32_t slot) noexcept;
    bool reshape(std::uint32_t slot) noexcept;
    bool change(std::uint32_t slot, bool was, bool is, bool same) noexcept;  // false: the slot acts as before
    void change_surface(std::uint32_t slot, bool was, bool is, bool same) noexcept;
    void retire_surface(std::uint32_t slot, bool same, bool listed) noexcept;
    void install_surface(std::uint32_t slot, const Record& now, bool same, bool listed) noexcept;
    void fade_retired(std::uint32_t slot, const Record& now, bool is) noexcept;
    void change_effect(std::uint32_t slot, bool was, bool is, bool same) noexcept;
    void renew(std::uint32_t slot, const Record* previous) noexcept;
    void swap_records(std::uint32_t slot, bool same) noexcept;
    void cross_fade(const Record& judged) noexcept;

    SceneModel model_;
    SceneState state_;
    SurfaceCandidates candidates_;
    ContactSets sets_;
    ContactStage contacts_;
    EffectStage effects_;
    FeedbackStage feedback_;
    LoadStage load_;
    alignas(16) std::array<std::byte, max_params> prepared_{};  // of the slot under change
};

}  // namespace knurl::detail
