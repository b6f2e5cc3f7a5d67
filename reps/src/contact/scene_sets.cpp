// Builds each probe's sets: the surfaces that act now and, while a fade lasts, those that acted before.

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/contact_sets.hpp"
#include "scene/clamped.hpp"

namespace knurl::detail {

ContactSets::ContactSets(SceneState& state, SurfaceCandidates& candidates)
    : state_(state),
      candidates_(candidates),
      states_(state.probes.size()),
      slots_(state.slots.size()),
      surfaces_(empty_list(slots_.size())),
      olds_(empty_list(slots_.size())),
      reshaped_(empty_list(slots_.size())) {
    // A slot is in at most three sets: its old record in one probe's fading set, its new one in both sets of
    // another probe. Each set is aligned to four.
    const std::size_t n = slots_.size();
    const std::size_t members = 3 * n * max_contacts + Scene::max_probes + 2 * 4 * Scene::max_probes;
    planes_.resize(6 * members);
    bounding_spheres_.resize(3 * n);
    for (Arena& arena : arenas_) {
        std::span<double> rest(planes_);
        for (std::span<double>* array : {&arena.nx, &arena.ny, &arena.nz, &arena.c, &arena.s, &arena.b}) {
            *array = rest.first(members);
            rest = rest.subspan(members);
        }
        arena.owner.resize(members);
        arena.moving.resize(3 * n);
        arena.bounding_spheres = &bounding_spheres_;
    }
    scratch_.resize(2 * n + 1);
    level_.resize(2 * n + 1);
}

void ContactSets::reset() noexcept {
    std::fill(slots_.begin(), slots_.end(), SetSlot{});
    std::fill(states_.begin(), states_.end(), ContactState{});
    surfaces_.clear();
    olds_.clear();
    reshaped_.clear();
    used_ = 0;
    edited_ = true;
}

void ContactSets::add(std::uint32_t i) noexcept {
    join(surfaces_, i, slots_[i].place);
}

void ContactSets::remove(std::uint32_t i) noexcept {
    leave(surfaces_, i, [this](std::uint32_t slot) -> std::uint32_t& { return slots_[slot].place; });
}

void ContactSets::update(std::span<const std::uint32_t> renewed) noexcept {
    if (!edited_ && !reshaped_.empty()) edited_ = !reshape_sets(renewed);
    if (edited_) rebuild(renewed);
    reshaped_.clear();
}

std::span<const Owner> ContactSets::list_now(std::uint32_t p) noexcept {
    std::uint32_t n = 0;
    for (const std::uint32_t i : candidates_.always()) {
        if (state_.records.current(i).probe == p) scratch_[n++] = state_.records.owner(i, false);
    }
    for (const std::uint32_t i : candidates_.of(p)) scratch_[n++] = state_.records.owner(i, false);
    return {scratch_.data(), n};
}

// The distinct stiffnesses of a set, softest first. Where there is one too many, the nearest two become one,
// the softer: no surface is stiffer than requested.
struct ContactSets::Levels {
    std::array<double, max_layers + 1> k{};
    std::uint32_t count = 0;

