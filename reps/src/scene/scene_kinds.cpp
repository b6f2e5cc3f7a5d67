// The table from the list of representations to functions over bytes.

#include <cstring>
#include <new>

#include "effects/effect_stage.hpp"
#include "scene/clamped.hpp"
#include "scene/kind_ops.hpp"
#include "tables/ranges.hpp"

namespace knurl::detail {
namespace {

template <class R>
R& params_of(Record& r) noexcept {
    return *std::launder(reinterpret_cast<R*>(r.params));
}
template <class R>
const R& params_of(const Record& r) noexcept {
    return *std::launder(reinterpret_cast<const R*>(r.params));
}
template <class R>
typename R::State& state_of(Record& r) noexcept {
    return *std::launder(reinterpret_cast<typename R::State*>(r.state));
}
template <class R>
const typename R::State& state_of(const Record& r) noexcept {
    return *std::launder(reinterpret_cast<const typename R::State*>(r.state));
}

template <class R>
constexpr bool turns_of() {
    if constexpr (requires { R::turns; }) return R::turns;
    return false;
}

template <class R>
constexpr bool follows_of() {
    if constexpr (requires { R::follows; }) return R::follows;
    return false;
}

template <class R>
inline constexpr bool is_curved = requires(const R& params, const typename R::State& state,
                                           const Probe& probe, std::span<CurvedContact> out) {
    curved(params, state, probe, probe, out);
};

template <class R>
struct Ops {
    static R& typed(std::byte* bytes) noexcept { return *std::launder(reinterpret_cast<R*>(bytes)); }
    static const R& typed(const std::byte* bytes) noexcept {
        return *std::launder(reinterpret_cast<const R*>(bytes));
    }
    static void prepare(const std::byte* raw, const Limits& limits, std::byte* out) noexcept {
        new (out) R(prepared(typed(raw), limits));
    }
    // True: the change has no effect on the force. A change of recovery alone is noted for the next change.
    static bool unchanged(std::byte* prepared, Record& now) noexcept {
        if constexpr (requires(R & r) { r.recovery; }) {
            const double requested = typed(prepared).recovery;
            typed(prepared).recovery = params_of<R>(now).recovery;
            const bool same = std::memcmp(prepared, now.params, sizeof(R)) == 0;
            typed(prepared).recovery = requested;
            if (same) params_of<R>(now).recovery = requested;
            return same;
        } else {
            return std::memcmp(prepared, now.params, sizeof(R)) == 0;
        }
    }
    static void install(const std::byte* prepared, const Limits& limits, Record& out,
                        TangentialRecord& tangential) noexcept {
        const R& params = typed(prepared);
        std::memcpy(out.params, prepared, sizeof params);
        out.kind = kind_of<R>;
        out.stiffness = 0;
        out.stands = out.recovers = out.summed = out.has_tangential = false;
        if constexpr (requires { params.stiffness; }) out.stiffness = params.stiffness;
        if constexpr (requires { params.combine; }) out.summed = params.combine == PlaneCombine::sum;
        if constexpr (requires { recovers_itself(params); }) out.recovers = recovers_itself(params);
        if constexpr (Surface<R>) {
            out.velocity = to_eigen(params.velocity);
            const bool rubs = params.friction.static_ > 0 || params.friction.dynamic > 0 ||
                              params.friction.viscous > 0 || params.snag.k_stick > 0 ||
                              params.snag.k_kinetic > 0;
            // A texture finer than two encoder counts is noise, in a world of any scale.
            out.textured = params.texture.amplitude > 0 && params.texture.wavelength >= 2 * limits.resolution;
            out.has_tangential = rubs || out.textured || (params.braking > 0 && limits.mass > 0);
            if (out.has_tangential) {
                tangential.law = rubs ? friction_law(params.friction, params.snag, params.stiffness, limits)
                                      : FrictionLaw{};
                tangential.texture = params.texture;
                tangential.braking = params.braking;
            }
        }
        if constexpr (requires { standing(params); }) {
            if (out.textured) return;
            const std::optional<HalfSpace> plane = standing(params);
            out.stands = plane.has_value();
            if (plane) out.plane = *plane;
        }
    }
    static Differ compare_geometry(const std::byte* raw, const std::byte* sent) noexcept {
        constexpr std::size_t geometry = geometry_bytes<R>();
        if (same_words<geometry>(raw, sent)) return Differ::nowhere;
        if (!fields_are_legal<R, geometry>(sent)) return Differ::anywhere;
        if constexpr (requires(const R& params) { Describe<R>::check(params); }) {
            R merged = typed(raw);
            std::memcpy(static_cast<void*>(&merged), sent, geometry);
            if (!Describe<R>::check(merged)) return Differ::anywhere;
        }
        return Differ::in_geometry;
    }
    static Reshaped reshape([[maybe_unused]] const std::byte* raw, [[maybe_unused]] const Record& now,
                            [[maybe_unused]] Record& out) noexcept {
        if constexpr (requires(R & params) { prepare_geometry(params); }) {
            R& params = params_of<R>(out);
            std::memcpy(out.params, raw, geometry_bytes<R>());
            prepare_geometry(params);
            const std::optional<HalfSpace> plane = standing(params);
            if (!plane) return Reshaped::moves;
            if (same_words<sizeof *plane>(&*plane, &now.plane)) return Reshaped::nothing;
            std::memcpy(static_cast<void*>(static_cast<RecordLine*>(&out)),
                        static_cast<const RecordLine*>(&now), sizeof(RecordLine));
            out.plane = *plane;
            return Reshaped::elsewhere;
        } else {
            return Reshaped::moves;
        }
    }
    // A record that stood still has the state of a new one: it was never evaluated.
    static void adopt_new(Record& now, const Record* previous, const Probe& probe,
                          [[maybe_unused]] const Assets& assets) noexcept {
        if (!previous || previous->stands) new (now.state) typename R::State{};
        if constexpr (requires(R r) { r.asset; }) {
            const std::uint32_t number = params_of<R>(now).asset;
            state_of<R>(now).asset = number > 0 && number <= max_assets ? assets[number - 1] : nullptr;
        }
        adopt(params_of<R>(now), previous ? &params_of<R>(*previous) : nullptr, state_of<R>(now), probe);
    }
    static void settle_now(Record& r) noexcept {
        if constexpr (requires { settle(params_of<R>(r), state_of<R>(r)); })
            settle(params_of<R>(r), state_of<R>(r));
    }
    static double fade_time(const std::byte* params) noexcept {
        [[maybe_unused]] const R& p = typed(params);
        if constexpr (requires { p.recovery; }) return p.recovery;
        if constexpr (requires { p.duration; }) return p.duration;
        return automatic;
    }
    static double requested_stiffness([[maybe_unused]] const std::byte* raw) noexcept {
        if constexpr (requires(const R& p) { p.stiffness; }) return typed(raw).stiffness;
        return 0;
    }
    static constexpr bool loads =
        Effect<R> && (
                         requires(const R& p) { p.stiffness; } || requires(const R& p) { p.damping; });
    static HandLoad load_at(const Record& r, [[maybe_unused]] const Probe& probe) noexcept {
        const R& params = params_of<R>(r);
        const auto& state = state_of<R>(r);
        if constexpr (requires { load(params, state, probe); }) {
            return load(params, state, probe);
        } else {
            HandLoad same = {};
            if constexpr (requires { params.stiffness; }) same += isotropic_load(params.stiffness, 0);
            if constexpr (requires { params.damping; }) same += isotropic_load(0, params.damping);
            return same;
        }
    }
    // The stiffness and damping follow from each kind's clamps: no torque is stiffer than the device's limit,
    // nor more damped.
    static Demand load_bound_of(const Record& r, const Limits& limits) noexcept {
        const Shares shares = shares_of(limits);
        const R& params = params_of<R>(r);
        Demand bound;
        if constexpr (requires { params.stiffness; }) bound.stiffness = shares.stiffness * params.stiffness;
        if constexpr (requires { params.damping; }) bound.damping = shares.damping * params.damping;
        if constexpr (requires { params.attach; }) {
            if (shares.turning > 0 && params.attach != Vec3{}) {
                bound.stiffness += 1;
                bound.damping *= 1 + shares.turning * to_eigen(params.attach).squaredNorm();
            }
        }
        if constexpr (requires { params.angular_damping; })
            bound.damping += shares.damping * shares.turning * params.angular_damping;
        return bound;
    }
    static bool carry(Record& old, const Record& next) noexcept {
        if constexpr (requires { carried(params_of<R>(old), params_of<R>(next)); }) {
            const R params = carried(params_of<R>(old), params_of<R>(next));
            std::memcpy(old.params, &params, sizeof params);
            if constexpr (!requires { R::State::moves_alike; })
                std::memcpy(old.state, next.state, sizeof(typename R::State));
        }
        return std::memcmp(old.params, next.params, sizeof(R)) == 0;
    }
    // A surface with its own motion is evaluated in every cycle, since its ball would have to move along. A
    // turning surface's ball does move along, but not its texture.
    static std::optional<Bound> bound_of(const Record& r) noexcept {
        if constexpr (Effect<R> && requires(const R& p) { bound(p); }) {
            return bound(params_of<R>(r));
        } else if constexpr (requires(const R& p, const typename R::State& state) { bound(p, state); }) {
            if (r.velocity != Eigen::Vector3d::Zero() && (!turns_of<R>() || r.textured)) return std::nullopt;
            std::optional<Bound> ball = bound(params_of<R>(r), state_of<R>(r));
            if (ball && r.textured) ball->radius += params_of<R>(r).texture.amplitude;
            return ball;
        } else {
            return std::nullopt;
        }
    }
    static std::optional<double> clearance_of([[maybe_unused]] const Record& r,
                                              [[maybe_unused]] const Probe& probe) noexcept {
        if constexpr (requires(const R& p, const typename R::State& state) { clearance(p, state, probe); }) {
            if (r.velocity != Eigen::Vector3d::Zero()) return std::nullopt;
            const double relief = r.textured ? params_of<R>(r).texture.amplitude : 0;
            return clearance(params_of<R>(r), state_of<R>(r), probe) - relief;
        } else {
            return std::nullopt;
        }
    }
    static bool powerless_now([[maybe_unused]] const Record& r) noexcept {
        if constexpr (requires(const R& p) { powerless(p); }) return powerless(params_of<R>(r));
        return false;
    }
    static bool arrived_by_now([[maybe_unused]] const Record& r) noexcept {
        if constexpr (requires(const R& p, const typename R::State& state) { arrived(p, state); })
            return arrived(params_of<R>(r), state_of<R>(r));
        return true;
    }
    static void forget_path(Record& r) noexcept {
        if constexpr (requires { out_of_reach(params_of<R>(r), state_of<R>(r)); })
            out_of_reach(params_of<R>(r), state_of<R>(r));
    }
    static Motion* motion_of([[maybe_unused]] Record& r) noexcept {
        if constexpr (Surface<R>) return &state_of<R>(r).motion;
        return nullptr;
    }
    static const Asset* asset_of([[maybe_unused]] const Record& r) noexcept {
        if constexpr (requires(const typename R::State& state) { state.asset; })
            return std::launder(reinterpret_cast<const typename R::State*>(r.state))->asset;
        return nullptr;
    }
    static std::uint32_t contact_at(Record& r, const Probe& probe, double dt,
                                    std::span<Contact> out) noexcept {
        if constexpr (requires { contacts(params_of<R>(r), state_of<R>(r), probe, dt, out); }) {
            return contacts(params_of<R>(r), state_of<R>(r), probe, dt, out);
        } else if constexpr (Surface<R>) {
            out[0] = contact(params_of<R>(r), state_of<R>(r), probe, dt);
            return 1;
        } else {
            return 0;
        }
    }
    static std::uint32_t curved_at(const Record& r, const Probe& probe, const Probe& there,
                                   std::span<CurvedContact> out) noexcept {
        if constexpr (is_curved<R>) return curved(params_of<R>(r), state_of<R>(r), probe, there, out);
        return 0;
    }
    static constexpr bool leans = requires(const R& params, typename R::State& state, const Probe& probe) {
        lean(params, state, probe, 0.0);
    };
    static void lean_at(Record& r, const Probe& there, double below) noexcept {
        if constexpr (leans) lean(params_of<R>(r), state_of<R>(r), there, below);
    }
    static bool plane_alone_at([[maybe_unused]] const Record& r, [[maybe_unused]] const Probe& probe,
                               [[maybe_unused]] double stiffness,
                               [[maybe_unused]] CurvedContact& out) noexcept {
        if constexpr (leans) {
            return plane_alone(params_of<R>(r),
                               *std::launder(reinterpret_cast<const typename R::State*>(r.state)), probe,
                               stiffness, out);
        } else {
            return false;
        }
    }
    static Wrench evaluate_at(Record& r, const Probe& probe, double dt) noexcept {
        if constexpr (Effect<R>) return evaluate(params_of<R>(r), state_of<R>(r), probe, dt);
        return {};
    }
    static void evaluate_all(EffectStage& stage, std::span<const std::uint32_t> slots, double dt,
                             Wrench& sum) noexcept {
        if constexpr (Effect<R>) {
            stage.evaluate_each(
                slots, dt, sum,
                [](Record& r, const Probe& probe, double step) {
                    return evaluate(params_of<R>(r), state_of<R>(r), probe, step);
                },
                arrived_by_now);
        }
    }
};

template <class R>
constexpr std::uint32_t contacts_of() {
    if constexpr (requires { R::max_contacts; }) {
        static_assert(R::max_contacts <= max_contacts);
        return R::max_contacts;
    } else {
        return 1;
    }
}

template <class... R>
constexpr auto table(TypeList<R...>) {
    return std::array<KindOps, sizeof...(R)>{
        KindOps{.surface = Surface<R>,
                .turns = turns_of<R>(),
                .curved = is_curved<R>,
                .follows = follows_of<R>(),
                .contacts = contacts_of<R>(),
                .params_size = sizeof(R),
                .state_size = sizeof(typename R::State),
                .prepare = &Ops<R>::prepare,
                .unchanged = &Ops<R>::unchanged,
                .geometry_bytes = geometry_bytes<R>(),
                .compare_geometry = &Ops<R>::compare_geometry,
                .reshape = &Ops<R>::reshape,
                .install = &Ops<R>::install,
                .adopt = &Ops<R>::adopt_new,
                .settle = &Ops<R>::settle_now,
                .fade_time = &Ops<R>::fade_time,
                .requested_stiffness = &Ops<R>::requested_stiffness,
                .load_bound = Ops<R>::loads ? &Ops<R>::load_bound_of : nullptr,
                .load = Ops<R>::loads ? &Ops<R>::load_at : nullptr,
                .carry = &Ops<R>::carry,
                .bound = &Ops<R>::bound_of,
                .powerless = &Ops<R>::powerless_now,
                .arrived = &Ops<R>::arrived_by_now,
                .clearance = &Ops<R>::clearance_of,
                .out_of_reach = &Ops<R>::forget_path,
                .motion = &Ops<R>::motion_of,
                .asset = &Ops<R>::asset_of,
                .contact = &Ops<R>::contact_at,
                .curved_at = &Ops<R>::curved_at,
                .lean = &Ops<R>::lean_at,
                .plane_alone = Ops<R>::leans ? &Ops<R>::plane_alone_at : nullptr,
                .evaluate = &Ops<R>::evaluate_at,
                .evaluate_all = &Ops<R>::evaluate_all}...};
}

}  // namespace

constinit const std::array<KindOps, Representations::size> all_ops = table(Representations{});

}  // namespace knurl::detail
