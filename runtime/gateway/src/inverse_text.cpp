// The states of devices as text. They are written a thousand times a second and more, so no tree of values is made of
// them first.

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include <knurl/protocol/report_names.hpp>

#include "inverse_service.hpp"

namespace knurl::gateway {

void write_number(std::string& out, double value) {
    // JSON has neither infinity nor NaN, and a report should have none.
    fmt::format_to(std::back_inserter(out), "{}",
                   std::isfinite(value) && value != 0 ? value : 0.0);  // nor -0
}

namespace {

void write(std::string& out, std::string_view text) {
    out += text;
}

std::string quoted(std::string_view text) {
    return Json(text).dump();
}

void write_vector(std::string& out, const Vec3& v) {
    write(out, "{\"x\":");
    write_number(out, v.x);
    write(out, ",\"y\":");
    write_number(out, v.y);
    write(out, ",\"z\":");
    write_number(out, v.z);
    out += '}';
}

void write_quaternion(std::string& out, const Quat& q) {
    write(out, "{\"w\":");
    write_number(out, q.w);
    write(out, ",\"x\":");
    write_number(out, q.x);
    write(out, ",\"y\":");
    write_number(out, q.y);
    write(out, ",\"z\":");
    write_number(out, q.z);
    out += '}';
}

void write_angles(std::string& out, const double (&angles)[3]) {
    write(out, "{\"a0\":");
    write_number(out, angles[0]);
    write(out, ",\"a1\":");
    write_number(out, angles[1]);
    write(out, ",\"a2\":");
    write_number(out, angles[2]);
    out += '}';
}

void write_transform(std::string& out, const InverseTransform& transform) {
    write(out, "{\"position\":");
    write_vector(out, transform.position);
    write(out, ",\"rotation\":");
    write_quaternion(out, transform.rotation);
    write(out, ",\"scale\":");
    write_vector(out, transform.scale);
    out += '}';
}

std::string_view boolean(bool value) {
    return value ? "true" : "false";
}

void write_faults(std::string& out, std::uint32_t faults) {
    out += '[';
    bool first = true;
    for (const auto& name : protocol::fault_names) {
        if (!(faults & name.value)) continue;
        if (!std::exchange(first, false)) out += ',';
        out += '"';
        out += name.name;
        out += '"';
    }
    out += ']';
}

void write_config(std::string& out, const InverseLook& look) {
    const InverseDevice& device = look.device;
    const DeviceDescription& info = device.info;
    fmt::format_to(
        std::back_inserter(out),
        R"("config":{{"type":"inverse3","port":{},"device_info":{{"major_version":7,"minor_version":0,"id":"{}","device_type":4,"uuid":"{}"}},)"
        R"("handedness":"{}","gravity_compensation":{{"enabled":false,"scaling_factor":0}},"torque_scaling":{{"enabled":false}},)"
        R"("home_return":{{"enabled":false}},"preset":"defaults","basis":{{"permutation":"{}"}},"mount":)",
        quoted(info.address), device.id, device.id, look.handedness, look.permutation);
    write_transform(out, {});
    write(out, R"(,"filters":{"force_gate":{"gain":0},"damping":{"scalar":0}},"knurl":{"name":)");
    write(out, quoted(info.name));
    fmt::format_to(std::back_inserter(out), R"(,"profile":{},"serial":{},"rate":)", quoted(info.profile),
                   quoted(info.serial));
    write_number(out, info.rate);
    write(out, ",\"max_stiffness\":");
    write_number(out, info.max_stiffness);
    write(out, ",\"peak_force\":");
    write_number(out, info.peak_force);
    write(out, ",\"peak_torque\":");
    write_number(out, info.peak_torque);
    write(out, ",\"workspace\":{\"centre\":");
    write_vector(out, look.transform.point(look.axes.position(info.workspace_centre)));
    write(out, ",\"radius\":");
    write_number(out, info.workspace_radius);
    fmt::format_to(std::back_inserter(out),
                   R"(}},"renders_torque":{},"senses_orientation":{},"claimable":{},"lapse":)",
                   boolean(info.renders_torque), boolean(info.senses_orientation), boolean(look.claimable));
    write_number(out, std::chrono::duration<double>(look.lapse).count());
    write(out, "}},");
}

void write_state(std::string& out, const InverseLook& look, const Report& report) {
    const auto point = [&](const Vec3& v) { write_vector(out, look.transform.point(look.axes.position(v))); };
    write(out, "\"state\":{\"cursor_position\":");
    point(report.position);
    write(out, ",\"cursor_velocity\":");
    write_vector(out, look.transform.rate(look.axes.position(report.velocity)));
    write(out, ",\"current_cursor_force\":");
    write_vector(out, look.transform.force(look.axes.direction(report.sent_force)));
    write(out, ",\"current_cursor_position\":");
    point(report.position);
    const double angles[3] = {frames::degrees(report.joints[0]), frames::degrees(report.joints[1]),
                              frames::degrees(report.joints[2])};
    const double zero[3] = {};
    write(out, ",\"angular_position\":");
    write_angles(out, angles);
    write(out, ",\"angular_velocity\":");
    write_angles(out, zero);
    write(out, ",\"current_angular_torques\":");
    write_angles(out, zero);
    write(out, ",\"current_angular_position\":");
    write_angles(out, angles);
    write(out, ",\"body_orientation\":{\"w\":1,\"x\":0,\"y\":0,\"z\":0},\"control_domain\":\"cartesian\"");
    fmt::format_to(std::back_inserter(out), R"(,"control_mode":"{}","mode":"{}","transform":)",
                   look.control_mode, look.control_mode);
    write_transform(out, look.transform);
    fmt::format_to(std::back_inserter(out), R"(,"knurl":{{"cycle":{},"scene_force":)", report.cycle);
    write_vector(out, look.transform.force(look.axes.direction(report.scene_force)));
    fmt::format_to(std::back_inserter(out), R"(,"touching":{},"clamped":{})",
                   boolean(report.flags & report_flags::touching),
                   boolean(report.flags & report_flags::clamped));
    if (!look.peer.representations.empty()) {
        write(out, ",\"representations\":{");
        bool first = true;
        for (const auto& [name, feedback] : look.peer.representations) {
            if (!std::exchange(first, false)) out += ',';
            write(out, quoted(name));
            fmt::format_to(std::back_inserter(out), R"(:{{"touching":{},"force":)",
                           boolean(feedback.flags & 1));
            write_vector(out, look.axes.direction(feedback.force));
            write(out, ",\"stiffness\":");
            write_number(out, feedback.stiffness);
            out += '}';
        }
        out += '}';
    }
    write(out, "}},");
}

void write_status(std::string& out, const InverseLook& look, const Report& report) {
    const bool answers = look.device.connected && report.state != DeviceState::disconnected;
    const auto state = static_cast<std::size_t>(report.state);
    fmt::format_to(
        std::back_inserter(out),
        R"("status":{{"calibrated":{},"in_use":{},"power_supply":{},"ready":{},"started":{},"knurl":{{"state":"{}","faults":)",
        boolean(answers),
        boolean(report.state >= DeviceState::armed && report.state <= DeviceState::ramp_down),
        boolean(answers), boolean(answers && report.state != DeviceState::fault), boolean(answers),
        state < protocol::state_names.size() && look.device.connected ? protocol::state_names[state].name
                                                                      : "disconnected");
    write_faults(out, report.faults);
    fmt::format_to(std::back_inserter(out), R"(,"claimed":{},"armed":{},"late_cycles":{}}}}})",
                   boolean(look.peer.claimed), boolean(look.peer.armed), report.late_count);
}

void write_grip(std::string& out, const InverseLook& look, const Report& report, bool full) {
    fmt::format_to(std::back_inserter(out), R"({{"device_id":"{}",)", look.device.grip_id);
    if (full)
        fmt::format_to(
            std::back_inserter(out),
            R"("config":{{"type":"wireless_verse_grip","port":{},"major_version":1,"minor_version":0,"hardware_version":1,"knurl":{{"name":{},"inverse3":"{}"}}}},)",
            quoted(look.device.info.address), quoted(look.device.info.name), look.device.id);
    write(out, "\"state\":{\"orientation\":");
    const auto turned =
        to_eigen(look.transform.rotation) * to_eigen(look.axes.orientation(report.orientation));
    write_quaternion(out, to_plain(turned));
    const auto down = [&](int button) { return boolean(report.buttons >> button & 1); };
    fmt::format_to(
        std::back_inserter(out),
        R"(,"buttons":{{"a":{},"b":{},"c":{},"button_0":{},"button_1":{},"button_2":{},"button_3":{}}},"hall":0,"battery_level":1}},)",
        down(0), down(1), down(2), down(0), down(1), down(2), down(3));
    const bool answers = look.device.connected && report.state != DeviceState::disconnected;
    fmt::format_to(std::back_inserter(out), R"("status":{{"connected":{},"awake":{},"ready":{}}}}})",
                   boolean(answers), boolean(answers), boolean(answers));
}

}  // namespace

void write_devices(std::string& out, const std::vector<InverseLook>& looks, bool full) {
    static const Report none{};
    write(out, "\"inverse3\":[");
    bool first = true;
    for (const InverseLook& look : looks) {
        if (!std::exchange(first, false)) out += ',';
        const Report& report = look.device.report ? *look.device.report : none;
        fmt::format_to(std::back_inserter(out), R"({{"device_id":"{}",)", look.device.id);
        if (full) write_config(out, look);
        write_state(out, look, report);
        write_status(out, look, report);
        out += '}';
    }
    write(out, "],\"verse_grip\":[],\"wireless_verse_grip\":[");
    first = true;
    for (const InverseLook& look : looks) {
        if (!std::exchange(first, false)) out += ',';
        write_grip(out, look, look.device.report ? *look.device.report : none, full);
    }
    out += ']';
}

}  // namespace knurl::gateway
