#include "device_topics.hpp"

#include <algorithm>
#include <ctime>

#include <fmt/format.h>

#include <knurl/messages/channels.hpp>

#include "wire_text.hpp"

namespace knurl::dds {

namespace {

constexpr std::chrono::milliseconds look_again{100};

std::int64_t now_of(clockid_t clock) {
    timespec now{};
    ::clock_gettime(clock, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

geometry_msgs_msg_dds__Vector3_ vector(const Vec3& v) {
    return {.x = v.x, .y = v.y, .z = v.z};
}
geometry_msgs_msg_dds__Point_ point(const Vec3& v) {
    return {.x = v.x, .y = v.y, .z = v.z};
}
geometry_msgs_msg_dds__Quaternion_ quaternion(const Quat& q) {
    return {.x = q.x, .y = q.y, .z = q.z, .w = q.w};
}

}  // namespace

const std::map<std::string, double>& default_rates() {
    static const std::map<std::string, double> rates{
        {"measured_cp", 1000},   {"setpoint_cp", 1000}, {"measured_cv", 1000},
        {"measured_cf", 1000},   {"measured_js", 250},  {"joy", 50},
        {"operating_state", 10}, {"tf", 100},           {"diagnostics", 1}};
    return rates;
}

std::string dds_topic(const RobotOptions& options, const std::string& topic) {
    if (const auto found = options.remap.find(topic); found != options.remap.end())
        return "rt" + (found->second.starts_with('/') ? found->second : "/" + found->second);
    return "rt/" + (options.name_space.empty() ? topic : options.name_space + "/" + topic);
}

DeviceTopics::DeviceTopics(Domain& domain, const RobotOptions& options, const std::string& device,
                           std::uint32_t joints)
    : base_(messages::base_frame(device)),
      tip_(messages::hand_frame(device)),
      joints_(std::min<std::uint32_t>(joints, 8)) {
    for (std::uint32_t i = 0; i < joints_; ++i)
        joint_names_.push_back(fmt::format("{}_joint{}", messages::ros_name(device), i + 1));
    const std::string prefix = messages::ros_name(device) + "/";
    add(domain, options, prefix + "measured_cp", "geometry_msgs/msg/PoseStamped",
        geometry_msgs_msg_dds__PoseStamped__desc, &DeviceTopics::pose);
    add(domain, options, prefix + "setpoint_cp", "geometry_msgs/msg/PoseStamped",
        geometry_msgs_msg_dds__PoseStamped__desc, &DeviceTopics::setpoint);
    add(domain, options, prefix + "measured_cv", "geometry_msgs/msg/TwistStamped",
        geometry_msgs_msg_dds__TwistStamped__desc, &DeviceTopics::twist);
    add(domain, options, prefix + "measured_cf", "geometry_msgs/msg/WrenchStamped",
        geometry_msgs_msg_dds__WrenchStamped__desc, &DeviceTopics::wrench);
    if (joints_ > 0)
        add(domain, options, prefix + "measured_js", "sensor_msgs/msg/JointState",
            sensor_msgs_msg_dds__JointState__desc, &DeviceTopics::joints);
    add(domain, options, prefix + "joy", "sensor_msgs/msg/Joy", sensor_msgs_msg_dds__Joy__desc,
        &DeviceTopics::joy);
    add(domain, options, prefix + "operating_state", "crtk_msgs/msg/OperatingState",
        crtk_msgs_msg_dds__OperatingState__desc, &DeviceTopics::state);
    add(domain, options, "tf", "tf2_msgs/msg/TFMessage", tf2_msgs_msg_dds__TFMessage__desc,
        &DeviceTopics::transform, false);
}

void DeviceTopics::add(Domain& domain, const RobotOptions& options, const std::string& name,
                       const char* message, const dds_topic_descriptor_t& type,
                       void (DeviceTopics::*write)(const Entity&, const Report&), bool of_device) {
    const std::string kind = name.substr(name.rfind('/') + 1);
    const auto said = options.rates.find(kind);
    const double rate = said == options.rates.end() ? default_rates().at(kind) : said->second;
    if (rate <= 0) return;
    // /tf is one for all namespaces.
    const std::string topic =
        of_device || options.remap.contains(name) ? dds_topic(options, name) : "rt/" + name;
    Topic made;
    made.write = write;
    made.rate = rate;
    made.writer = domain.writer(topic, type, {.message = message});
    made.interval = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate));
    topics_.push_back(std::move(made));
}

bool DeviceTopics::wanted(Time now) {
    if (now >= looked_ + look_again) {
        looked_ = now;
        for (Topic& topic : topics_) {
            dds_publication_matched_status_t status{};
            topic.read = dds_get_publication_matched_status(topic.writer.get(), &status) == DDS_RETCODE_OK &&
                         status.current_count > 0;
        }
    }
    return std::any_of(topics_.begin(), topics_.end(), [](const Topic& topic) { return topic.read; });
}

DeviceTopics::Time DeviceTopics::next_due() const {
    Time next = Time::max();
    for (const Topic& topic : topics_)
        if (topic.read) next = std::min(next, topic.due);
    return next;
}

double DeviceTopics::highest_rate() const {
    double rate = 0;
    for (const Topic& topic : topics_)
        if (topic.read) rate = std::max(rate, topic.rate);
    return rate;
}

void DeviceTopics::write(Time now, const Report& report, const std::string& state) {
    // The servo stamps by CLOCK_MONOTONIC; ROS wants the time of the day.
    stamp_ns_ = now_of(CLOCK_REALTIME) - (now_of(CLOCK_MONOTONIC) - report.read_ns);
    state_ = state;
    for (Topic& topic : topics_) {
        // A report comes a little before or behind the clock of this thread: half an interval early is due.
        if (!topic.read || now + topic.interval / 2 < topic.due) continue;
        topic.due = std::max(topic.due + topic.interval, now);
        (this->*topic.write)(topic.writer, report);
    }
}

std_msgs_msg_dds__Header_ DeviceTopics::header() {
    return {.stamp = {.sec = static_cast<std::int32_t>(stamp_ns_ / 1'000'000'000),
                      .nanosec = static_cast<std::uint32_t>(stamp_ns_ % 1'000'000'000)},
            .frame_id = text(base_)};
}

void DeviceTopics::pose(const Entity& writer, const Report& report) {
    const geometry_msgs_msg_dds__PoseStamped_ message{
        .header = header(),
        .pose = {.position = point(report.position), .orientation = quaternion(report.orientation)}};
    dds_write(writer.get(), &message);
}

void DeviceTopics::setpoint(const Entity& writer, const Report& report) {
    const geometry_msgs_msg_dds__PoseStamped_ message{
        .header = header(),
        .pose = {.position = point(report.contact_point), .orientation = quaternion(report.orientation)}};
    dds_write(writer.get(), &message);
}

void DeviceTopics::twist(const Entity& writer, const Report& report) {
    const geometry_msgs_msg_dds__TwistStamped_ message{
        .header = header(),
        .twist = {.linear = vector(report.velocity), .angular = vector(report.angular_velocity)}};
    dds_write(writer.get(), &message);
}

void DeviceTopics::wrench(const Entity& writer, const Report& report) {
    const geometry_msgs_msg_dds__WrenchStamped_ message{
        .header = header(),
        .wrench = {.force = vector(report.sent_force), .torque = vector(report.sent_torque)}};
    dds_write(writer.get(), &message);
}

void DeviceTopics::joints(const Entity& writer, const Report& report) {
    std::array<char*, 8> names{};
    std::array<double, 8> positions = report.joints;
    for (std::size_t i = 0; i < joints_; ++i) names[i] = text(joint_names_[i]);
    sensor_msgs_msg_dds__JointState_ message{};
    message.header = header();
    message.name._maximum = message.name._length = joints_;
    message.name._buffer = names.data();
    message.position._maximum = message.position._length = joints_;
    message.position._buffer = positions.data();
    dds_write(writer.get(), &message);
}

void DeviceTopics::joy(const Entity& writer, const Report& report) {
    std::array<std::int32_t, 32> buttons{};
    for (std::size_t i = 0; i < buttons.size(); ++i) buttons[i] = (report.buttons >> i & 1u) != 0 ? 1 : 0;
    sensor_msgs_msg_dds__Joy_ message{};
    message.header = header();
    message.buttons._maximum = message.buttons._length = buttons.size();
    message.buttons._buffer = buttons.data();
    dds_write(writer.get(), &message);
}

void DeviceTopics::state(const Entity& writer, const Report& report) {
    const crtk_msgs_msg_dds__OperatingState_ message{
        .header = header(),
        .state = text(state_),
        .is_homed = report.state != DeviceState::disconnected,
        .is_busy = report.state == DeviceState::ramp_up || report.state == DeviceState::ramp_down};
    dds_write(writer.get(), &message);
}

void DeviceTopics::transform(const Entity& writer, const Report& report) {
    geometry_msgs_msg_dds__TransformStamped_ one{
        .header = header(),
        .child_frame_id = text(tip_),
        .transform = {.translation = vector(report.position), .rotation = quaternion(report.orientation)}};
    tf2_msgs_msg_dds__TFMessage_ message{};
    message.transforms._maximum = message.transforms._length = 1;
    message.transforms._buffer = &one;
    dds_write(writer.get(), &message);
}

}  // namespace knurl::dds
