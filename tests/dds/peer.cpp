// knurl_dds_peer DOMAIN WHAT TOPIC ...: a process of a DDS domain, for tests. It prints "ready" when somebody reads or writes its
// topic, and goes on until it is killed.
//   push TOPIC X Y Z HZ      wrenches
//   wall TOPIC OFFSET K      one plane with normal z, and then nothing
//   pose TOPIC HZ            poses, stamped when they are written

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <thread>

#include <knurl/dds/domain.hpp>

#include "knurl_msgs.h"
#include "ros_messages.h"

namespace {

using namespace knurl::dds;

void wait_for_reader(const Entity& writer) {
    dds_publication_matched_status_t status{};
    while (dds_get_publication_matched_status(writer.get(), &status) == DDS_RETCODE_OK &&
           status.current_count == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::puts("ready");
    std::fflush(stdout);
}

void push(Domain& domain, char** words) {
    const Entity writer = domain.writer(words[0], geometry_msgs_msg_dds__WrenchStamped__desc,
                                        {.message = "geometry_msgs/msg/WrenchStamped"});
    wait_for_reader(writer);
    geometry_msgs_msg_dds__WrenchStamped_ message{};
    std::string frame;
    message.header.frame_id = frame.data();
    message.wrench.force = {.x = std::atof(words[1]), .y = std::atof(words[2]), .z = std::atof(words[3])};
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1 / std::atof(words[4])));
    for (auto next = std::chrono::steady_clock::now();; next += period) {
        std::this_thread::sleep_until(next);
        dds_write(writer.get(), &message);
    }
}

void wall(Domain& domain, char** words) {
    const Entity writer =
        domain.writer(words[0], knurl_msgs_msg_dds__Plane__desc, {.message = "knurl_msgs/msg/Plane"});
    wait_for_reader(writer);
    knurl_msgs_msg_dds__Plane_ message{};
    std::string frame, id = "floor";
    message.header.frame_id = frame.data();
    message.id = id.data();
    message.normal = {.x = 0, .y = 0, .z = 1};
    message.offset = std::atof(words[1]);
    message.stiffness = std::atof(words[2]);
    message.recovery = -1;
    dds_write(writer.get(), &message);
    for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
}

void pose(Domain& domain, char** words) {
    const Entity writer = domain.writer(words[0], geometry_msgs_msg_dds__PoseStamped__desc,
                                        {.message = "geometry_msgs/msg/PoseStamped"});
    std::puts("ready");
    std::fflush(stdout);
    geometry_msgs_msg_dds__PoseStamped_ message{};
    std::string frame = "cartesian3_base";
    message.header.frame_id = frame.data();
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1 / std::atof(words[1])));
    for (auto next = std::chrono::steady_clock::now();; next += period) {
        std::this_thread::sleep_until(next);
        timespec now{};
        ::clock_gettime(CLOCK_REALTIME, &now);
        message.header.stamp = {.sec = static_cast<std::int32_t>(now.tv_sec),
                                .nanosec = static_cast<std::uint32_t>(now.tv_nsec)};
        dds_write(writer.get(), &message);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 5) return 2;
    DomainOptions options;
    options.id = static_cast<std::uint32_t>(std::atoi(argv[1]));
    if (const char* interface = std::getenv("KNURL_DDS_INTERFACE")) options.interface = interface;
    options.log = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
    Domain domain(options);
    const std::string what = argv[2];
    if (what == "push" && argc == 8) push(domain, argv + 3);
    if (what == "wall" && argc == 6) wall(domain, argv + 3);
    if (what == "pose" && argc == 5) pose(domain, argv + 3);
    return 2;
}
