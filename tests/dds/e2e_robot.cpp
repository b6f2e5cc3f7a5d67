// The robot side: a real servo, a real knurl-dds, and this test or a process beside it as the robot.

#include <sstream>

#include <knurl/dds/type_hash.hpp>
#include <knurl/protocol/servo_address.hpp>
#include <knurl/view/servo_view.hpp>

#include "e2e.hpp"
#include "knurl_msgs.h"
#include "ros_messages.h"

namespace {

using namespace knurl;
using namespace knurl::dds;
using namespace dds_test;
using client_test::ServoProcess;

/// What the device is sent, seen by another client.
struct Watch {
    Client client = client_test::connect_beside();
    Observer observer = client.observe();
    template <class Wanted>
    bool until(Wanted wanted) {
        return eventually([&] {
            const auto report = observer.latest();
            return report && wanted(*report);
        });
    }
};

EndpointOptions reliable(const char* message) {
    return {.message = message, .reliable = true, .depth = 10};
}

std::size_t clients_of_the_servo() {
    return view::ServoWatch(protocol::servo_address("default")).look().devices.at(0).clients.size();
}

TEST(DdsRobot, the_servo_has_no_client_while_nobody_reads_or_commands) {
    ServoProcess servo;
    DdsProgram program({"--command", "cartesian3"});
    const auto until = [&](std::size_t wanted) {
        return eventually([&] { return clients_of_the_servo() == wanted; });
    };
    Here here;
    {
        const Entity pose =
            here.domain.reader("rt/cartesian3/measured_cp", geometry_msgs_msg_dds__PoseStamped__desc,
                               reliable("geometry_msgs/msg/PoseStamped"));
        EXPECT_TRUE(until(1)) << "a reader";
    }
    EXPECT_TRUE(until(0)) << "no reader any more";
    {
        const Entity command =
            here.domain.writer("rt/cartesian3/servo_cf", geometry_msgs_msg_dds__WrenchStamped__desc,
                               {.message = "geometry_msgs/msg/WrenchStamped"});
        EXPECT_TRUE(until(1)) << "one who may command";
    }
    EXPECT_TRUE(until(0)) << "nobody any more";
}

TEST(DdsRobot, what_the_hand_does_is_written_as_ros_names_it) {
    ServoProcess servo;
    DdsProgram program;
    Here here;
    const Entity pose =
        here.domain.reader("rt/cartesian3/measured_cp", geometry_msgs_msg_dds__PoseStamped__desc,
                           reliable("geometry_msgs/msg/PoseStamped"));
    const Entity twist =
        here.domain.reader("rt/cartesian3/measured_cv", geometry_msgs_msg_dds__TwistStamped__desc,
                           reliable("geometry_msgs/msg/TwistStamped"));
    const Entity wrench =
        here.domain.reader("rt/cartesian3/measured_cf", geometry_msgs_msg_dds__WrenchStamped__desc,
                           reliable("geometry_msgs/msg/WrenchStamped"));
    const Entity joints =
        here.domain.reader("rt/cartesian3/measured_js", sensor_msgs_msg_dds__JointState__desc,
                           reliable("sensor_msgs/msg/JointState"));
    const Entity state =
        here.domain.reader("rt/cartesian3/operating_state", crtk_msgs_msg_dds__OperatingState__desc,
                           reliable("crtk_msgs/msg/OperatingState"));
    const Entity joy = here.domain.reader("rt/cartesian3/joy", sensor_msgs_msg_dds__Joy__desc,
                                          reliable("sensor_msgs/msg/Joy"));
    const Entity tf =
        here.domain.reader("rt/tf", tf2_msgs_msg_dds__TFMessage__desc, reliable("tf2_msgs/msg/TFMessage"));
    const Entity diagnostics =
        here.domain.reader("rt/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                           reliable("diagnostic_msgs/msg/DiagnosticArray"));

    Watch watch;
    const auto report = watch.observer.newest(10s);
    ASSERT_TRUE(report);
    EXPECT_TRUE(comes<geometry_msgs_msg_dds__PoseStamped_>(pose, [&](const auto& said) {
        EXPECT_STREQ(said.header.frame_id, "cartesian3_base");
        const double age = static_cast<double>(::time(nullptr) - said.header.stamp.sec);
        EXPECT_LT(std::abs(age), 30) << "the time of the day at the read";
        return std::abs(said.pose.position.x - report->position.x) < 1e-3 &&
               said.pose.orientation.w == report->orientation.w;
    }));
    EXPECT_TRUE(comes<geometry_msgs_msg_dds__TwistStamped_>(
        twist, [](const auto& said) { return std::abs(said.twist.linear.x) < 0.1; }));
    EXPECT_TRUE(comes<geometry_msgs_msg_dds__WrenchStamped_>(
        wrench, [](const auto& said) { return said.wrench.force.x == 0; }));
    EXPECT_TRUE(comes<sensor_msgs_msg_dds__JointState_>(joints, [](const auto& said) {
        return said.position._length == 3 && said.name._length == 3 &&
               std::string(said.name._buffer[0]) == "cartesian3_joint1";
    }));
    EXPECT_TRUE(comes<crtk_msgs_msg_dds__OperatingState_>(state, [](const auto& said) {
        EXPECT_STREQ(said.state, "DISABLED") << "nobody may command it";
        return said.is_homed;
    }));
    EXPECT_TRUE(
        comes<sensor_msgs_msg_dds__Joy_>(joy, [](const auto& said) { return said.buttons._length == 32; }));
    EXPECT_TRUE(comes<tf2_msgs_msg_dds__TFMessage_>(tf, [](const auto& said) {
        return said.transforms._length == 1 &&
               std::string(said.transforms._buffer[0].child_frame_id) == "cartesian3_hand";
    }));
    EXPECT_TRUE(comes<diagnostic_msgs_msg_dds__DiagnosticArray_>(diagnostics, [](const auto& said) {
        return said.status._length == 1 && std::string(said.status._buffer[0].message) == "idle";
    }));
}

TEST(DdsRobot, every_writer_says_the_hash_of_its_type) {
    ServoProcess servo;
    DdsProgram program({"--command", "cartesian3"});
    Here here;
    const Entity pose =
        here.domain.reader("rt/cartesian3/measured_cp", geometry_msgs_msg_dds__PoseStamped__desc,
                           reliable("geometry_msgs/msg/PoseStamped"));
    const Entity found(
        dds_create_reader(here.domain.participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
        "built-in");
    const Entity readers(
        dds_create_reader(here.domain.participant(), DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
        "built-in");
    std::set<std::string> topics;
    const auto look = [&](const Entity& reader) {
        const Taken<dds_builtintopic_endpoint_t, 100> taken(reader.get());
        for (std::size_t i = 0; i < taken.size(); ++i) {
            if (!taken.info(i).valid_data) continue;
            const std::string topic = taken[i].topic_name;
            if (!topic.starts_with("rt/")) continue;
            topics.insert(topic);
            void* data = nullptr;
            std::size_t size = 0;
            ASSERT_TRUE(dds_qget_userdata(taken[i].qos, &data, &size)) << topic;
            const auto hash = hash_in(std::string(static_cast<const char*>(data), size));
            dds_free(data);
            ASSERT_TRUE(hash) << topic;
            EXPECT_EQ(hash->size(), 71u) << topic;
        }
    };
    ASSERT_TRUE(eventually([&] {
        look(found);
        look(readers);
        return topics.contains("rt/cartesian3/measured_js") &&
               topics.contains("rt/cartesian3/representation/viscosity") &&
               topics.contains("rt/cartesian3/free");
    }));
}

TEST(DdsRobot, a_process_of_another_vendor_reads_and_commands) {
#ifndef KNURL_DDS_FAST_PEER
    GTEST_SKIP() << "Fast DDS is not installed (libfastrtps-dev)";
#else
    ServoProcess servo;
    DdsProgram program({"--command", "cartesian3"});
    const std::string domain = std::to_string(own_domain());
    Watch watch;
    Background reader({KNURL_DDS_FAST_PEER, domain, "read", "rt/cartesian3/measured_cp", "200"});
    const auto hand = watch.observer.newest(10s);
    ASSERT_TRUE(hand);
    EXPECT_TRUE(reader.says("frame cartesian3_base, position ")) << reader.said() << program.program().said();
    std::istringstream said(reader.said().substr(reader.said().find("position ") + 9));
    Vec3 place;
    said >> place.x >> place.y >> place.z;
    EXPECT_LT((to_eigen(place) - to_eigen(hand->position)).norm(), 1e-3);

    Background writer({KNURL_DDS_FAST_PEER, domain, "push", "rt/cartesian3/servo_cf", "0.4", "0", "0"});
    ASSERT_TRUE(watch.until([](const HandReport& r) { return std::abs(r.sent_force.x - 0.4) < 1e-9; }))
        << program.program().said();
    writer.end(SIGKILL);
    EXPECT_TRUE(watch.until([](const HandReport& r) { return r.sent_force == Vec3{}; }));
#endif
}

TEST(DdsRobot, a_writer_that_dies_ends_in_zero_force_by_a_ramp) {
    ServoProcess servo;
    DdsProgram program({"--command", "cartesian3"});
    const auto writer = peer({"push", "rt/cartesian3/servo_cf", "0.4", "0", "0", "200"});
    Watch watch;
    ASSERT_TRUE(watch.until([](const HandReport& r) {
        return client_test::is_active(r) && std::abs(r.sent_force.x - 0.4) < 1e-9;
    })) << program.program().said();
    while (watch.observer.next_report(0ns)) {
    }
    writer->end(SIGKILL);
    double last = 0.4;
    int between = 0;
    for (;;) {
        const auto report = watch.observer.next_report(10s);
        ASSERT_TRUE(report);
        EXPECT_LT(std::abs(report->sent_force.x - last), 0.4 * 0.06) << "of a fade over 50 cycles";
        last = report->sent_force.x;
        between += last > 0 && last < 0.4 ? 1 : 0;
        if (last == 0) break;
    }
    EXPECT_GT(between, 30);
}

TEST(DdsRobot, one_message_makes_a_wall_that_stands_while_its_node_lives) {
    ServoProcess servo;
    DdsProgram program({"--command", "cartesian3"});
    Watch watch;
    const Vec3 start = watch.observer.newest(10s)->position;
    auto node = peer({"wall", "rt/cartesian3/representation/plane", std::to_string(start.z + 0.005), "200"});
    ASSERT_TRUE(watch.until([](const HandReport& r) { return r.sent_force.z > 0.05; }));
    for (int i = 0; i < 1500; ++i) {
        const auto report = watch.observer.next_report(10s);
        ASSERT_TRUE(report);
        if (i > 200) {
            ASSERT_GT(report->sent_force.z, 0.02) << "nothing more is said, and it stands";
        }
    }
    node->end(SIGTERM);
    EXPECT_TRUE(watch.until([](const HandReport& r) { return r.sent_force == Vec3{}; }));
}

TEST(DdsRobot, a_device_that_the_configuration_does_not_name_cannot_be_commanded) {
    ServoProcess servo;
    DdsProgram program;
    Here here;
    const Entity pose =
        here.domain.reader("rt/cartesian3/measured_cp", geometry_msgs_msg_dds__PoseStamped__desc,
                           reliable("geometry_msgs/msg/PoseStamped"));
    const Entity force =
        here.domain.writer("rt/cartesian3/servo_cf", geometry_msgs_msg_dds__WrenchStamped__desc,
                           {.message = "geometry_msgs/msg/WrenchStamped"});
    ASSERT_TRUE(comes<geometry_msgs_msg_dds__PoseStamped_>(pose, [](const auto&) { return true; }));
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(force.get(), &status);
    EXPECT_EQ(status.total_count, 0u) << "nobody reads it";
}

TEST(DdsRobot, a_peer_of_another_type_hash_is_told_and_not_felt) {
    ServoProcess servo;
    DdsProgram program({"--command", "cartesian3"});
    Here here;
    const Entity force =
        here.domain.writer("rt/cartesian3/servo_cf", geometry_msgs_msg_dds__WrenchStamped__desc,
                           {.message = "geometry_msgs/msg/Wrench"});
    geometry_msgs_msg_dds__WrenchStamped_ message{};
    std::string frame;
    message.header.frame_id = frame.data();
    message.wrench.force.x = 0.4;
    std::jthread writer([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            dds_write(force.get(), &message);
            std::this_thread::sleep_for(5ms);  // the rate of its messages
        }
    });
    EXPECT_TRUE(program.program().says("build it with the same message definitions"))
        << program.program().said();
    writer.request_stop();
    writer.join();
    Watch watch;
    EXPECT_TRUE(watch.observer.newest(10s)->state == DeviceState::idle);
}

/// Seconds of CPU that a process has taken.
double cpu_of(pid_t pid) {
    std::istringstream rest(knurl::test::text_of_file("/proc/" + std::to_string(pid) + "/stat"));
    std::string word;
    double ticks = 0;
    for (int i = 0; i < 15 && rest >> word; ++i)
        if (i >= 13) ticks += std::stod(word);
    return ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

TEST(DdsRobot, nobody_reads_and_it_sleeps) {
    ServoProcess servo;
    DdsProgram program({"--command", "cartesian3"});
    Watch watch;
    const double before = cpu_of(program.program().pid());
    for (int i = 0; i < 2000; ++i)
        ASSERT_TRUE(watch.observer.next_report(10s));  // two seconds of the servo's
    EXPECT_LT(cpu_of(program.program().pid()) - before, 0.4)
        << "a thread that does not sleep takes two, or what is left of a CPU";
}

TEST(DdsRobot, it_finds_its_servo_again) {
    ServoProcess servo;
    DdsProgram program({"--command", "cartesian3"});
    const auto writer = peer({"push", "rt/cartesian3/servo_cf", "0.2", "0", "0", "200"});
    const auto felt = [](const HandReport& r) {
        return client_test::is_active(r) && std::abs(r.sent_force.x - 0.2) < 1e-9;
    };
    {
        Watch watch;
        ASSERT_TRUE(watch.until(felt));
    }
    servo.end(SIGKILL);
    servo.start();
    Watch watch;
    EXPECT_TRUE(watch.until(felt)) << program.program().said();
}

}  // namespace
