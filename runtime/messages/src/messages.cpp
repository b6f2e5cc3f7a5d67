#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include <knurl/messages/cdr.hpp>
#include <knurl/messages/channels.hpp>
#include <knurl/messages/markers.hpp>
#include <knurl/messages/messages.hpp>

namespace knurl::messages {

namespace {

void put_stamp(CdrWriter& to, std::int64_t ns) {
    constexpr std::int64_t second = 1'000'000'000;
    // ROS counts nanoseconds upwards from the second before, also before 1970.
    const std::int64_t below = ((ns % second) + second) % second;
    to.put(static_cast<std::int32_t>((ns - below) / second));
    to.put(static_cast<std::uint32_t>(below));
}
void put_header(CdrWriter& to, std::int64_t stamp_ns, std::string_view frame) {
    put_stamp(to, stamp_ns);
    to.text(frame);
}
void put(CdrWriter& to, const Vec3& v) {
    to.put(v.x);
    to.put(v.y);
    to.put(v.z);
}
/// ROS has the scalar part last.
void put(CdrWriter& to, const Quat& q) {
    to.put(q.x);
    to.put(q.y);
    to.put(q.z);
    to.put(q.w);
}
void put(CdrWriter& to, const Colour& c) {
    to.put(c.r);
    to.put(c.g);
    to.put(c.b);
    to.put(c.a);
}

}  // namespace

// CDR aligns each field to its size and packs them in order, as the compiler does. So a report's bytes are
// its encoding.
static_assert(sizeof(Report) == 47 * 8 && offsetof(Report, joints) == 4 * 8 &&
              offsetof(Report, position) == 12 * 8 && offsetof(Report, velocity) == 19 * 8 &&
              offsetof(Report, state) == 43 * 8 && offsetof(Report, late_count) == 45 * 8 &&
              offsetof(Report, touches) == 46 * 8 + 4);

Bytes report_message(const Report& report) {
    CdrWriter to;
    to.raw(std::as_bytes(std::span(&report, 1)));
    return to.take();
}

Bytes pose_message(std::string_view device, std::int64_t stamp_ns, const Report& report) {
    CdrWriter to;
    put_header(to, stamp_ns, base_frame(device));
    put(to, report.position);
    put(to, report.orientation);
    return to.take();
}

Bytes wrench_message(std::string_view device, std::int64_t stamp_ns, const Report& report) {
    CdrWriter to;
    put_header(to, stamp_ns, base_frame(device));
    put(to, report.sent_force);
    put(to, report.sent_torque);
    return to.take();
}

Bytes twist_message(std::string_view device, std::int64_t stamp_ns, const Report& report) {
    CdrWriter to;
    put_header(to, stamp_ns, base_frame(device));
    put(to, report.velocity);
    put(to, report.angular_velocity);
    return to.take();
}

Bytes joints_message(std::string_view device, std::int64_t stamp_ns, const Report& report,
                     std::uint32_t joints) {
    const std::size_t n = std::min<std::size_t>(joints, report.joints.size());
    CdrWriter to;
    put_header(to, stamp_ns, base_frame(device));
    to.count(n);
    for (std::size_t i = 0; i < n; ++i) to.text(fmt::format("{}_joint{}", ros_name(device), i + 1));
    to.count(n);
    for (std::size_t i = 0; i < n; ++i) to.put(report.joints[i]);
    to.count(0);  // velocities and efforts are not reported
    to.count(0);
    return to.take();
}

Bytes joy_message(std::string_view device, std::int64_t stamp_ns, const Report& report) {
    constexpr std::uint32_t buttons = 32;
    CdrWriter to;
    put_header(to, stamp_ns, base_frame(device));
    to.count(0);
    to.count(buttons);
    for (std::uint32_t i = 0; i < buttons; ++i) to.put(static_cast<std::int32_t>(report.buttons >> i & 1u));
    return to.take();
}

Bytes transforms_message(std::span<const HandTransform> transforms) {
    CdrWriter to;
    to.count(transforms.size());
    for (const HandTransform& one : transforms) {
        put_header(to, one.stamp_ns, base_frame(one.device));
        to.text(hand_frame(one.device));
        put(to, one.report->position);
        put(to, one.report->orientation);
    }
    return to.take();
}

Bytes diagnostics_message(std::int64_t stamp_ns, std::span<const Diagnostic> diagnostics) {
    CdrWriter to;
    put_header(to, stamp_ns, "");
    to.count(diagnostics.size());
    for (const Diagnostic& one : diagnostics) {
        to.put(static_cast<std::uint8_t>(one.level));
        to.text(one.name);
        to.text(one.message);
        to.text(one.hardware_id);
        to.count(one.values.size());
        for (const auto& [key, value] : one.values) {
            to.text(key);
            to.text(value);
        }
    }
    return to.take();
}

Bytes markers_message(std::string_view frame, std::int64_t stamp_ns, std::span<const Marker> markers) {
    CdrWriter to;
    to.count(markers.size());
    for (const Marker& one : markers) {
        put_header(to, stamp_ns, frame);
        to.text(one.ns);
        to.put(one.id);
        to.put(static_cast<std::int32_t>(one.type));
        to.put(static_cast<std::int32_t>(one.action));
        put(to, one.position);
        put(to, one.orientation);
        put(to, one.scale);
        put(to, one.colour);
        put_stamp(to, 0);  // lifetime: until it is deleted
        to.put(false);     // frame_locked: the base does not move
        to.count(one.points.size());
        for (const Vec3& point : one.points) put(to, point);
        to.count(0);  // colours of points
        to.text("");  // texture_resource
        put_header(to, 0, "");
        to.text("");
        to.count(0);  // texture
        to.count(0);  // uv_coordinates
        to.text(one.text);
        to.text("");  // mesh_resource
        to.text("");
        to.count(0);  // mesh_file
        to.put(false);
    }
    return to.take();
}

}  // namespace knurl::messages
