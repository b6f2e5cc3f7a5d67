// The bound of the work of all claims together (load_watch.hpp).

#include "servo_impl.hpp"

namespace knurl::servo {

// At the beginning of a cycle, by what the last ones took. The load is in the cycle's record and a claim that is
// shed in a record of its own, so a replay decides alike.
void Servo::Impl::watch_load() noexcept {
    if (load.sheds()) shed_costliest();
    load.round();
    if (load.overloaded()) stop_for(fault::overload);
}

Nanoseconds Servo::Impl::charge(Claim::Impl& claim, Nanoseconds from) noexcept {
    const Nanoseconds now = clock.now();
    claim.charged += load.share_of(now - from);
    return now;
}

// Of the application that takes most, the claim that takes most: many small claims of one application are not
// better off than one large claim.
void Servo::Impl::shed_costliest() noexcept {
    const auto pid_of = [](const Claim::Impl& c) {
        return c.row != nullptr ? c.row->pid.load(std::memory_order_relaxed) : 0;
    };
    const auto counts = [](const Claim::Impl& c) { return c.channels && !c.shed && c.cost > 0; };
    std::size_t costliest = claims.size();
    double most = 0;
    for (const std::size_t place : claims.awake()) {
        const Claim::Impl& c = claims[place];
        if (!counts(c)) continue;
        double application = 0;
        for (const std::size_t other : claims.awake())
            if (const Claim::Impl& o = claims[other]; counts(o) && pid_of(o) == pid_of(c))
                application += o.cost;
        if (application < most || (application == most && c.cost <= claims[costliest].cost)) continue;
        most = application;
        costliest = place;
    }
    if (costliest == claims.size()) return;
    load.relieve(claims[costliest].cost);
    if (input_log != nullptr) put_claim(InputType::shed, claims[costliest].number);
    shed(costliest);
}

// Its force stays as it is and fades with the gain. It has no stiffness meanwhile, so the hand's budget does not
// count it.
void Servo::Impl::shed(std::size_t place) noexcept {
    Claim::Impl& c = claims[place];
    c.shed = true;
    c.shed_with = static_cast<std::uint32_t>(c.scene.size());
    c.armed = c.touching = false;
    c.cost = 0;
    ++claims_shed;
    claims.wake(place);
}

}  // namespace knurl::servo
