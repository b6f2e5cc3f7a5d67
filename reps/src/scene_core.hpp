#pragma once
// What Scene is made of. One slot per handle; each slot has the parameters as sent (`raw`), the record that
// is felt
// (`now`) and the record that is being faded out (`old`). Calls from outside write raw parameters only; the
// next evaluate takes all of them together:
//
//   add, update, remove -> raw, `changed` list          (checked, nothing felt yet)
//   evaluate -> take_changes: now -> old, raw -> now    (one change of the set, one cross-fade)
//            -> weights (silence) -> contacts of each probe -> effects -> sum
//
// Surfaces lie sorted by stiffness as structure of arrays, per probe and set, in one of two arenas; a change
// builds the other one. Everything is allocated by the constructor.

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <knurl/reps/contact_solver.hpp>
#include <knurl/reps/scene.hpp>

namespace knurl::detail {

template <class... R>
constexpr std::size_t largest_params(TypeList<R...>) {
    return std::max({sizeof(R)...});
}
template <class... R>
constexpr std::size_t largest_state(TypeList<R...>) {
    return std::max({sizeof(typename R::State)...});
}
inline constexpr std::size_t max_params = largest_params(Representations{});
inline constexpr std::size_t max_state = largest_state(Representations{});

/// Stiffnesses that one probe's set keeps apart, each with its own solution; more are rounded down to these.
inline constexpr std::uint32_t max_layers = 8;

struct Record {
    alignas(16) std::byte params[max_params] = {};
    alignas(16) std::byte state[max_state] = {};
    Kind kind = 0;
    Use use;
    double weight = 1;     // by silence: 1 in full, 0 faded away
    double stiffness = 0;  // N/m
    HalfSpace plane;       // of a surface that stands still
    bool stands = false;
    bool recovers = false;  // brings its own changes in; not cross-faded
    Contact contact;        // of a surface that does not stand still, in cycle `met`
    std::uint64_t met = 0;
};

/// Names a record: slot and which of its two. A bridge is the plane that stands for an interrupted fade.
using Owner = std::uint32_t;
inline constexpr Owner bridge_owner = 0xffffffff;
constexpr Owner owner_of(std::uint32_t slot, bool old) {
    return slot * 2 + (old ? 1 : 0);
}

struct Slot {
    // As the application left it.
    bool present = false;
    bool changed = false;
    std::uint32_t generation = 0;
    Kind kind = 0;
    Use use;
    // As it is felt.
    bool felt = false;
    bool renewed = false;  // while changes are taken: this slot's is one of them
    std::uint32_t felt_generation = 0;
    std::int32_t old_surface_of = -1;  // the probe whose fading set holds `old`
    std::uint32_t place = 0;           // in the list of surfaces or effects
    std::uint32_t member = 0;          // of a surface: its index in the arena
    // Of an effect: its own fade, from the old record, a frozen wrench, or nothing.
    enum class From : std::uint8_t { none, nothing, record, frozen };
    From from = From::none;
    bool carries = false;          // the old record is the same effect's: it moves along
    double elapsed = 0, time = 0;  // s
    double gain = 1;               // of the new one
    Wrench frozen;                 // about the hand
    Wrench remnant;                // this cycle's share of the old
    Wrench last;                   // contribution to the hand in the last cycle
};

struct Layer {
    double stiffness = 0;     // N/m
    std::uint32_t count = 0;  // the first so many members are as stiff or stiffer
    double give = 0;          // m, by which contradictory planes give way
    ContactSolution solution;
    Eigen::Vector3d proxy =
        Eigen::Vector3d::Zero();  // m, world: last cycle's x, kept when no solution is found
};

struct ContactSet {
    std::uint32_t begin = 0, count = 0;                // members in the arena
    std::uint32_t moving_begin = 0, moving_count = 0;  // those that are asked each cycle
    std::uint32_t layers = 0;
    double scale = 1;                     // the weight, where all members share one
    std::array<Layer, max_layers> layer;  // softest (all members) first
    // Last cycle's result.
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, damped, weighted, clamped
    double elastic = 0;                               // N, before that
    bool touching = false;
    bool infeasible = false;
};

struct Arena {
    std::vector<double> nx, ny, nz, c, s, b;
    std::vector<Owner> owner;
    std::vector<std::uint32_t> moving;
    std::uint32_t used = 0, moving_used = 0;
};

/// What one probe touches.
struct Group {
    ProbePlacement placement, next_placement;
    bool moved = false;  // next_placement is to be taken
    Probe probe;
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();  // m, from the hand's position, world
    ContactSet now, old;
    bool fading = false;
    bool fresh = false;            // the fade has not been evaluated yet
    double elapsed = 0, time = 0;  // s
    HalfSpace bridge;
    double bridge_stiffness = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     // last cycle's blend
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // where the probe was then
    // While changes are taken: its set changes; the change is cross-faded; what was felt becomes a bridge
    // (alone: over the time that the fade had).
    bool edited = false, fades = false, interrupted = false;
    bool replaced = false;  // the probe sits elsewhere on the hand now
    double fade_time = 0;
};

class SceneCore;

/// What the scene knows of a kind: functions over raw bytes, made from the typed ones.
struct KindOps {
    bool surface = false;
    std::size_t params_size = 0;
    // All but state and use; what the kind does not have is left alone.
    void (*prepare)(const std::byte* raw, const Limits&, Record& out) noexcept = nullptr;
    // Prepared, they would be the bytes that are felt.
    bool (*unchanged)(const std::byte* raw, const Limits&, Record& now) noexcept = nullptr;
    void (*adopt)(Record& now, const Record* previous, const Probe&) noexcept = nullptr;
    void (*settle)(Record&) noexcept = nullptr;
    double (*fade_time)(const std::byte* params) noexcept = nullptr;     // s, or automatic
    double (*asked_stiffness)(const std::byte* raw) noexcept = nullptr;  // N/m
    bool (*carry)(Record& old, const Record& next) noexcept = nullptr;   // true: the rest is equal too
    Contact (*contact)(Record&, const Probe&, double dt) noexcept = nullptr;
    Wrench (*evaluate)(Record&, const Probe&, double dt) noexcept = nullptr;
    void (*evaluate_all)(SceneCore&, std::span<const std::uint32_t> slots, double dt,
                         Wrench& sum) noexcept = nullptr;
};
std::span<const KindOps> kind_ops() noexcept;

Limits sane_limits(Limits limits) noexcept;

class SceneCore {
  public:
    SceneCore(Scene::Capacity capacity, const Limits& limits);

