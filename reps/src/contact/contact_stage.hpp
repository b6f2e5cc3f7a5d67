#pragma once
// Narrow phase, joint contact and cross-fade. Evaluates the surfaces of a set, finds the point nearest to the
// probe that satisfies them all, layered by stiffness, and blends the force of the set with that of the
// fading one.

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <span>

#include <knurl/reps/curved_contact.hpp>
#include <knurl/reps/plane.hpp>
#include <knurl/reps/proxy_path.hpp>
#include <knurl/reps/wrench.hpp>

#include "contact/contact_sets.hpp"

namespace knurl::detail {

/// Solves a layer's planes as they are; p is the probe. False: they contradict each other.
[[gnu::always_inline]] inline bool solve_planes(Layer& layer, const ContactPlanes& planes, double worst,
                                                const Eigen::Vector3d& p) noexcept {
    const double given = layer.give;
    solve_contact_relaxed(planes, worst, layer.give, layer.solution);
    if (layer.give != given) layer.given_at = worst;
    if (layer.solution.status == ContactSolution::Status::solved) {
        layer.proxy = p + layer.solution.dx;
        return !(layer.give > 0);
    }
    // The force stays bounded: the proxy stays where it was.
    layer.solution.dx = layer.proxy - p;
    layer.solution.active.count = 0;
    return false;
}

/// The original planes of solids that hold the probe by another plane in harder layers.
struct PlanesApart {
    struct Plane {
        std::uint32_t member;
        double nx, ny, nz, s;
    };
    std::array<Plane, 8> plane;  // further solids hold by one plane in all layers
    std::uint32_t count = 0;

    bool full() const noexcept { return count == plane.size(); }
    bool has(std::uint32_t member) const noexcept {
        return std::any_of(plane.begin(), plane.begin() + count,
                           [member](const Plane& kept) { return kept.member == member; });
    }
    /// Keeps the member's plane, which is about to be replaced.
    void keep(const Arena& a, std::uint32_t i) noexcept {
        plane[count++] = {i, a.nx[i], a.ny[i], a.nz[i], a.s[i]};
    }
    void put_back(Arena& arena) const noexcept;
};

/// The joint contact of curved surfaces: see scene_curved.cpp.
class CurvedStage {
  public:
    CurvedStage(SceneState& state, const ContactSets& sets) : state_(state), sets_(sets) {}

    /// False: the surfaces contradict each other, as far as their planes show.
    bool solve(ContactSet& set, const Probe& probe, Layer& layer, double worst) noexcept;
    /// Finds solids that hold the probe alone, with another plane, in the layers from j > 0 on, and puts that
    /// plane in place of theirs. True: there is one.
    bool put_planes_alone(Arena& arena, const ContactSet& set, const Probe& probe, std::uint32_t j,
                          PlanesApart& apart) const noexcept;
    /// At the end of a cycle the surfaces learn where they hold. Within the cycle, a repeated evaluation
    /// gives the same answer.
    void lean(const ContactSet& set, const Probe& probe) noexcept;

