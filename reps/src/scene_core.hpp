#pragma once
// What Scene is made of. One slot per handle; each slot has the parameters as sent (`raw`), the record that
// is felt (`now`) and the record that is being faded out (`old`). Calls from outside write raw parameters
// only; the next evaluate takes all of them together:
//
//   add, update, remove -> raw, `changed` list          (checked, nothing felt yet)
//   evaluate -> take_changes: now -> old, raw -> now    (one change of the set, one cross-fade)
//            -> weights (silence) -> contacts of each probe -> effects -> sum
//
// Surfaces lie sorted by stiffness as structure of arrays, per probe and set, in one of two arenas; a change
// builds the other one. Everything is allocated by the constructor.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <knurl/reps/curved_contact.hpp>
#include <knurl/reps/motion.hpp>
#include <knurl/reps/scene.hpp>

#include "reach.hpp"
#include "scene_state.hpp"

namespace knurl::detail {

class SceneCore;

/// By number less one; null: there is none.
using Assets = std::array<const Asset*, max_assets>;

/// By which loads become shares of what the device stands; 0: of what is not known.
struct Shares {
    double stiffness = 0, damping = 0;  // m/N, m/(N s)
    double turning = 0;  // 1/m^2: an arm's square makes this share of rotation of one of translation
};
Shares shares_of(const Limits& limits) noexcept;

/// Of one part, at most: in N/m and N s/m, or as shares of what the device stands.
struct Demand {
    double stiffness = 0, damping = 0;
};

/// In scenes of more surfaces than this, curved ones that hold together do so where their tangent planes at the probe's
/// feet meet. Where hundreds lie in each other, what is found depends on where the search began, and then on which
/// surfaces were out of reach; and it has a bound of time.
inline constexpr std::uint32_t max_curved_surfaces = 64;

/// What the scene knows of a kind: functions over raw bytes, made from the typed ones.
struct KindOps {
    bool surface = false;
    bool turns = false;          // a surface's velocity is that of its contact
    bool curved = false;         // a surface that may not be flat
    std::uint32_t contacts = 1;  // tangent planes of a surface, at most
    std::size_t params_size = 0, state_size = 0;
    // Parameters as they would be felt.
    void (*prepare)(const std::byte* raw, const Limits&, std::byte* prepared) noexcept = nullptr;
    // They are the bytes that are felt; another recovery alone is noted for the change that it will belong
    // to.
    bool (*unchanged)(std::byte* prepared, Record& now) noexcept = nullptr;
    // Of a surface that may stand: the leading bytes of its parameters that its plane follows from.
    std::size_t shape_bytes = 0;
    // How a shape that was sent differs from the one that is there: anywhere, that is not legal.
    Differ (*compare_shape)(const std::byte* raw, const std::byte* sent) noexcept = nullptr;
    // Puts a surface that stands elsewhere: `out` has all but the shape. False: it is there already.
    bool (*reshape)(const std::byte* raw, const Limits&, Record& now, Record& out,
                    double& recovery) noexcept = nullptr;
    // Parameters and what follows from them; not state and use. `rough` only where the record says so.
    void (*install)(const std::byte* prepared, const Limits&, Record& out, Rough& rough) noexcept = nullptr;
    void (*adopt)(Record& now, const Record* previous, const Probe&, const Assets&) noexcept = nullptr;
    void (*settle)(Record&) noexcept = nullptr;
    double (*fade_time)(const std::byte* params) noexcept = nullptr;        // s, or automatic
    double (*asked_stiffness)(const std::byte* raw) noexcept = nullptr;     // N/m
    Demand (*load_bound)(const Record&, const Limits&) noexcept = nullptr;  // of an effect
    HandLoad (*load)(const Record&, const Probe&) noexcept = nullptr;       // of an effect, at the probe
    bool (*carry)(Record& old, const Record& next) noexcept = nullptr;      // true: the rest is equal too
    std::optional<Bound> (*bound)(const Record&) noexcept = nullptr;
    // Of an effect: it gives nothing wherever the probe is; it has nothing more to arrive at by itself.
    bool (*powerless)(const Record&) noexcept = nullptr;
    bool (*arrived)(const Record&) noexcept = nullptr;
    // Of a surface without an end that stands still: m, it is no nearer.
    std::optional<double> (*clearance)(const Record&, const Probe&) noexcept = nullptr;
    void (*out_of_reach)(Record&) noexcept = nullptr;         // its path so far is forgotten
    Motion* (*motion)(Record&) noexcept = nullptr;            // of a surface
    const Asset* (*asset)(const Record&) noexcept = nullptr;  // that it is made of; null: of none
    std::uint32_t (*contact)(Record&, const Probe&, double dt, std::span<Contact> out) noexcept = nullptr;
    std::uint32_t (*curved_at)(const Record&, const Probe&, const Probe& there,
                               std::span<CurvedContact> out) noexcept = nullptr;
    void (*lean)(Record&, const Probe& there) noexcept = nullptr;
    Wrench (*evaluate)(Record&, const Probe&, double dt) noexcept = nullptr;
    void (*evaluate_all)(SceneCore&, std::span<const std::uint32_t> slots, double dt,
                         Wrench& sum) noexcept = nullptr;
};
extern const std::array<KindOps, Representations::size> all_ops;
inline const std::array<KindOps, Representations::size>& kind_ops() noexcept {
    return all_ops;
}

Limits sane_limits(Limits limits) noexcept;
/// Of a layer's planes as they are; p is the probe. False: they contradict each other.
[[gnu::always_inline]] inline bool solve_planes(Layer& layer, const ContactPlanes& planes, double worst,
                                                const Eigen::Vector3d& p) noexcept {
    const double given = layer.give;
    solve_contact_relaxed(planes, worst, layer.give, layer.solution);
    if (layer.give != given) layer.given_at = worst;
    if (layer.solution.status == ContactSolution::Status::solved) {
        layer.proxy = p + layer.solution.dx;
        return !(layer.give > 0);
    }
    // Bounded whatever happens: the proxy stays where it was.
    layer.solution.dx = layer.proxy - p;
    layer.solution.active.count = 0;
    return false;
}
/// As for a set that has never been solved.
void forget_solution(ContactSet& set, const Group& group) noexcept;
/// Nothing is felt along the surface, nor remembered of it, and time makes no difference any more.
bool rests_along(const Group& group) noexcept;
/// The number of the group's next fade.
inline std::uint32_t next_fade(const Group& group) noexcept {
    return group.fade + 1 != 0 ? group.fade + 1 : 1;
}
/// As long as the kind's parameters and state are.
void copy(const Record& from, Record& to) noexcept;

class SceneCore {
  public:
    SceneCore(Scene::Capacity capacity, const Limits& limits);

