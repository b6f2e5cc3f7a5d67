#pragma once
// The devices with motors that this library drives over USB, for tests that apply to each of them.

#include <cmath>
#include <ostream>

#include "falcon_bench.hpp"
#include "wooden_model.hpp"

namespace knurl::drivers::usb_emulator {

struct MotorDevice {
    const char* name;
    const char* address;  // of the one with the serial number "ONE"
    const char* other;    // "OTHER"
    std::shared_ptr<MotorModel> (*make)();
    /// Puts it into the middle of its workspace, after its power came. With the bus locked.
    void (*centre)(MotorModel& model);
    /// What efforts of so many N m on every joint are in its own unit.
    std::array<int, 3> (*all)(double effort);
    bool homed_after_replug;  // else only a restarted servo may push
};

inline std::ostream& operator<<(std::ostream& out, const MotorDevice& device) {
    return out << device.name;
}

/// Published scale of the Falcon, counts against the leg.
inline const MotorDevice falcon_device = {
    .name = "falcon",
    .address = "falcon:ONE,low_pass=0",
    .other = "falcon:OTHER,low_pass=0",
    .make = [] { return std::shared_ptr<MotorModel>(falcon_at_centre()); },
    .centre = [](MotorModel&) {},
    .all =
        [](double effort) {
            const int counts = static_cast<int>(std::lround(-10000 * effort));
            return std::array<int, 3>{counts, counts, counts};
        },
    .homed_after_replug = true};

/// mA; 0.0259 N m/A behind gears of 16, 12 and 12.
inline const MotorDevice wooden_device = {
    .name = "wooden",
    .address = "wooden:ONE",
    .other = "wooden:OTHER",
    .make = [] { return std::shared_ptr<MotorModel>(std::make_shared<WoodenModel>()); },
    .centre =
        [](MotorModel& model) {
            dynamic_cast<WoodenModel&>(model).counts = {0, 1313, 2535};
        },
    .all =
        [](double effort) {
            const auto milliamperes = [effort](double gear) {
                return static_cast<int>(std::lround(effort / (0.0259e-3 * gear)));
            };
            return std::array<int, 3>{milliamperes(16), milliamperes(12), milliamperes(12)};
        },
    .homed_after_replug = false};

/// Requests that the driver keeps in flight: for samples, and for efforts. A second packet of efforts would
/// wait if the device takes one per frame.
inline constexpr std::size_t kept_for_samples = 3;
inline std::size_t kept_of_efforts(const MotorModel& model) {
    return model.identity().interrupt_endpoints ? 1 : 2;
}

/// `port`: 1-1 unless it is said.
inline void plug_in(Bus& bus, const MotorDevice& device, const std::shared_ptr<MotorModel>& model,
                    const std::string& port = "1-1", const std::string& serial = "ONE") {
    bus.plug(model, {.port = port, .serial = serial});
    bus.locked([&] { device.centre(*model); });
}

inline auto each_motor_device() {
    return testing::Values(falcon_device, wooden_device);
}
inline std::string name_of(const testing::TestParamInfo<MotorDevice>& info) {
    return info.param.name;
}

}  // namespace knurl::drivers::usb_emulator
