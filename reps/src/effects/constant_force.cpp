#include <knurl/reps/constant_force.hpp>

namespace knurl {

ConstantForce prepared(ConstantForce params, const Limits&) noexcept {
    return params;
}

void adopt(const ConstantForce&, const ConstantForce*, ConstantForce::State&, const Probe&) noexcept {}

Wrench evaluate(const ConstantForce& params, ConstantForce::State&, const Probe&, double) noexcept {
    return {.force = to_eigen(params.force), .torque = to_eigen(params.torque)};
}

bool powerless(const ConstantForce& params) noexcept {
    return params.force == Vec3{} && params.torque == Vec3{};
}

}  // namespace knurl