    // scene_slots.cpp
    Verdict check_add(Handle, Kind, const void* params, std::size_t bytes, const Use&) const noexcept;
    Verdict check_update(Handle, Kind, const void* params, std::size_t bytes) noexcept;
    Verdict validate(Kind, const std::byte* raw, const std::byte* sent, std::size_t bytes) noexcept;
    void write_checked(std::uint32_t slot, const void* params, std::size_t bytes) noexcept;
    void mark(std::uint32_t slot) noexcept;
    void clear() noexcept;

    // scene_changes.cpp
    void take_changes() noexcept;
    void take_slot(std::uint32_t slot) noexcept;
    [[gnu::always_inline]] inline void reshape(std::uint32_t slot) noexcept;
    bool change(std::uint32_t slot, bool was, bool is, bool same) noexcept;  // false: it is the same still
    void note_change(const Record& judged) noexcept;
    void renew(std::uint32_t slot, const Record* previous) noexcept;
    void keep_old(std::uint32_t slot) noexcept {
        Slot& s = slots_[slot];
        s.old_surface_of = faded(slot).probe;
        s.old_in_fade = 0;
        if (s.old_listed) return;
        s.old_listed = true;
        fading_olds_[fading_olds_size_++] = slot;
    }
    void turn(std::uint32_t slot, bool same) noexcept;
    void change_surface(std::uint32_t slot, bool was, bool is, bool same) noexcept;
    void change_effect(std::uint32_t slot, bool was, bool is, bool same) noexcept;
    void release_old(std::uint32_t slot) noexcept;
    void take_placements() noexcept;
    double fade_time(const Record& record) const noexcept;