    void take(double stiffness) noexcept {
        std::uint32_t at = 0;
        while (at < count && k[at] < stiffness) ++at;
        if (at < count && k[at] == stiffness) return;
        for (std::uint32_t i = count; i > at; --i) k[i] = k[i - 1];
        k[at] = stiffness;
        if (++count <= max_layers) return;
        std::uint32_t nearest = 0;
        for (std::uint32_t i = 1; i + 1 < count; ++i) {
            if (k[i + 1] * k[nearest] < k[nearest + 1] * k[i]) nearest = i;  // by ratio
        }
        for (std::uint32_t i = nearest + 1; i + 1 < count; ++i) k[i] = k[i + 1];
        --count;
    }
    std::uint8_t of(double stiffness) const noexcept {
        std::uint32_t at = count - 1;
        while (at > 0 && k[at] > stiffness) --at;
        return static_cast<std::uint8_t>(at);
    }
    // Values besides the layers: in no set, and summed behind the layers.
    static constexpr std::uint8_t none = 0xff, summed = 0xfe;
};

double ContactSets::stiffness_of(Owner o, std::uint32_t p) const noexcept {
    return o == frozen_plane_owner ? states_[p].frozen_plane.stiffness : state_.records[o].stiffness;
}
double ContactSets::weight_of(Owner o) const noexcept {
    return o == frozen_plane_owner ? 1 : state_.records[o].weight;
}
bool ContactSets::stands(Owner o) const noexcept {
    return o == frozen_plane_owner || state_.records[o].stands;
}
// Up to this share of its stiffness a surface holds by its face itself; 0: it has no gap.
double ContactSets::gap_above(Owner o) const noexcept {
    if (o == frozen_plane_owner || !(state_.records.gap(o).depth > 0)) return 0;
    return state_.records.gap(o).softer;
}
std::uint32_t ContactSets::parts_of(Owner o) const noexcept {
    return stands(o) ? 1 : kind_ops()[state_.records[o].kind].contacts;
}

// A common weight scales the force. Unequal weights give unequal stiffnesses, and the layers keep their force
// continuous.
void ContactSets::share_weight(ContactSet& set, std::span<const Owner> owners) const noexcept {
    const double first = weight_of(owners.front());
    const bool uniform =
        std::all_of(owners.begin(), owners.end(), [&](Owner o) { return weight_of(o) == first; });
    set.scale = uniform ? first : 1;
}

// Hardest first, so that each layer is a prefix; summed planes come last.
void ContactSets::sort_into_layers(ContactSet& set, std::uint32_t p, std::span<const Owner> owners) noexcept {
    const auto felt_stiffness = [&](Owner o) { return stiffness_of(o, p) * own_weight(set, weight_of(o)); };
    Levels levels;
    for (std::size_t i = 0; i < owners.size(); ++i) {
        const Owner o = owners[i];
        const double k = felt_stiffness(o);
        level_[i] = 0;
        if (!(k > 0)) {
            level_[i] = Levels::none;
        } else if (o != frozen_plane_owner && state_.records[o].summed) {
            level_[i] = Levels::summed;
            ++set.summed;
        } else {
            levels.take(k);
            if (const double softer = gap_above(o); softer > 0) levels.take(softer * k);
        }
        set.has_tangential =
            set.has_tangential ||
            (o == frozen_plane_owner ? states_[p].frozen_plane.law.rubs() : state_.records[o].has_tangential);
    }
    set.layers = levels.count;
    std::array<std::uint32_t, max_layers> members{};
    for (std::size_t i = 0; i < owners.size(); ++i) {
        if (level_[i] >= Levels::summed) continue;
        level_[i] = levels.of(felt_stiffness(owners[i]));
        members[level_[i]] += parts_of(owners[i]);
    }
    for (std::uint32_t j = set.layers; j-- > 0;) {
        next_place_[j] = set.count;
        set.count += members[j];
        set.layer[j].stiffness = levels.k[j];
        set.layer[j].count = set.count;
    }
}

void ContactSets::put_plane(const ContactSet& set, std::uint32_t p, Arena& into, Owner o,
                            std::uint32_t at) const noexcept {
    const HalfSpace& plane =
        o == frozen_plane_owner ? states_[p].frozen_plane.plane : state_.records[o].plane;
    into.owner[at] = o;
    into.nx[at] = plane.normal.x();
    into.ny[at] = plane.normal.y();
    into.nz[at] = plane.normal.z();
    into.c[at] = plane.offset + (o == frozen_plane_owner ? 0 : state_.probes[p].probe.radius);
    into.s[at] = -std::numeric_limits<double>::infinity();
    into.b[at] = o == frozen_plane_owner ? 0 : plane.damping * own_weight(set, weight_of(o));
}

// A moving surface is evaluated in each cycle; until the first evaluation it is out of reach.
void ContactSets::put_moving(std::uint32_t p, Arena& into, Owner o, std::uint32_t at) const noexcept {
    for (std::uint32_t part = at; part < at + parts_of(o); ++part) {
        into.owner[part] = o;
        into.nx[part] = into.ny[part] = into.nz[part] = into.b[part] = 0;
        into.c[part] = into.s[part] = -std::numeric_limits<double>::infinity();
    }
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double reach = std::numeric_limits<double>::infinity();
    // A moving surface may come near, so it is evaluated while it is in a set.
    const Record& r = state_.records[o];
    const std::optional<Bound> ball = kind_ops()[r.kind].bound(r);
    if (ball && ball->velocity.isZero(0)) {
        center = ball->center;
        reach = ball->radius + state_.probes[p].probe.radius;
        reach += 1e-12 * (reach + center.lpNorm<1>());  // what the rounding of coordinates may hide
    }
    into.bounding_spheres->put(into.moving_used, center, reach);
    into.moving[into.moving_used++] = {.member = at};
}

void ContactSets::build(ContactSet& set, std::uint32_t p, Arena& into,
                        std::span<const Owner> owners) noexcept {
    const bool is_now = &set == &states_[p].now;
    set.begin = into.used;
    set.count = set.standing = set.summed = set.layers = 0;
    set.moving_begin = into.moving_used;
    set.moving_count = set.room = set.moving_room = set.inside = 0;
    set.infeasible = set.has_tangential = set.curved = set.follows = set.gaps = false;
    if (owners.empty()) {
        set.force.setZero();
        set.held.setZero();
        set.touching = false;
        return;
    }
    ++state_.work.sets;
    share_weight(set, owners);
    sort_into_layers(set, p, owners);
    forget_solution(set, state_.probes[p].probe.position);
    std::uint32_t next_sum = set.count;
    for (std::size_t i = 0; i < owners.size(); ++i) {
        const Owner o = owners[i];
        if (level_[i] == Levels::none) {
            if (o != frozen_plane_owner && !state_.records.fades_out(o)) slots_[o >> 1].member = in_no_set;
            continue;
        }
        const bool summed = level_[i] == Levels::summed;
        std::uint32_t& place = summed ? next_sum : next_place_[level_[i]];
        const std::uint32_t at = set.begin + place;
        place += parts_of(o);
        if (stands(o)) {
            put_plane(set, p, into, o, at);
            set.standing += !summed;
        } else {
            put_moving(p, into, o, at);
            set.follows = set.follows || kind_ops()[state_.records[o].kind].follows;
            set.gaps = set.gaps || gap_above(o) > 0;
            set.curved = set.curved || (!summed && kind_ops()[state_.records[o].kind].curved);
        }
        if (o != frozen_plane_owner && is_now) slots_[o >> 1].member = at;
    }
    set.curved = set.curved && surfaces_.size() > 1;
    set.moving_count = set.moving_room = into.moving_used - set.moving_begin;
    set.room = (set.count + set.summed + 3) / 4 * 4;
    into.used += set.room;
}

void forget_solution(ContactSet& set, const Eigen::Vector3d& probe) noexcept {
    set.infeasible = false;
    set.clear = {};
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        Layer& layer = set.layer[j];
        layer.give = layer.given_at = 0;
        layer.solution = ContactSolution{};
        layer.reached[0].cycle = layer.reached[1].cycle = 0;
        layer.started = false;
        layer.far = 0;
        layer.joined = false;
        layer.proxy = probe;
    }
}

void ContactSets::rebuild(std::span<const std::uint32_t> renewed) noexcept {
    Arena& into = arenas_[arena_ ^ 1];
    into.used = into.moving_used = 0;
    used_ = 0;
    for_each_bit(state_.probes_used, [&](std::uint32_t p) { begin_fade(p, renewed); });
    forget_ended_olds();
    for_each_bit(state_.probes_used, [&](std::uint32_t p) {
        ContactState& contact = states_[p];
        const Starts starts = starts_of_probe(p);
        build(contact.old, p, into, list_old(p));
        build(contact.now, p, into, list_now(p));
        take_starts_of_probe(p, into, starts);
        built(p);
    });
    arena_ ^= 1;
    edited_ = false;
    state_.feedback_edited = true;
}

void ContactSets::built(std::uint32_t p) noexcept {
    ContactState& contact = states_[p];
    contact.tangential.present = contact.now.has_tangential || contact.old.has_tangential;
    contact.tangential.leave_anchor();
    if (!contact.empty() || contact.fade.under_way) {
        used_ |= 1u << p;
    } else {
        contact.release();
    }
    contact.change = SetChange{};
}

}  // namespace knurl::detail
