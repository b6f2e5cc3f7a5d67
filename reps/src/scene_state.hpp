#pragma once
// What the scene keeps: of each slot, of each set of surfaces that are solved together, of each probe.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <knurl/reps/collapsed_springs.hpp>
#include <knurl/reps/contact_solver.hpp>
#include <knurl/reps/friction.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/reps/texture.hpp>

#include "balls.hpp"

namespace knurl::detail {

// Of any list of kinds: so a kind that nobody uses does not even move the others in memory.
static_assert(max_parameter_bytes % 16 == 0, "parameters as they were sent lie one behind the other");
inline constexpr std::size_t max_params = (max_parameter_bytes + 63) / 64 * 64;

/// Stiffnesses that one probe's set keeps apart, each with its own solution; more are rounded down to these.
inline constexpr std::uint32_t max_layers = 8;

/// Tangent planes that one surface may have at once.
inline constexpr std::uint32_t max_contacts = 3;

/// All that a set is built from, and all that changes when a plane that stands is put elsewhere: one line of
/// memory, since a batch of updates costs what it touches.
struct RecordLine {
    HalfSpace plane;       // of a surface that stands still
    double weight = 1;     // by silence: 1 in full, 0 faded away
    double stiffness = 0;  // N/m
    Kind kind = 0;
    std::uint8_t probe = 0;     // that of `use`
    bool stands : 1 = false;    // one plane until it changes
    bool recovers : 1 = false;  // brings its own changes in; not cross-faded
    bool summed : 1 = false;    // its force is added, not solved with the others
    bool rough : 1 = false;     // there is something to feel along it: see Rough
    bool textured : 1 = false;
    bool clamped : 1 = false;   // less stiff than asked for
    bool reported : 1 = false;  // feedback is asked for
};
static_assert(sizeof(RecordLine) == 64);

struct RecordHead : RecordLine {
    Use use;
    // The cycle in which it was asked, or as if it had been: again in the same one, it is with dt = 0.
    std::uint64_t asked = 0;
    double moved = 0;  // s, of its scene's time: as far has it moved on, if it turns
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, of the surface
};

/// What a surface feels like along it, beside its record: touched only where there is something.
struct Rough {
    FrictionLaw law;
    Texture texture;
    double braking = 0;
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // m, by which its velocity has carried the texture
    double share = 1;                                 // of the friction, where it is touched
    std::array<double, max_contacts> height{};        // m, of each contact, without the relief
};

struct alignas(64) Record : RecordHead {
    alignas(64) std::byte params[max_params] = {};
    alignas(64) std::byte state[max_state_bytes] = {};
};

/// Names a record: each slot has two, which change roles whenever its surface changes. A bridge is the plane
/// that stands for an interrupted fade.
using Owner = std::uint32_t;
inline constexpr Owner bridge_owner = 0xffffffff;

/// Of parameters that were checked, against those that stand in the slot.
enum class Differ : std::uint8_t { nowhere, in_shape, anywhere };

struct alignas(64) Slot {
    enum class From : std::uint8_t { none, nothing, record, frozen };

    // As the application left it.
    bool present = false;
    bool changed = false;
    Differ differ = Differ::anywhere;  // what was checked last
    bool shape_alone = false;          // since it was felt nothing but its shape has changed
    std::uint32_t generation = 0;
    Kind kind = 0;
    // As it is felt.
    bool felt = false;
    std::uint8_t current = 0;  // which of its two records is the one that is felt
    bool twins = false;        // they differ in nothing but shape, of a surface that stands: see reshape
    bool renewed = false;      // while changes are taken: this slot's is one of them
    bool bounded = false;      // in Reach; a surface is in a set, an effect asked, only while near
    bool near = false;         // ... which it is
    bool endless = false;      // bounded, not by a ball: asked how far away it is
    bool old_listed = false;   // in fading_olds_
    From from = From::none;    // of an effect: its fade is from the old record, a frozen wrench, or nothing
    std::uint32_t felt_generation = 0;
    std::int32_t old_surface_of = -1;  // the probe whose fading set has `old`
    std::uint32_t place = 0;           // in the list of surfaces or effects
    std::uint32_t member = 0;          // of a surface: its first index in the arena; gone: it is in no set
    std::uint32_t always_place = 0;
    std::uint32_t entry = 0;        // in kept feedback
    std::uint32_t new_in_fade = 0;  // the fade of its probe that brings it in: not in the fading set
    std::uint32_t old_in_fade = 0;  // ... whose fading set has its old record; 0: to come

