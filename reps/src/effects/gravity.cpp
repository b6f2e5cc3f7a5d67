#include <knurl/reps/gravity.hpp>

namespace knurl {

Gravity prepared(Gravity params, const Limits&) noexcept {
    return params;
}

void adopt(const Gravity&, const Gravity*, Gravity::State&, const Probe&) noexcept {}

Wrench evaluate(const Gravity& params, Gravity::State&, const Probe&, double) noexcept {
    return {.force = params.mass * to_eigen(params.acceleration)};
}

bool powerless(const Gravity& params) noexcept {
    return params.mass == 0 || params.acceleration == Vec3{};
}

}  // namespace knurl