    // scene_sets.cpp
    void rebuild_sets() noexcept;
    void begin_fade(Group& group, std::uint32_t probe) noexcept;
    std::uint32_t list_old(Group& group, std::uint32_t probe) noexcept;
    std::uint32_t list_now(const Group& group, std::uint32_t probe) noexcept;
    void make_bridge(Group& group) noexcept;
    void build(ContactSet& set, const Group& group, Arena& into, std::span<const Owner> owners) noexcept;
    void built(Group& group, std::uint32_t probe) noexcept;
    void end_fade(Group& group) noexcept;
    void release(Group& group) noexcept;
    Owner owner(std::uint32_t slot, bool old) const noexcept {
        return slot * 2 + (slots_[slot].current ^ (old ? 1u : 0u));
    }
    bool fades_out(Owner owner) const noexcept { return (owner & 1) != slots_[owner >> 1].current; }
    Record& record(Owner owner) noexcept { return records_[owner]; }
    const Record& record(Owner owner) const noexcept { return records_[owner]; }
    Record& felt(std::uint32_t slot) noexcept { return records_[owner(slot, false)]; }
    const Record& felt(std::uint32_t slot) const noexcept { return records_[owner(slot, false)]; }
    Record& faded(std::uint32_t slot) noexcept { return records_[owner(slot, true)]; }
    const Record& faded(std::uint32_t slot) const noexcept { return records_[owner(slot, true)]; }
    Rough& rough(Owner owner) noexcept { return rough_[owner]; }
    const Rough& rough(Owner owner) const noexcept { return rough_[owner]; }

    // scene_reshape.cpp
    bool reshape_sets() noexcept;
    bool make_room_for_old(Group& group) noexcept;
    void copy_to_old(Group& group) noexcept;
    void replace_old(Group& group, std::uint32_t probe) noexcept;

    // scene_near.cpp
    bool may_be_far(const Record& surface) const noexcept;
    void place_surface(std::uint32_t slot) noexcept;   // in Reach, or among those that are always asked
    void forget_surface(std::uint32_t slot) noexcept;  // from where it was
    void fetch(std::span<const std::uint32_t> slots) const noexcept;
    void collect_near(Group& group, std::uint32_t probe) noexcept;
    std::optional<Bound> ball_now(const Record& record) const noexcept;  // where it has moved on to
    void catch_up(Record& record) noexcept;  // with the last cycle, having been out of reach
    bool near_left() noexcept;               // a probe has moved out of what its candidates cover

    // scene_contact.cpp
    void evaluate_contacts(double dt, Wrench& sum) noexcept;
    const Layer* solve(ContactSet& set, const Group& group, double worst) noexcept;
    bool near_falls_short() noexcept;

    // scene_curved.cpp
    bool solve_curved(ContactSet& set, const Group& group, Layer& layer, double worst) noexcept;
    bool solve_curved_layer(ContactSet& set, const Group& group, Layer& layer, double worst) noexcept;
    const CurvedStart* start_of(const Layer& layer) const noexcept;
    bool meet_elsewhere(const ContactSet& set, const Group& group, const Layer& layer) const noexcept;
    std::uint32_t list_near_surfaces(const ContactSet& set, const Group& group, const Layer& layer,
                                     const Eigen::Vector3d& dx, double within) noexcept;
    CurvedStarts starts_of(const ContactSet& set, const Group& group) const noexcept;
    void take_starts(ContactSet& set, const Arena& arena, const CurvedStarts& starts) noexcept;
    void lean(const ContactSet& set, const Group& group) noexcept;
    double relief_at(Owner owner, std::uint32_t member, std::uint32_t part) const noexcept;