  private:
    /// Room for the surfaces near the probe, on the stack: else each claim would need its own. Constructed
    /// when listed.
    struct Room {
        alignas(NearSurface) std::byte bytes[max_near_surfaces * sizeof(NearSurface)];
        NearSurface* at(std::uint32_t i) noexcept {
            return std::launder(reinterpret_cast<NearSurface*>(bytes + i * sizeof(NearSurface)));
        }
    };
    /// The state of the iteration towards the point where the surfaces meet.
    struct Descent {
        ContactSolution at;
        double within = 0;  // m, from the probe: farther surfaces are ignored
        bool warm = false;  // it started at the last cycle's solution
        bool done = false;
        std::array<Vec3, 3> normals{};  // of the surfaces that hold
    };
    bool solve_layer(ContactSet& set, const Probe& probe, Layer& layer, double worst) noexcept;
    bool jumps(const ContactSet& set, const CurvedStart& start, const Layer& layer,
               const Eigen::Vector3d& p) const noexcept;
    bool meet_elsewhere(const ContactSet& set, const Probe& probe, const Layer& layer) const noexcept;
    std::span<NearSurface> near_surfaces(const ContactSet& set, const Probe& probe, const Layer& layer,
                                         const Descent& descent, Room& room) noexcept;
    void take_step(std::span<NearSurface> near, const CurvedStep& step, const Eigen::Vector3d& p,
                   Descent& descent) const noexcept;
    static void balance(Descent& descent) noexcept;
    void slide(const ContactSet& set, const CurvedStart& start, const Eigen::Vector3d& p,
               ContactSolution& at) const noexcept;
    std::uint32_t list_near_surfaces(const ContactSet& set, const Probe& probe, const Layer& layer,
                                     const Eigen::Vector3d& dx, double within, Room& room) noexcept;
    double relief_at(Owner owner, std::uint32_t member, std::uint32_t part) const noexcept;
    double explained(const ContactSet& set, const ContactSolution& to, double motion) const noexcept;
    void lean_in_layer(const ContactSet& set, const Probe& probe, std::uint32_t j) noexcept;
    bool any_curved(const ContactSet& set, const ActiveSet& active) const noexcept;

    SceneState& state_;
    const ContactSets& sets_;
};

/// The tangential stage, once per probe, on the blended contact: friction, texture, braking pulse. Takes the
/// contact's `force` and returns it with all tangential forces.
Eigen::Vector3d with_tangential(std::uint32_t probe, ContactSets& sets, const SceneState& state,
                                const Eigen::Vector3d& force, double dt) noexcept;
/// A fine relief vanishes at a speed that takes a few cycles to leave. So the gain, not the speed, changes
/// evenly.
double texture_gain_of(const Record& record, const Texture& texture, const Probe& probe,
                       const SceneState& state) noexcept;

/// How the proxy of a set follows its path in this cycle: scene_seams.cpp.
struct Lead {
    const ContactState* contact = nullptr;  // of its probe
    bool on = false;                        // the proxy follows a path
    bool led = false;                       // the holding surface may differ from the evaluated one
    bool lone = false;                      // the set has one surface
    bool fades = false;                     // it is the fading set
    bool solved = false;                    // the proxy is known
    bool again = false;  // the set was already evaluated in this cycle, with other candidates
    ProxyPath::Stage stage = ProxyPath::Stage::answer;  // of the repeated evaluation
    Eigen::Vector3d before =
        Eigen::Vector3d::Zero();                      // m, world: where the probe was in the last timed cycle
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, from the probe: surfaces near this place count
    std::uint32_t deepest = 0;                        // the member that overlaps the probe most
};

class ContactStage {
  public:
    ContactStage(SceneState& state, ContactSets& sets, SurfaceCandidates& candidates)
        : state_(state), sets_(sets), candidates_(candidates), curved_(state, sets) {}

    /// The path of the proxy, which surfaces read that are entered and left.
    ProxyPath& path() noexcept { return path_; }
    /// Adds the wrench of all surfaces, about the hand's position.
    void evaluate(double dt, Wrench& sum) noexcept;

