#pragma once
// The surfaces of each probe that are solved together and, during a cross-fade, those that were solved
// before:
//
//   records, sorted by stiffness ──> set `now` ─┐
//   their old records, or one frozen plane ──> set `old` ─┴─> contact stage
//
// Sets lie as structure of arrays in one of two arenas; a change builds the other one. Planes that stand
// still and are moved, a thousand in one batch, keep their set: scene_reshape.cpp.

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <knurl/reps/contact_solver.hpp>

#include "broad_phase/bounding_spheres.hpp"
#include "broad_phase/broad_phase.hpp"
#include "scene/scene_state.hpp"

namespace knurl::detail {

/// Distinct stiffnesses in one probe's set, each with its own solution; further ones are rounded down to
/// these.
inline constexpr std::uint32_t max_layers = 8;

/// The solution of a layer with curved surfaces in a cycle: the next cycle starts from it.
struct CurvedStart {
    // m: x - p, and that p (kept apart, so that a hand at rest starts from the same to the bit)
    Eigen::Vector3d dx = Eigen::Vector3d::Zero(), p = Eigen::Vector3d::Zero();
    ActiveSet active;
    std::array<double, 3> multiplier{};
    std::uint64_t cycle = 0;
};

/// The starts of all layers of a set. A new set starts where the old one held the probe, whatever changes.
struct CurvedStarts {
    // What held it: a surface, the index of its contact, and how much it pushed.
    struct Push {
        Owner owner;
        std::uint32_t part;
        double multiplier;  // m
    };
    struct Place {
        Vec3 dx, p;  // m
        std::uint64_t cycle = 0;
        std::array<Push, 3> by{};
        std::uint32_t pushes = 0;
    };
    struct OfLayer {
        double stiffness = 0;  // N/m
        Place newest, before;
        bool started = false;  // the newest one started from the one before
    };
    std::array<OfLayer, max_layers> layer{};  // softest first
    std::uint32_t count = 0;
};

struct Layer {
    double stiffness = 0;     // N/m
    std::uint32_t count = 0;  // so many first members are as stiff or stiffer
    double give = 0;          // m, by which contradictory planes give way
    double given_at = 0;      // m, the worst violation when `give` was found
    ContactSolution solution;
    // m, world: the last cycle's x, kept when no solution is found
    Eigen::Vector3d proxy = Eigen::Vector3d::Zero();
    // For a set with curved surfaces.
    std::array<CurvedStart, 2> reached;  // in the last two cycles that took time
    std::uint8_t newest = 0;             // index of the newest in `reached`
    bool started = false;                // the newest one started from the other
    bool joined = false;                 // solved with the surfaces themselves, not with planes at the
                                         // probe's feet
    double far = 0;                      // m, from the probe: surfaces beyond it were not evaluated
};

/// Where many standing planes were last evaluated, and the distance of the nearest (m); at most 0: evaluate
/// them.
struct ClearOfPlanes {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    double distance = 0;
    bool alone = false;  // the set has only them, and none was touched in the last cycle
};

/// Where the proxies of a probe's layers were at the end of the last cycle that took time. Single precision: they
/// say which layers lay behind a face, and by how much to 1e-10 m.
struct LayerProxies {
    std::array<float, max_layers> stiffness{};             // N/m, softest first
    std::array<Eigen::Vector3f, max_layers> from_probe{};  // m
    std::uint32_t count = 0;