    // scene_slots.cpp
    Verdict check_use(const Use& use) const noexcept;
    static Verdict check_params(Kind kind, const void* params, std::size_t bytes) noexcept;
    Verdict check_add(Handle, Kind, const void* params, std::size_t bytes, const Use&) const noexcept;
    Verdict check_update(Handle, Kind, const void* params, std::size_t bytes) const noexcept;
    void write(std::uint32_t slot, const void* params, std::size_t bytes) noexcept;
    void mark(std::uint32_t slot) noexcept;
    void clear() noexcept;

    // scene_changes.cpp
    void take_changes() noexcept;
    void take_slot(std::uint32_t slot) noexcept;
    void renew(std::uint32_t slot, const Record* previous) noexcept;
    void change_surface(std::uint32_t slot, bool was, bool is, bool same) noexcept;
    void change_effect(std::uint32_t slot, bool was, bool is, bool same) noexcept;
    void release_old(std::uint32_t slot) noexcept;
    void take_placements() noexcept;
    double fade_time(const Record& record) const noexcept;

    // scene_sets.cpp
    void rebuild_sets() noexcept;
    std::uint32_t list_old(Group& group, std::uint32_t probe) noexcept;
    std::uint32_t list_now(std::uint32_t probe) noexcept;
    void make_bridge(Group& group) noexcept;
    void build(ContactSet& set, const Group& group, Arena& into, std::span<const Owner> owners) noexcept;
    void end_fade(Group& group) noexcept;
    Record& record(Owner owner) noexcept { return (owner & 1 ? old_ : now_)[owner >> 1]; }
    const Record& record(Owner owner) const noexcept { return (owner & 1 ? old_ : now_)[owner >> 1]; }

    // scene_contact.cpp
    void evaluate_contacts(double dt, Wrench& sum) noexcept;
    void evaluate_set(ContactSet& set, const Group& group, double dt) noexcept;

    // scene_effects.cpp
    void start_effect_fade(std::uint32_t slot, Slot::From from, double time) noexcept;
    void list_effects() noexcept;
    void advance_effect_fades(double dt, Wrench& sum) noexcept;
    void evaluate_effects(double dt, Wrench& sum) noexcept;
    Wrench at_hand(const Wrench& at_probe, const Group& group) const noexcept;

    // scene.cpp
    void place_probes(const Probe& hand) noexcept;
    void advance_weights(double dt) noexcept;

    static constexpr std::uint32_t gone = 0xffffffff;
    void join(std::vector<std::uint32_t>& list, std::uint32_t& size, std::uint32_t slot) noexcept;
    void leave(std::vector<std::uint32_t>& list, std::uint32_t& size, std::uint32_t slot) noexcept;

    Scene::Capacity capacity_;
    Limits limits_;
    FadePolicy policy_;
    double silence_ = 0;         // s
    bool weights_move_ = false;  // silent, or not yet back at full weight
    bool settle_ = false;
    std::uint64_t cycle_ = 0;
    std::uint32_t evaluated_ = 0;
    std::uint32_t size_ = 0;
    std::array<std::uint32_t, Representations::size> counts_{};

    std::vector<Slot> slots_;
    std::vector<std::byte> raw_;  // max_params each
    std::vector<Record> now_, old_;
    std::vector<std::uint32_t> changed_;
    std::uint32_t changed_size_ = 0;
    bool moved_ = false;  // a probe's placement changed

    std::vector<Group> groups_;
    std::uint32_t probes_used_ = 1;        // bit mask
    std::uint32_t contacts_used_ = 0;      // probes with a set, or fading
    std::vector<std::uint32_t> surfaces_;  // slots
    std::uint32_t surfaces_size_ = 0;
    bool sets_edited_ = false;
    Arena arenas_[2];
    std::uint32_t arena_ = 0;
    std::vector<Owner> scratch_;
    std::vector<std::uint8_t> level_;

    std::vector<std::uint32_t> effects_;  // slots with an effect that is felt
    std::uint32_t effects_size_ = 0;
    std::vector<std::uint32_t> fading_;  // slots whose effect fades
    std::uint32_t fading_size_ = 0;
    bool effects_edited_ = false;
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