  private:
    void evaluate_set(const ContactState& contact, ContactSet& set, const ProbeState& at, double dt) noexcept;
    double scan_standing(ContactSet& set, const Eigen::Vector3d& p) noexcept;
    void rest(ContactSet& set, const Probe& probe, double dt) noexcept;
    void stay_clear(ContactState& contact, const Eigen::Vector3d& p) const noexcept;
    double evaluate_moving(ContactSet& set, const Probe& probe, double dt, double worst) noexcept;
    double evaluate_member(const ContactSet& set, const Probe& probe, double dt,
                           std::uint32_t member) noexcept;
    std::uint32_t contacts_of(Record& r, const KindOps& ops, const Probe& probe, double step) noexcept;
    void subtract_relief(const Record& r, TangentialRecord& feel, const Probe& probe, double step,
                         std::uint32_t count) noexcept;
    double put_contacts(const ContactSet& set, const Record& r, std::uint32_t room, std::uint32_t count,
                        std::uint32_t member) noexcept;
    const Layer* solve(ContactSet& set, const Probe& probe, double worst) noexcept;
    double damped_force(ContactSet& set, const Probe& probe, const Layer& top) noexcept;
    void add_summed(ContactSet& set, const Probe& probe) noexcept;
    const Layer* widen(ContactSet& set, const Probe& probe, double dt, double standing,
                       double& worst) noexcept;
    const Layer* solve_widening(ContactSet& set, const Probe& probe, double dt, double standing,
                                double& worst) noexcept;
    bool candidates_fall_short() noexcept;
    Eigen::Vector3d cross_fade(std::uint32_t probe, double dt) noexcept;
    Eigen::Vector3d felt_by(std::uint32_t probe, double dt) noexcept;

    // scene_seams.cpp: A probe without contact, or with one surface alone, is its own path.
    [[gnu::always_inline]] bool is_alone(const ContactSet& set) noexcept {
        path_.stage = ProxyPath::Stage::free;
        path_.holds = path_.beside = false;
        return set.moving_count == 1 && set.standing == 0 && (set.held.isZero(0) || is_held_by_first(set));
    }
    bool is_held_by_first(const ContactSet& set) const noexcept {
        return sets_.arena().owner[set.begin] >> 1 == set.held_by;
    }
    // The path ends where its one surface holds it, not where that surface pushes a probe with a radius.
    void come_alone(ContactSet& set, bool violated) const noexcept {
        set.led = false;
        if (violated && path_.holds) {
            set.reached = set.layer[0].solution.dx;
        } else {
            set.reached.setZero();
        }
    }
    void begin_path(const ContactState& contact, const ContactSet& set,
                    const Eigen::Vector3d& before) noexcept;
    void set_stage(const ContactSet& set, std::uint32_t member, bool first) noexcept;
    const Layer* lead_on(ContactSet& set, const Probe& probe, double dt, double standing,
                         double& worst) noexcept;
    const Layer* lead_proxy(ContactSet& set, const Probe& probe, double dt, double standing,
                            double& worst) noexcept;
    const Layer* solve_or_rest(ContactSet& set, const Probe& probe, double dt, double standing,
                               double& worst) noexcept;
    void fill_path(const ContactSet& set, std::uint32_t member) noexcept;
    static bool holds_harder(const ContactSet& set, std::uint32_t member, std::uint32_t count) noexcept;
    void pass_along(ContactSet& set, const Probe& probe, ProxyPath::Stage stage) noexcept;
    std::uint32_t count_close(ContactSet& set, const Probe& probe, const Eigen::Vector3d& place) noexcept;
    const Layer* brush(ContactSet& set, const Probe& probe, double dt, double standing, double& worst,
                       const Layer* top) noexcept;
    void remember_proxy(ContactSet& set) noexcept;

    // scene_gaps.cpp
    void begin_gap(ContactSet& set, const Eigen::Vector3d& probe, std::uint32_t member) noexcept;
    static void remember_layers(ContactState& contact, const Eigen::Vector3d& probe) noexcept;
    bool lower_by_gaps(const ContactSet& set, const Layer& layer, PlanesApart& apart) noexcept;
    void close_gaps(ContactSet& set) noexcept;

    SceneState& state_;
    ContactSets& sets_;
    SurfaceCandidates& candidates_;
    CurvedStage curved_;
    std::array<Contact, max_contacts> found_;  // scratch of evaluate_moving
    ProxyPath path_;                           // for the surface under evaluation
    Lead lead_;                                // for the set under evaluation
};

}  // namespace knurl::detail
