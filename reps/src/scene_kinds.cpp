// From the list of representations to functions over bytes.

#include <cstring>
#include <new>

#include "clamped.hpp"
#include "scene_core.hpp"

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
struct Ops {
    static void prepare(const std::byte* raw, const Limits& limits, Record& out) noexcept {
        R sent;
        std::memcpy(&sent, raw, sizeof sent);
        const R params = prepared(sent, limits);
        std::memcpy(out.params, &params, sizeof params);
        out.kind = kind_of<R>;
        if constexpr (requires { params.stiffness; }) out.stiffness = params.stiffness;
        if constexpr (requires { recovers_itself(params); }) out.recovers = recovers_itself(params);
        if constexpr (requires { standing(params); }) {
            const std::optional<HalfSpace> plane = standing(params);
            out.stands = plane.has_value();
            if (plane) out.plane = *plane;
        }
    }
    // Nothing that is felt: another recovery alone is noted for the change that it will belong to.
    static bool unchanged(const std::byte* raw, const Limits& limits, Record& now) noexcept {
        R sent;
        std::memcpy(&sent, raw, sizeof sent);
        R params = prepared(sent, limits);
        if constexpr (requires { params.recovery; }) {
            const double asked = params.recovery;
            params.recovery = params_of<R>(now).recovery;
            if (std::memcmp(&params, now.params, sizeof params) != 0) return false;
            params.recovery = asked;
            std::memcpy(now.params, &params, sizeof params);
            return true;
        }
        return std::memcmp(&params, now.params, sizeof params) == 0;
    }
    static void adopt_new(Record& now, const Record* previous, const Probe& probe) noexcept {
        if (!previous) new (now.state) typename R::State{};
        adopt(params_of<R>(now), previous ? &params_of<R>(*previous) : nullptr, state_of<R>(now), probe);
    }
    static void settle_now(Record& r) noexcept {
        if constexpr (requires { settle(params_of<R>(r), state_of<R>(r)); })
            settle(params_of<R>(r), state_of<R>(r));
    }
    static double fade_time(const std::byte* params) noexcept {
        R p;
        std::memcpy(&p, params, sizeof p);
        if constexpr (requires { p.recovery; }) {
            return p.recovery;
        } else if constexpr (requires { p.duration; }) {
            return p.duration;
        } else {
            return automatic;
        }
    }
    static double asked_stiffness(const std::byte* raw) noexcept {
        R p;
        std::memcpy(&p, raw, sizeof p);
        if constexpr (requires { p.stiffness; }) {
            return p.stiffness;
        } else {
            return 0;
        }
    }
    static bool carry(Record& old, const Record& next) noexcept {
        if constexpr (requires { carried(params_of<R>(old), params_of<R>(next)); }) {
            const R params = carried(params_of<R>(old), params_of<R>(next));
            std::memcpy(old.params, &params, sizeof params);
            std::memcpy(old.state, next.state, sizeof(typename R::State));
        }
        return std::memcmp(old.params, next.params, sizeof(R)) == 0;
    }
    static Contact contact_at(Record& r, const Probe& probe, double dt) noexcept {
        if constexpr (Surface<R>) {
            return contact(params_of<R>(r), state_of<R>(r), probe, dt);
        } else {
            return {};
        }
    }
    static Wrench evaluate_at(Record& r, const Probe& probe, double dt) noexcept {
        if constexpr (Effect<R>) {
            return evaluate(params_of<R>(r), state_of<R>(r), probe, dt);
        } else {
            return {};
        }
    }
    // One call per kind in the scene: a kind that nobody uses is not even asked.
    static void evaluate_all(SceneCore& scene, std::span<const std::uint32_t> slots, double dt,
                             Wrench& sum) noexcept {
        if constexpr (Effect<R>) {
            for (const std::uint32_t i : slots) {
                Record& r = scene.now_[i];
                Slot& slot = scene.slots_[i];
                const Group& group = scene.groups_[r.use.probe];
                const Wrench w =
                    scene.at_hand(evaluate(params_of<R>(r), state_of<R>(r), group.probe, dt), group);
                slot.last = (slot.gain * r.weight) * w;
                sum += slot.last;
                if (slot.from != Slot::From::none) slot.last += slot.remnant;
            }
        }
    }
};

template <class... R>
constexpr auto table(TypeList<R...>) {
    return std::array<KindOps, sizeof...(R)>{KindOps{.surface = Surface<R>,
                                                     .params_size = sizeof(R),
                                                     .prepare = &Ops<R>::prepare,
                                                     .unchanged = &Ops<R>::unchanged,
                                                     .adopt = &Ops<R>::adopt_new,
                                                     .settle = &Ops<R>::settle_now,
                                                     .fade_time = &Ops<R>::fade_time,
                                                     .asked_stiffness = &Ops<R>::asked_stiffness,
                                                     .carry = &Ops<R>::carry,
                                                     .contact = &Ops<R>::contact_at,
                                                     .evaluate = &Ops<R>::evaluate_at,
                                                     .evaluate_all = &Ops<R>::evaluate_all}...};
}

constexpr auto all_ops = table(Representations{});

}  // namespace

std::span<const KindOps> kind_ops() noexcept {
    return all_ops;
}

}  // namespace knurl::detail