    double damped_force(ContactSet& set, const Group& group, const Layer& top) noexcept;
    void evaluate_set(ContactSet& set, const Group& group, double dt) noexcept;
    void prime(Record& record, const Group& group) noexcept;
    double ask(ContactSet& set, const Group& group, double dt, double worst) noexcept;
    double ask_one(const ContactSet& set, const Group& group, double dt, std::uint32_t member) noexcept;
    double texture_gain_of(const Record& record, const Texture& texture, const Group& group) const noexcept;
    void add_summed(ContactSet& set, const Group& group) noexcept;

    // scene_along.cpp
    Eigen::Vector3d along(Group& group, const Eigen::Vector3d& force, double dt) noexcept;

    // scene_effects.cpp
    void start_effect_fade(std::uint32_t slot, Slot::From from, double time) noexcept;
    void list_effects() noexcept;
    bool may_collapse(std::uint32_t slot) const noexcept;
    void advance_effect_fades(double dt, Wrench& sum) noexcept;
    void evaluate_effects(double dt, Wrench& sum) noexcept;
    void evaluate_effects_at(double dt, Wrench& sum) noexcept;  // where the probes are, as fast as they say
    Wrench at_hand(const Wrench& at_probe, const Group& group) const noexcept;
    // An effect's own time: it stands still where the silence holds it, or has taken it away. What it was told to
    // arrive at it arrives at all the same.
    double own_step(const Record& r, bool arrived, double dt) const noexcept {
        const bool holds = silence_ > 0 && r.use.on_silence == OnSilence::hold;
        return (holds || r.weight == 0) && arrived ? 0 : dt;
    }

    // scene_asked.cpp: which effects are asked
    bool to_be_asked(std::uint32_t slot) const noexcept;
    void place_effect(std::uint32_t slot) noexcept;  // in its Reach, if it has an end
    void forget_effect(std::uint32_t slot) noexcept;
    void collect_effects(Group& group, std::uint32_t probe) noexcept;
    bool near_effects_left() noexcept;  // a probe has moved out of what is asked for it
    double still_effects() const noexcept;

    // scene_load.cpp
    Demand bound_of(const ContactSet& set) const noexcept;
    Demand bound_of(const Group& group) const noexcept;
    Demand bound_of(const Record& effect) const noexcept;
    void add_load(const ContactSet& set, double share, HandLoad& load) const noexcept;
    HandLoad load_of(const Group& group) const noexcept;
    void bound_effects() noexcept;

    // scene_feedback.cpp
    bool retold_by_flags(std::span<Feedback> kept, std::span<std::uint64_t> written) noexcept;
    Feedback feedback_of(std::uint32_t slot, bool surface) const noexcept;
    template <class Put>
    void tell_surfaces(std::uint32_t room, Put put) noexcept;
    template <class Put>
    void tell_touched(Put put) noexcept;
    template <class Put>
    void tell_effects(std::uint32_t room, bool all, Put put) noexcept;

    // scene_still.cpp
    bool changed() const noexcept;
    double still_within() const noexcept;
    void pass(std::uint64_t cycles, const SceneTime& time, const Probe& hand) noexcept;

    // scene.cpp
    void place_probes(const Probe& hand) noexcept;
    void advance_weights(double dt) noexcept;
    void advance_pace(double dt) noexcept;
    // How much of its velocity counts: what holds in a silence stands still, by and by.
    double pace_of(const Record& r) const noexcept { return r.use.on_silence == OnSilence::hold ? pace_ : 1; }
    Eigen::Vector3d velocity_of(const Record& r) const noexcept { return pace_of(r) * r.velocity; }

    static constexpr std::uint32_t gone = 0xffffffff;
    using Place = std::uint32_t Slot::*;
    void join(std::vector<std::uint32_t>& list, std::uint32_t& size, std::uint32_t slot,
              Place place = &Slot::place) noexcept;
    void leave(std::vector<std::uint32_t>& list, std::uint32_t& size, std::uint32_t slot,
               Place place = &Slot::place) noexcept;