    Use use;
    // Of an effect: its own fade.
    bool asked = false;            // in each cycle: see to_be_asked
    bool collapsed = false;        // a spring that is part of its probe's CollapsedSprings
    bool carries = false;          // the old record is the same effect's: it moves along
    double elapsed = 0, time = 0;  // s
    double gain = 1;               // of the new one
    Wrench frozen;                 // about the hand
    Wrench remnant;                // this cycle's share of the old
    Wrench last;                   // contribution to the hand in the last cycle
};

/// What a layer with curved surfaces came to in a cycle: from there the next one goes on.
struct CurvedStart {
    // m: x - p, and that p (apart: a hand at rest starts from the same to the bit)
    Eigen::Vector3d dx = Eigen::Vector3d::Zero(), p = Eigen::Vector3d::Zero();
    ActiveSet active;
    std::array<double, 3> multiplier{};
    std::uint64_t cycle = 0;
};

/// Those of all layers of a set: where it held the probe goes on being where it is solved from, whatever changes.
struct CurvedStarts {
    std::array<double, max_layers> stiffness{};  // N/m
    std::array<Vec3, max_layers> dx{}, p{};      // m
    // What held it there: a surface, which of its contacts, and how much it pushed.
    struct Push {
        Owner owner;
        std::uint32_t part;
        double multiplier;  // m
    };
    std::array<std::array<Push, 3>, max_layers> by{};
    std::array<std::uint32_t, max_layers> pushes{};
    std::uint32_t count = 0;
};

struct Layer {
    double stiffness = 0;     // N/m
    std::uint32_t count = 0;  // the first so many members are as stiff or stiffer
    double give = 0;          // m, by which contradictory planes give way
    double given_at = 0;      // m, the worst violation where that was found
    ContactSolution solution;
    // m, world: last cycle's x, kept when no solution is found
    Eigen::Vector3d proxy = Eigen::Vector3d::Zero();
    // Of a set with curved surfaces.
    std::array<CurvedStart, 2> reached;  // in the last two cycles that took time
    std::uint8_t newest = 0;             // of them
    bool started = false;                // the newest one, from the other
    bool joined = false;                 // by the surfaces themselves, not by planes at the probe's feet
    double far = 0;                      // m, what lies farther from the probe has had no say
};

/// Where many planes that stand were last asked, and how far the nearest was away (m); at most 0: ask.
struct ClearOfPlanes {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    double distance = 0;
};

struct ContactSet {
    std::uint32_t begin = 0, count = 0;                // members in the arena, solved together
    std::uint32_t room = 0, moving_room = 0;           // as many members may lie there, of either kind
    std::uint32_t standing = 0;                        // of those: planes that are not asked
    std::uint32_t summed = 0;                          // those behind them, whose forces add up
    std::uint32_t moving_begin = 0, moving_count = 0;  // surfaces that are asked each cycle
    std::uint32_t inside = 0;                          // of those: asked when they were last looked at
    std::uint32_t layers = 0;
    bool rough = false;                   // one of them is
    bool curved = false;                  // one of several may be
    std::array<Vec3, 3> corner{};         // of the softest layer, if joined: the active normals
    bool left_out = false;                // of the last round of asking: some were out of reach
    double slack = 0;                     // m, by which their reach is extended: the proxy may get that far
    double scale = 1;                     // the weight, where all members share one
    std::array<Layer, max_layers> layer;  // softest (all members) first
    // Last cycle's result.
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, damped, weighted, clamped
    double elastic = 0;                               // N, of the joint solution alone, before that
    double per_elastic = 0;                           // 1, what became of it by damping, weight, clamp
    bool touching = false;
    bool infeasible = false;
    ClearOfPlanes clear;
};

/// A surface that is asked each cycle, unless the probe is out of its ball.
struct Moving {
    std::uint32_t member = 0;  // its first
    bool inside = false;       // it was asked when it was last looked at
};

/// Of two, sets are built in one by turns. They are built from records: of what stood in the other one, only whose it
/// was is looked at, so the rest has one memory.
struct Arena {
    std::span<double> nx, ny, nz, c, s, b;
    std::vector<Owner> owner;
    std::vector<Moving> moving;
    Balls* balls = nullptr;  // theirs; reach infinity: always asked
    std::uint32_t used = 0, moving_used = 0;
};

/// The bounded surfaces that a probe might touch before it has moved by `margin` from `at`.
struct Candidates {
    std::vector<std::uint32_t> slots;
    std::uint32_t size = 0;
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m
    double margin = -1;                            // m; negative: to be collected anew
    double wanted = 0;                             // m, the next margin
    double until = 0;                              // s, of the scene's time: then others may have come near
};

/// Which bounded effects a probe may feel before it has moved by `margin` from `at`: those that are `near`.
struct Nearby {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m
    double margin = -1;                            // m; negative: to be collected anew
    double wanted = 0;                             // m, the next margin
};

inline constexpr double near_rounding = 1 - 5e-5;  // of the margin: what rounding of positions may not eat

/// What kept feedback of surfaces was made from. While nothing of this changes, nothing is to be said of
/// those that are not touched.
struct Told {
    bool edited = true;    // what is felt, its order, or what follows from its parameters alone
    bool relisted = true;  // other effects are asked than were
    std::uint32_t silent = 0, fading = 0, infeasible = 0;  // bit masks: probes
    std::uint32_t entries = 0, effects = 0;                // of surfaces; of effects, behind them
    std::vector<std::uint8_t> probe;                       // by entry
    std::vector<std::uint32_t> touched;                    // slots
    std::uint32_t touched_size = 0;
};

/// What one probe touches.
struct Group {
    ProbePlacement placement, next_placement;
    bool moved = false;  // next_placement is to be taken
    Probe probe;
    Eigen::Vector3d before = Eigen::Vector3d::Zero();  // m, where it was in the last cycle that took time
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();     // m, from the hand's position, world
    ContactSet now, old;
    Candidates near;
    std::uint32_t bounded = 0;  // surfaces that may become candidates
    Nearby near_effects;
    std::uint32_t bounded_effects = 0;
    bool fading = false;
    bool bridged = false;          // the fading set is the bridge alone
    bool olds_left_out = false;    // old records out of reach are not in it
    bool fresh = false;            // the fade has not been evaluated yet
    std::uint32_t fade = 0;        // its number
    double elapsed = 0, time = 0;  // s
    HalfSpace bridge;
    double bridge_stiffness = 0;
    FrictionLaw bridge_law;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     // last cycle's blend, without what rubs
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // where the probe was then
    CollapsedSprings springs;
    // What is felt along the surface.
    bool rough = false;
    FrictionLaw law;  // last cycle's, of all that pushed
    Tangent tangent;  // last cycle's
    FrictionState friction;
    Eigen::Vector3d along = Eigen::Vector3d::Zero();   // N, friction in the last cycle
    Eigen::Vector3d relief = Eigen::Vector3d::Zero();  // N, texture's push in the last cycle
    double pulse = 0, pulse_left = 0;                  // N, s: braking
    double apart = 1;                                  // s, since the last touch
    // While changes are taken: its set changes; the change is cross-faded; what was felt becomes a bridge
    // (alone: over the time that the fade had).
    bool edited = false, fades = false, interrupted = false;
    bool replaced = false;  // the probe sits elsewhere on the hand now
    double fade_time = 0;
};

/// Where the probe would touch a surface that is that far from it (m).
inline Eigen::Vector3d foot_of(const Group& group, double height, const Eigen::Vector3d& normal) noexcept {
    return group.probe.position - (height + group.probe.radius) * normal;
}

}  // namespace knurl::detail
