// Each message with its own definition, as an independent reader (and Foxglove's, where it is there) decodes it.

#include <bit>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/messages/channels.hpp>
#include <knurl/messages/markers.hpp>
#include <knurl/messages/messages.hpp>

#include "decoded.hpp"

namespace knurl::test {
namespace {

using namespace messages;

/// A report in which every number differs from every other.
Report distinct() {
    Report report;
    static_assert(sizeof report == 376);
    double next = 0.125;
    for (double& joint : report.joints) joint = next++;
    for (Vec3* v : {&report.position, &report.velocity, &report.slow_velocity, &report.angular_velocity,
                    &report.scene_force, &report.scene_torque, &report.sent_force, &report.sent_torque,
                    &report.contact_point})
        *v = {next++, next++, next++};
    report.orientation = {next++, next++, next++, next++};
    report.cycle = 1001;
    report.deadline_ns = 1002;
    report.read_ns = 1003;
    report.write_ns = 1004;
    report.state = DeviceState::ramp_up;
    report.faults = 1005;
    report.buttons = 0x80000005;
    report.flags = 1007;
    report.late_count = 1008;
    report.presses = 1009;
    report.touches = 1010;
    return report;
}

Json vector(const Vec3& v) {
    return {{"x", v.x}, {"y", v.y}, {"z", v.z}};
}
Json quaternion(const Quat& q) {
    return {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}};
}
constexpr std::int64_t stamp = 1'700'000'123'456'789'012;
Json header(const char* frame) {
    Json time = {{"sec", 1'700'000'123}, {"nanosec", 456'789'012}};
    return {{"stamp", std::move(time)}, {"frame_id", frame}};
}

struct Case {
    Encoded message;
    Json expected;
};

std::vector<Case> cases() {
    const Report r = distinct();
    std::vector<Case> all;
    const auto add = [&all](const Schema& schema, Bytes bytes, Json expected) {
        all.push_back({{schema, std::move(bytes)}, std::move(expected)});
    };
    add(pose_schema(), pose_message("my.right-1", stamp, r),
        {{"header", header("my_right_1_base")},
         {"pose", Json{{"position", vector(r.position)}, {"orientation", quaternion(r.orientation)}}}});
    add(wrench_schema(), wrench_message("right", stamp, r),
        {{"header", header("right_base")},
         {"wrench", Json{{"force", vector(r.sent_force)}, {"torque", vector(r.sent_torque)}}}});
    add(twist_schema(), twist_message("right", stamp, r),
        {{"header", header("right_base")},
         {"twist", Json{{"linear", vector(r.velocity)}, {"angular", vector(r.angular_velocity)}}}});
    Json names = Json::array({"right_joint1", "right_joint2", "right_joint3"});
    add(joints_schema(), joints_message("right", stamp, r, 3),
        {{"header", header("right_base")},
         {"name", std::move(names)},
         {"position", Json::array({r.joints[0], r.joints[1], r.joints[2]})},
         {"velocity", Json::array()},
         {"effort", Json::array()}});
    Json buttons = Json::array();
    for (int i = 0; i < 32; ++i) buttons.push_back(i == 0 || i == 2 || i == 31 ? 1 : 0);
    add(joy_schema(), joy_message("right", stamp, r),
        {{"header", header("right_base")}, {"axes", Json::array()}, {"buttons", std::move(buttons)}});
    const std::vector<HandTransform> transforms{{"right", stamp, &r}, {"l", stamp, &r}};
    Json list = Json::array();
    for (const std::string name : {"right", "l"})
        list.push_back({{"header", header((name + "_base").c_str())},
                        {"child_frame_id", name + "_hand"},
                        {"transform", Json{{"translation", vector(r.position)},
                                           {"rotation", quaternion(r.orientation)}}}});
    Json tree = Json::object();
    tree["transforms"] = std::move(list);
    add(transforms_schema(), transforms_message(transforms), std::move(tree));
    const std::vector<Diagnostic> diagnostics{{Diagnostic::warn,
                                               "knurl: right",
                                               "active; 3 cycles late",
                                               "sim",
                                               {{"rate (Hz)", "1000"}, {"late", ""}}},
                                              {Diagnostic::stale, "x", "", "", {}}};
    Json values = Json::array();
    values.push_back(Json{{"key", "rate (Hz)"}, {"value", "1000"}});
    values.push_back(Json{{"key", "late"}, {"value", ""}});
    Json status = Json::array();
    status.push_back({{"level", 1},
                      {"name", "knurl: right"},
                      {"message", "active; 3 cycles late"},
                      {"hardware_id", "sim"},
                      {"values", std::move(values)}});
    status.push_back(
        {{"level", 3}, {"name", "x"}, {"message", ""}, {"hardware_id", ""}, {"values", Json::array()}});
    add(diagnostics_schema(), diagnostics_message(stamp, diagnostics),
        {{"header", header("")}, {"status", std::move(status)}});
    // A report in the order of its definition.
    add(report_schema(), report_message(r),
        {{"cycle", r.cycle},
         {"deadline_ns", r.deadline_ns},
         {"read_ns", r.read_ns},
         {"write_ns", r.write_ns},
         {"joints", Json(std::vector<double>(r.joints.begin(), r.joints.end()))},
         {"position", vector(r.position)},
         {"orientation", quaternion(r.orientation)},
         {"velocity", vector(r.velocity)},
         {"slow_velocity", vector(r.slow_velocity)},
         {"angular_velocity", vector(r.angular_velocity)},
         {"scene_force", vector(r.scene_force)},
         {"scene_torque", vector(r.scene_torque)},
         {"sent_force", vector(r.sent_force)},
         {"sent_torque", vector(r.sent_torque)},
         {"contact_point", vector(r.contact_point)},
         {"state", 3},
         {"faults", r.faults},
         {"buttons", r.buttons},
         {"flags", r.flags},
         {"late_count", r.late_count},
         {"presses", r.presses},
         {"touches", r.touches}});
    return all;
}

std::vector<Encoded> encoded(const std::vector<Case>& cases) {
    std::vector<Encoded> all;
    for (const Case& one : cases) all.push_back(one.message);
    return all;
}

TEST(Messages, AreReadByTheirOwnDefinitions) {
    const std::vector<Case> all = cases();
    const Json read = decoded(encoded(all));
    ASSERT_EQ(read.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_EQ(read[i], all[i].expected) << all[i].message.schema.name;
}

TEST(Messages, AreReadByFoxglovesOwnReaders) {
    const std::vector<Case> all = cases();
    std::string why;
    const auto read = decoded_by_foxglove(encoded(all), why);
    if (!read) GTEST_SKIP() << why;
    ASSERT_EQ(read->size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_EQ((*read)[i], all[i].expected) << all[i].message.schema.name;
}

TEST(Messages, MarkersAreReadByTheirDefinition) {
    std::vector<Marker> markers(2);
    markers[0].ns = "claim 7";
    markers[0].id = 17;
    markers[0].type = Marker::triangle_list;
    markers[0].position = {1, 2, 3};
    markers[0].orientation = {0.5, -0.5, 0.5, -0.5};
    markers[0].scale = {4, 5, 6};
    markers[0].colour = {0.25F, 0.5F, 0.75F, 1};
    markers[0].points = {{7, 8, 9}, {10, 11, 12}, {13, 14, 15}};
    markers[0].text = "odd";  // so that what follows is not aligned by chance
    markers[1].action = Marker::erase;
    markers[1].id = 3;
    const std::vector<Encoded> message{{markers_schema(), markers_message("right_base", stamp, markers)}};
    std::vector<Json> found{decoded(message)};
    std::string why;
    if (auto theirs = decoded_by_foxglove(message, why)) found.push_back(*theirs);
    for (const Json& read : found) {
        const Json& list = read[0].at("markers");
        ASSERT_EQ(list.size(), 2u);
        const Json& one = list[0];
        EXPECT_EQ(one.at("header"), header("right_base"));
        EXPECT_EQ(one.at("ns"), "claim 7");
        EXPECT_EQ(one.at("id"), 17);
        EXPECT_EQ(one.at("type"), 11);
        EXPECT_EQ(one.at("action"), 0);
        EXPECT_EQ(one.at("pose").at("position"), vector({1, 2, 3}));
        EXPECT_EQ(one.at("pose").at("orientation"), quaternion(markers[0].orientation));
        EXPECT_EQ(one.at("scale"), vector({4, 5, 6}));
        EXPECT_EQ(one.at("color").at("b"), 0.75);
        ASSERT_EQ(one.at("points").size(), 3u);
        EXPECT_EQ(one.at("points")[2], vector({13, 14, 15}));
        EXPECT_EQ(one.at("text"), "odd");
        EXPECT_EQ(list[1].at("action"), 2);
        EXPECT_EQ(list[1].at("id"), 3);
    }
}

TEST(Messages, ATimeBefore1970CountsUpwards) {
    const std::vector<Encoded> message{{pose_schema(), pose_message("right", -1, Report{})}};
    const Json stamp_read = decoded(message)[0].at("header").at("stamp");
    EXPECT_EQ(stamp_read.at("sec"), -1);
    EXPECT_EQ(stamp_read.at("nanosec"), 999'999'999);
}

TEST(Messages, EachChannelIsInItsPlaceAndHasItsTopic) {
    ASSERT_EQ(channels().size(), channel_count);
    std::set<std::string> topics;
    for (std::size_t i = 0; i < channel_count; ++i) {
        EXPECT_EQ(static_cast<std::size_t>(channels()[i].channel), i);
        topics.insert(topic(channels()[i].channel, "right"));
    }
    EXPECT_EQ(topics, (std::set<std::string>{"/right/report", "/right/measured_cp", "/right/measured_cf",
                                             "/right/measured_cv", "/right/measured_js", "/right/joy",
                                             "/right/scene", "/right/parameters", "/tf", "/diagnostics"}));
    EXPECT_NO_THROW(Json::parse(parameters_schema().text));
}

}  // namespace
}  // namespace knurl::test