    Scene::Capacity capacity_;
    Assets assets_{};
    Limits limits_;
    Shares shares_;
    FadePolicy policy_;
    double silence_ = 0;         // s
    bool weights_move_ = false;  // not all are where the silence, or its end, takes them
    double pace_ = 1;            // of what holds: 1 it moves, 0 the silence has brought it to rest
    bool settle_ = false;
    HandScales scales_;
    std::uint64_t cycle_ = 0;
    std::uint64_t last_timed_ = 0;  // the last cycle in which time passed
    SceneTime now_, before_;        // at the end of this cycle, of the one before
    double step_ = 0;               // s, of this cycle
    std::uint32_t evaluated_ = 0;
    std::uint32_t size_ = 0;
    std::array<std::uint32_t, Representations::size> counts_{};

    std::vector<Slot> slots_;
    std::vector<std::byte> raw_;                                // max_parameter_bytes each
    alignas(16) std::array<std::byte, max_params> prepared_{};  // of the slot that is being taken
    std::vector<Record> records_;                               // by Owner: two a slot
    std::vector<Rough> rough_;                                  // by Owner
    std::vector<std::uint32_t> changed_;
    std::uint32_t changed_size_ = 0;
    bool moved_ = false;  // a probe's placement changed

    std::vector<Group> groups_;
    std::uint32_t probes_used_ = 1;        // bit mask
    std::uint32_t contacts_used_ = 0;      // probes with a set, or fading
    std::vector<std::uint32_t> surfaces_;  // slots with a surface that is felt
    std::uint32_t surfaces_size_ = 0;
    std::vector<std::uint32_t> always_;  // those of them that are in the sets wherever the probe is
    std::uint32_t always_size_ = 0;
    Reach reach_;                         // the others, as long as they have an end
    std::vector<std::uint32_t> endless_;  // ... and those that have none, but stand still
    std::uint32_t endless_size_ = 0;
    std::uint32_t bounded_used_ = 0;                            // bit mask: probes with some of those
    std::array<Contact, max_contacts> found_;                   // scratch of ask
    std::array<NearSurface, max_near_surfaces> near_surfaces_;  // scratch of solve_curved
    std::uint32_t curved_rounds_ = 0;                           // in this cycle
    std::vector<std::uint32_t> near_;                           // scratch of collect_near
    std::vector<std::uint32_t> fading_olds_;                    // slots whose old record is in a fading set
    std::uint32_t fading_olds_size_ = 0;
    bool sets_edited_ = false;
    std::vector<std::uint32_t> reshaped_;  // in this cycle: slots whose surface stands elsewhere now
    std::uint32_t reshaped_size_ = 0;
    Told told_;
    std::vector<double> planes_;  // of both arenas
    Balls balls_;                 // likewise
    Arena arenas_[2];
    std::uint32_t arena_ = 0;
    std::vector<Owner> scratch_;
    std::vector<std::uint8_t> level_;

    Demand effects_bound_;  // of all of them, at the hand, in shares
    bool effects_bound_stale_ = false;
    std::vector<std::uint32_t> effects_;  // slots with an effect that is felt
    std::uint32_t effects_size_ = 0;
    std::uint32_t collapsed_used_ = 0;   // bit mask: probes with collapsed springs
    std::vector<std::uint32_t> fading_;  // slots whose effect fades
    std::uint32_t fading_size_ = 0;
    bool effects_edited_ = false;
    Reach effect_reach_;                      // those with an end
    std::uint32_t bounded_effects_used_ = 0;  // bit mask: probes with some of those
    std::vector<std::uint32_t> by_kind_;
    std::array<std::uint32_t, Representations::size + 1> kind_begin_{};
    std::array<Kind, Representations::size> active_kinds_{};
    std::uint32_t active_kinds_size_ = 0;
};

}  // namespace knurl::detail

namespace knurl {
struct Scene::Impl : detail::SceneCore {
    using detail::SceneCore::SceneCore;
};
}  // namespace knurl
