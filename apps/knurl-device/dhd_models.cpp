#include "dhd_models.hpp"

#include <algorithm>
#include <array>

namespace knurl::device {

namespace {

constexpr const char* chai =
    "force, torque and ball from CHAI3D's driver; resolution the data sheet's, unverified";
constexpr const char* sheet = "all from the data sheet, unverified";

// Type numbers as in the SDK's documentation (forcedimension_core, constants).
constexpr std::array models = {
    DhdModel{63, "delta.3", 20, 0, 0, 0.15, 20e-6, chai},
    DhdModel{33, "omega.3", 12, 0, 0, 0.075, 10e-6, chai},
    DhdModel{34, "omega.6 (right)", 12, 0, 0, 0.075, 10e-6, chai},
    DhdModel{36, "omega.6 (left)", 12, 0, 0, 0.075, 10e-6, chai},
    DhdModel{35, "omega.7 (right)", 12, 0, 8, 0.075, 10e-6, chai},
    DhdModel{37, "omega.7 (left)", 12, 0, 8, 0.075, 10e-6, chai},
    DhdModel{206, "sigma.3", 20, 0, 0, 0.065, 1.5e-6, sheet},
    DhdModel{104, "sigma.7 (right)", 12, 0.2, 8, 0.075, 1.5e-6, chai},
    DhdModel{105, "sigma.7 (left)", 12, 0.2, 8, 0.075, 1.5e-6, chai},
    DhdModel{203, "lambda.3", 20, 0, 0, 0.085, 1.5e-6, sheet},
    DhdModel{108, "lambda.7 (right)", 20, 0.4, 8, 0.085, 1.5e-6, sheet},
    DhdModel{109, "lambda.7 (left)", 20, 0.4, 8, 0.085, 1.5e-6, sheet},
    DhdModel{60, "Falcon (by the SDK)", 8, 0, 0, 0.04, 60e-6, "from CHAI3D's driver"},
};

}  // namespace

const DhdModel* dhd_model(int type) noexcept {
    const auto found = std::ranges::find(models, type, &DhdModel::type);
    return found == models.end() ? nullptr : &*found;
}

}  // namespace knurl::device