    /// m, from the probe then: of the surfaces that are as stiff or stiffer. Zero where there were none.
    /// (Stiffnesses change a little from cycle to cycle while surfaces are silent.)
    Eigen::Vector3d of(double k) const noexcept {
        std::uint32_t at = 0;
        while (at < count && stiffness[at] < 0.99 * k) ++at;
        if (at == count) return Eigen::Vector3d::Zero();
        return from_probe[at].cast<double>();
    }
};

struct ContactSet {
    std::uint32_t begin = 0, count = 0;                // members in the arena, solved together
    std::uint32_t room = 0, moving_room = 0;           // room for so many members, of each sort
    std::uint32_t standing = 0;                        // of `count`: planes that stand still
    std::uint32_t summed = 0;                          // members behind those, whose forces are summed
    std::uint32_t moving_begin = 0, moving_count = 0;  // surfaces that are evaluated each cycle
    std::uint32_t inside = 0;                          // of those: were evaluated last time
    std::uint32_t layers = 0;
    bool has_tangential = false;          // a member has a tangential part
    bool curved = false;                  // has several members, of which one may be curved
    bool follows = false;                 // a member is entered and left: see ProxyPath
    bool gaps = false;                    // a member may have a gap: see scene_gaps.cpp
    std::array<Vec3, 3> corner{};         // of the softest layer, if joined: the active normals
    bool left_out = false;                // in the last evaluation, members were out of reach
    double slack = 0;                     // m, added to their bounds: the proxy may get so far
    double scale = 1;                     // the common weight of all members, if there is one
    std::array<Layer, max_layers> layer;  // softest (all members) first
    // Of the last cycle that took time: the proxy relative to the probe (m), and the slot that held it alone.
    Eigen::Vector3d held = Eigen::Vector3d::Zero();
    std::uint32_t held_by = 0xffffffff;
    bool led = false;  // in the last cycle that took time the proxy followed a path: see ProxyPath
    Eigen::Vector3d reached = Eigen::Vector3d::Zero();  // m: the end of the proxy's path in this cycle
    // Last cycle's result.
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, damped, weighted, clamped
    double elastic = 0;                               // N, of the joint solution alone
    double per_elastic = 0;                           // 1, ratio of `force` to `elastic`: damping, weight,
                                                      // clamp
    bool touching = false;
    bool infeasible = false;
    ClearOfPlanes clear;
};

/// A surface that is evaluated in each cycle, unless the probe is out of its ball.
struct Moving {
    std::uint32_t member = 0;  // its first member
    bool inside = false;       // it was evaluated last time
};

/// Sets are built alternately in one of two arenas. They are built from records; of the other arena only the
/// owners are read. So all other arrays share one memory.
struct Arena {
    std::span<double> nx, ny, nz, c, s, b;
    std::vector<Owner> owner;
    std::vector<Moving> moving;
    BoundingSpheres* bounding_spheres = nullptr;  // of the moving surfaces; radius infinity: always evaluated
    std::uint32_t used = 0, moving_used = 0;
};

/// State of the tangential stage: friction, texture, braking pulse.
struct TangentialState {
    bool present = false;  // the set may have a tangential part
    FrictionLaw law;       // last cycle's, mixed from all pushing surfaces
    Tangent tangent;       // last cycle's
    FrictionState friction;
    Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();  // N, friction in the last cycle
    Eigen::Vector3d relief = Eigen::Vector3d::Zero();          // N, texture's push in the last cycle
    double pulse = 0, pulse_left = 0;                          // N, s: braking
    double apart = 1;                                          // s, since the last touch

    bool needed() const noexcept { return present || friction.residual_time > 0; }
    /// No force, no memory of one, and time has no further effect.
    bool rests() const noexcept;
    /// No surface is touched any more.
    void release() noexcept;
    /// Without friction the tip is not followed: friction that begins later starts at the tip's place then.
    void leave_anchor() noexcept {
        if (!needed()) friction.held = false;
    }
};

/// The plane that gives the force of an interrupted cross-fade, from which the next one starts. It has its
/// surfaces' friction.
struct FrozenPlane {
    HalfSpace plane;
    double stiffness = 0;  // N/m; 0: there was no force
    FrictionLaw law;
};

struct CrossFade {
    bool under_way = false;
    bool frozen = false;           // the fading set is only the frozen plane
    bool olds_left_out = false;    // old records out of reach are left out of it
    bool fresh = false;            // not evaluated yet
    std::uint32_t number = 0;      // of the probe's fades
    double elapsed = 0, time = 0;  // s

    std::uint32_t next_number() const noexcept { return number + 1 != 0 ? number + 1 : 1; }
    double share_of_new() const noexcept { return under_way ? elapsed / time : 1; }
};

/// What changes in a probe's set while changes are taken.
struct SetChange {
    bool edited = false;  // its set changes
    bool fades = false;   // the change is cross-faded, over `time`
    double time = 0;      // s
    // The present force becomes a frozen plane (if only that: over the remaining time of the fade).
    bool interrupted = false;
    bool replaced = false;  // the probe moved to another place on the hand

