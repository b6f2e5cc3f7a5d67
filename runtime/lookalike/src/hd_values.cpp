// hdGet...v and hdSet...v: what may be asked and set, in their units: mm, mm/s, N, mN m, rad.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include <knurl/gateway/frames.hpp>

#include "hd_state.hpp"

namespace knurl::lookalike::hd {

namespace {

constexpr gateway::Axes axes = gateway::frames::openhaptics;
constexpr double mm = 1000;          // a metre
constexpr double per_mm = 1e-3;      // N/m in N/mm
constexpr double millinewton = 1e3;  // N m in mN m

/// What one name gives: at most a matrix.
struct Values {
    std::array<double, 16> number{};
    std::size_t count = 0;

    Values() = default;
    Values(double one) : count(1) { number[0] = one; }
    Values(const Vec3& v) : count(3) {
        number[0] = v.x;
        number[1] = v.y;
        number[2] = v.z;
    }
};

/// Column by column, as OpenGL has it.
Values transform(const HandReport& report) {
    const Quat q = axes.orientation(report.orientation);
    const Vec3 p = axes.position(report.position);
    Values m;
    m.count = 16;
    m.number = {1 - 2 * (q.y * q.y + q.z * q.z),
                2 * (q.x * q.y + q.w * q.z),
                2 * (q.x * q.z - q.w * q.y),
                0,
                2 * (q.x * q.y - q.w * q.z),
                1 - 2 * (q.x * q.x + q.z * q.z),
                2 * (q.y * q.z + q.w * q.x),
                0,
                2 * (q.x * q.z + q.w * q.y),
                2 * (q.y * q.z - q.w * q.x),
                1 - 2 * (q.x * q.x + q.y * q.y),
                0,
                p.x,
                p.y,
                p.z,
                1};
    return m;
}

/// The ball that the device's description states, as a box: low x, y, z, high x, y, z.
Values workspace(const DeviceDescription& device) {
    const double r = mm * device.workspace_radius;
    Values box;
    box.count = 6;
    box.number = {-r, -r, -r, r, r, r};
    return box;
}

/// Of a moment: the present frame, or the one before. None: it is no such name.
std::optional<Values> of_frame(HDenum name, const Frame& frame, const DeviceDescription& device) {
    const HandReport& r = frame.report;
    switch (name) {
        case HD_CURRENT_BUTTONS:
            return Values(static_cast<double>(r.buttons));
        case HD_CURRENT_SAFETY_SWITCH:
            return Values(r.state != DeviceState::disconnected && r.state != DeviceState::fault ? 1.0 : 0.0);
        case HD_CURRENT_INKWELL_SWITCH:
            return Values(0.0);  // none is known: the pen is not in one
        case HD_CURRENT_POSITION:
            return Values(axes.position(r.position));
        case HD_CURRENT_VELOCITY:
            return Values(axes.position(r.velocity));
        case HD_CURRENT_ANGULAR_VELOCITY:
            return Values(axes.axial(r.angular_velocity));
        case HD_CURRENT_TRANSFORM:
            return transform(r);
        case HD_CURRENT_JOINT_ANGLES:
            return Values(Vec3{r.joints[0], r.joints[1], r.joints[2]});
        case HD_CURRENT_GIMBAL_ANGLES:
            return device.senses_orientation ? Values(Vec3{r.joints[3], r.joints[4], r.joints[5]})
                                             : Values(Vec3{});
        case HD_CURRENT_FORCE:
            return Values(frame.force);
        case HD_CURRENT_TORQUE:
            return Values(frame.torque);
        default:
            return std::nullopt;
    }
}

/// The name of the same in the present frame, of one that means the frame before; else 0.
HDenum present(HDenum last) {
    switch (last) {
        case HD_LAST_FORCE:
            return HD_CURRENT_FORCE;
        case HD_LAST_TORQUE:
            return HD_CURRENT_TORQUE;
        default:
            break;
    }
    constexpr HDenum apart = HD_LAST_BUTTONS - HD_CURRENT_BUTTONS;
    return last >= HD_LAST_BUTTONS && last <= HD_LAST_GIMBAL_ANGLES ? last - apart : 0;
}

/// Of the device itself. None: it is no such name.
std::optional<Values> of_device(HDenum name, const Device& device) {
    const DeviceDescription& d = device.hand.device();
    switch (name) {
        case HD_DEVICE_FIRMWARE_VERSION:
            return Values(0.0);
        case HD_MAX_WORKSPACE_DIMENSIONS:
        case HD_USABLE_WORKSPACE_DIMENSIONS:
            return workspace(d);
        case HD_TABLETOP_OFFSET:
            return Values(-mm * d.workspace_radius);
        case HD_INPUT_DOF:
            return Values(d.senses_orientation ? 6.0 : 3.0);
        case HD_OUTPUT_DOF:
            return Values(d.renders_torque ? 6.0 : 3.0);
        case HD_CALIBRATION_STYLE:
            return Values(double{HD_CALIBRATION_AUTO});
        case HD_UPDATE_RATE:
            return Values(d.rate);
        case HD_INSTANTANEOUS_UPDATE_RATE:
            return Values(device.hand.rate() > 0 ? device.hand.rate() : d.rate);
        case HD_NOMINAL_MAX_STIFFNESS:
            return Values(per_mm * d.max_stiffness);
        case HD_NOMINAL_MAX_DAMPING:
            return Values(per_mm * device.hand.limits().damping);
        case HD_NOMINAL_MAX_FORCE:
        case HD_NOMINAL_MAX_CONTINUOUS_FORCE:
            return Values(d.peak_force);  // the servo's supervisor watches the heat
        case HD_NOMINAL_MAX_TORQUE_FORCE:
        case HD_NOMINAL_MAX_TORQUE_CONTINUOUS_FORCE:
            return Values(d.renders_torque ? millinewton * d.peak_torque : 0.0);
        case HD_SOFTWARE_VELOCITY_LIMIT:
            return Values(device.velocity_limit);
        case HD_SOFTWARE_FORCE_IMPULSE_LIMIT:
            return Values(device.impulse_limit);
        case HD_FORCE_RAMPING_RATE:
            return Values(device.ramping_rate);
        default:
            return std::nullopt;
    }
}

/// Known to the interface; unknown here: encoders, pinch, Jacobians, motors.
bool is_absent(HDenum name) {
    constexpr HDenum absent[] = {HD_CURRENT_ENCODER_VALUES,    HD_LAST_ENCODER_VALUES,
                                 HD_CURRENT_PINCH_VALUE,       HD_LAST_PINCH_VALUE,
                                 HD_CURRENT_JACOBIAN,          HD_LAST_JACOBIAN,
                                 HD_MOTOR_TEMPERATURE,         HD_JOINT_ANGLE_REFERENCES,
                                 HD_CURRENT_JOINT_TORQUE,      HD_CURRENT_GIMBAL_TORQUE,
                                 HD_LAST_JOINT_TORQUE,         HD_LAST_GIMBAL_TORQUE,
                                 HD_USER_STATUS_LIGHT,         HD_NOMINAL_MAX_TORQUE_STIFFNESS,
                                 HD_NOMINAL_MAX_TORQUE_DAMPING};
    return std::find(std::begin(absent), std::end(absent), name) != std::end(absent);
}

std::string text_of(HDenum name) {
    constexpr std::size_t room = 16;
    char text[room];
    std::snprintf(text, room, "0x%04X", name);
    return text;
}

Values read(HDenum name) {
    const auto device = current();
    const std::lock_guard lock(device->mutex);
    const DeviceDescription& about = device->hand.device();
    // Before its first frame a program reads what is now.
    if (!device->any_frame)
        if (const auto newest = device->hand.newest()) device->now.report = *newest;
    std::optional<Values> found = of_frame(name, device->now, about);
    if (!found) found = of_frame(present(name), device->last, about);
    if (!found) found = of_device(name, *device);
    if (found) return *found;
    if (!is_absent(name)) throw Refused{HD_INVALID_ENUM};
    say_once("hdGet...v(" + text_of(name) + ") is not available");
    throw Refused{HD_INVALID_OPERATION};
}

/// As the type that the program asks for; a number that does not fit becomes the nearest that does.
template <class T>
T as(double value) {
    if constexpr (std::is_same_v<T, HDboolean>) {
        return value != 0 ? 1 : 0;
    } else if constexpr (std::is_integral_v<T>) {
        if (std::isnan(value)) return 0;
        // The largest long is no double: the power of two above it is the first that does not fit.
        const double beyond = std::ldexp(1.0, std::numeric_limits<T>::digits);
        if (value >= beyond) return std::numeric_limits<T>::max();
        if (value < -beyond) return std::numeric_limits<T>::min();
        return static_cast<T>(value);
    } else {
        return static_cast<T>(value);
    }
}

template <class T>
void get(HDenum name, T* out) {
    call([=] {
        if (out == nullptr) throw Refused{HD_INVALID_VALUE};
        const Values values = read(name);
        for (std::size_t i = 0; i < values.count; ++i) out[i] = as<T>(values.number[i]);
    });
}

template <class T>
void set(HDenum name, const T* in) {
    call([=] {
        if (in == nullptr) throw Refused{HD_INVALID_VALUE};
        const auto number = [in](std::size_t i) {
            const auto value = static_cast<double>(in[i]);
            if (!std::isfinite(value)) throw Refused{HD_INVALID_VALUE};
            return value;
        };
        const auto device = current();
        const std::lock_guard lock(device->mutex);
        switch (name) {
            case HD_CURRENT_FORCE:
                device->now.force = {number(0), number(1), number(2)};
                device->now.commanded = true;
                break;
            case HD_CURRENT_TORQUE:
                device->now.torque = {number(0), number(1), number(2)};
                device->now.commanded = true;
                break;
            case HD_SOFTWARE_VELOCITY_LIMIT:
                device->velocity_limit = number(0);
                break;
            case HD_SOFTWARE_FORCE_IMPULSE_LIMIT:
                device->impulse_limit = number(0);
                break;
            case HD_FORCE_RAMPING_RATE:
                device->ramping_rate = number(0);
                break;
            default:
                if (!is_absent(name)) throw Refused{HD_INVALID_ENUM};
                say_once("hdSet...v(" + text_of(name) + ") is not available");
                throw Refused{HD_INVALID_OPERATION};
        }
    });
}

HDstring text(HDenum name) {
    // As long as the thread does not ask again.
    thread_local std::string said;
    switch (name) {
        case HD_VERSION:
            return "3.4 (Knurl " KNURL_VERSION ")";
        case HD_DEVICE_VENDOR:
            return "Knurl";
        case HD_DEVICE_DRIVER_VERSION:
            return KNURL_VERSION;
        case HD_DEVICE_MODEL_TYPE:
            said = current()->hand.device().profile;
            return said.c_str();
        case HD_DEVICE_SERIAL_NUMBER:
            said = current()->hand.device().serial;
            return said.c_str();
        default:
            throw Refused{HD_INVALID_ENUM};
    }
}

}  // namespace

}  // namespace knurl::lookalike::hd

using namespace knurl::lookalike::hd;

extern "C" {

void hdGetBooleanv(HDenum name, HDboolean* out) {
    get(name, out);
}
void hdGetIntegerv(HDenum name, HDint* out) {
    get(name, out);
}
void hdGetLongv(HDenum name, HDlong* out) {
    get(name, out);
}
void hdGetFloatv(HDenum name, HDfloat* out) {
    get(name, out);
}
void hdGetDoublev(HDenum name, HDdouble* out) {
    get(name, out);
}
HDstring hdGetString(HDenum name) {
    return call([=] { return text(name); }, HDstring{""});
}
void hdSetBooleanv(HDenum name, const HDboolean* in) {
    set(name, in);
}
void hdSetIntegerv(HDenum name, const HDint* in) {
    set(name, in);
}
void hdSetLongv(HDenum name, const HDlong* in) {
    set(name, in);
}
void hdSetFloatv(HDenum name, const HDfloat* in) {
    set(name, in);
}
void hdSetDoublev(HDenum name, const HDdouble* in) {
    set(name, in);
}

}  // extern "C"