    void fade_over(double seconds) noexcept {
        edited = fades = true;
        time = std::max(time, seconds);
    }
};

/// The contacts of one probe.
struct ContactState {
    ContactSet now, old;
    CrossFade fade;
    FrozenPlane frozen_plane;
    TangentialState tangential;
    SetChange change;
    LayerProxies last;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     // last cycle's blend, without tangential forces
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of the probe in the last cycle

    bool empty() const noexcept { return now.count + now.summed == 0; }
    /// There are only planes, none was touched in the last cycle, and no transient is left.
    bool is_clear() const noexcept {
        return now.clear.alone && !fade.under_way && (!tangential.needed() || tangential.rests());
    }
    /// m, how far its proxies may lie from the probe.
    double deepest() const noexcept { return std::max(now.slack, old.slack); }
    /// Fading surfaces were out of reach; a new set finds out whether they still are.
    bool old_may_be_near() const noexcept { return fade.under_way && fade.olds_left_out; }
    void release() noexcept;  // no surface is touched any more
};

class ContactSets {
  public:
    ContactSets(SceneState& state, SurfaceCandidates& candidates);
    void reset() noexcept;

    // While changes are taken.
    void add(std::uint32_t slot) noexcept;     // a surface that acts from now on
    void remove(std::uint32_t slot) noexcept;  // a surface that no longer acts
    /// The current record fades out.
    void keep_old(std::uint32_t slot) noexcept;
    /// The old record is about to be overwritten: if it still fades, the fade continues from the present
    /// force.
    void release_old(std::uint32_t slot) noexcept;
    SetChange& change_of(std::uint32_t probe) noexcept { return states_[probe].change; }
    /// The probe moves to another place on the hand: its present force becomes an interrupted fade.
    void replace_probe(std::uint32_t probe) noexcept;
    /// The slot's surface has moved and nothing else has changed: see scene_reshape.cpp.
    void reshape(std::uint32_t slot, double fade_time) noexcept;
    void edit() noexcept { edited_ = true; }
    bool edited() const noexcept { return edited_; }
    /// Applies all changes since the last update. `renewed`: contains the renewed surfaces, among others.
    void update(std::span<const std::uint32_t> renewed) noexcept;
    /// The same surfaces, with other weights or other candidates.
    void rebuild(std::span<const std::uint32_t> renewed = {}) noexcept;

    // For the stages that follow.
    static constexpr std::uint32_t in_no_set = 0xffffffff;
    ContactState& operator[](std::uint32_t probe) noexcept { return states_[probe]; }
    const ContactState& operator[](std::uint32_t probe) const noexcept { return states_[probe]; }
    Arena& arena() noexcept { return arenas_[arena_]; }
    const Arena& arena() const noexcept { return arenas_[arena_]; }
    std::uint32_t probes() const noexcept { return used_; }  // bit mask: those with a set or a fade
    std::span<const std::uint32_t> surfaces() const noexcept { return surfaces_; }
    std::uint32_t member(std::uint32_t slot) const noexcept { return slots_[slot].member; }
    void end_fade(std::uint32_t probe) noexcept;
    /// Calls visit(record) for each old record in a fading set.
    template <class Visit>
    void for_each_old(Visit visit) noexcept {
        for_each_bit(used_, [&](std::uint32_t p) {
            const ContactSet& old = states_[p].old;
            for (std::uint32_t i = old.begin; i < old.begin + old.count; ++i) {
                const Owner owner = arena().owner[i];
                if (owner != frozen_plane_owner && state_.records.fades_out(owner))
                    visit(state_.records[owner]);
            }
        });
    }
    /// The old record is in a fading set, or will be.
    bool old_in_use(std::uint32_t slot) const noexcept;

  private:
    struct SetSlot {
        std::uint32_t place = 0;           // index in surfaces_
        std::uint32_t member = 0;          // its first index in the arena, or in_no_set
        std::int32_t old_surface_of = -1;  // the probe whose fading set has the old record
        std::uint32_t new_in_fade = 0;     // the fade of its probe that adds it: it is not in the fading set
        std::uint32_t old_in_fade = 0;     // the fade whose fading set has the old record; 0: not begun
        bool old_listed = false;           // it is in olds_
    };

    bool reshape_sets(std::span<const std::uint32_t> renewed) noexcept;
    bool make_room_for_old(ContactState& contact) noexcept;
    void copy_to_old(ContactState& contact) noexcept;
    void replace_old(std::uint32_t probe) noexcept;

    void begin_fade(std::uint32_t probe, std::span<const std::uint32_t> renewed) noexcept;
    void freeze_fade(std::uint32_t probe) noexcept;
    void forget_ended_olds() noexcept;
    bool old_fades(const SetSlot& slot) const noexcept;
    bool stands_in_for_old(std::uint32_t slot, std::uint32_t probe) const noexcept;
    std::span<const Owner> list_old(std::uint32_t probe) noexcept;
    std::span<const Owner> list_now(std::uint32_t probe) noexcept;

    // build, in its order
    struct Levels;
    void build(ContactSet& set, std::uint32_t probe, Arena& into, std::span<const Owner> owners) noexcept;
    void share_weight(ContactSet& set, std::span<const Owner> owners) const noexcept;
    void sort_into_layers(ContactSet& set, std::uint32_t probe, std::span<const Owner> owners) noexcept;
    void put_plane(const ContactSet& set, std::uint32_t probe, Arena& into, Owner owner,
                   std::uint32_t at) const noexcept;
    void put_moving(std::uint32_t probe, Arena& into, Owner owner, std::uint32_t at) const noexcept;
    struct Starts {
        CurvedStarts now, old;
    };
    Starts starts_of_probe(std::uint32_t probe) const noexcept;
    void take_starts_of_probe(std::uint32_t probe, Arena& arena, const Starts& starts) noexcept;
    void built(std::uint32_t probe) noexcept;

    double stiffness_of(Owner owner, std::uint32_t probe) const noexcept;
    double weight_of(Owner owner) const noexcept;
    double gap_above(Owner owner) const noexcept;
    std::uint32_t parts_of(Owner owner) const noexcept;
    bool stands(Owner owner) const noexcept;

    SceneState& state_;
    SurfaceCandidates& candidates_;
    std::vector<ContactState> states_;  // by probe
    std::vector<SetSlot> slots_;
    SlotList surfaces_;       // active surfaces
    SlotList olds_;           // slots whose old record is in a fading set
    SlotList reshaped_;       // slots reshaped in this cycle
    std::uint32_t used_ = 0;  // bit mask: probes with a set or a fade
    bool edited_ = false;
    std::vector<double> planes_;        // of both arenas
    BoundingSpheres bounding_spheres_;  // likewise
    Arena arenas_[2];
    std::uint32_t arena_ = 0;
    std::vector<Owner> scratch_;
    std::vector<std::uint8_t> level_;                     // of each owner, while a set is built
    std::array<std::uint32_t, max_layers> next_place_{};  // likewise, of each layer
};

/// Factor of a member's stiffness and damping by its weight. Where all members share one weight, the set's
/// scale has it.
inline double own_weight(const ContactSet& set, double weight) noexcept {
    return set.scale == 1 ? weight : 1;
}
/// m, the worst violation of these members.
inline double worst_of(const Arena& arena, std::uint32_t begin, std::uint32_t count) noexcept {
    double worst = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = begin; i < begin + count; ++i) worst = std::max(worst, arena.s[i]);
    return worst;
}
/// Where the probe would touch a surface at this distance (m).
inline Eigen::Vector3d foot_of(const Probe& probe, double height, const Eigen::Vector3d& normal) noexcept {
    return probe.position - (height + probe.radius) * normal;
}
/// Resets the set to one that was never solved.
void forget_solution(ContactSet& set, const Eigen::Vector3d& probe) noexcept;

/// Where a set's curved surfaces held the probe: the start of the following set.
CurvedStarts starts_of(const ContactSet& set, const ContactState& contact, const Arena& arena,
                       const Clock& clock) noexcept;
void take_starts(ContactSet& set, const Arena& arena, const CurvedStarts& starts) noexcept;

}  // namespace knurl::detail
