// Runs the blocks of the libraries' READMEs, with the declarations that they assume. See readme.py for the
// blocks.
#include <array>
#include <chrono>
#include <filesystem>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/serial_chain.hpp>
#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>
#include <knurl/geometry/proxy.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/reps/describe.hpp>
#include <knurl/reps/presets.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/servo/offline.hpp>
#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/triple_buffer.hpp>
#include <knurl/shm/waiter.hpp>

namespace {

using namespace knurl;
using namespace std::chrono_literals;

/// Converts to true the given number of times.
struct Times {
    int left;
    explicit operator bool() { return left-- > 0; }
};

const std::array<Point3, 3> vertices{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}};
const std::array<Triangle, 1> triangles{{{0, 1, 2}}};
const std::array<std::uint8_t, 1> materials{{0}};

TEST(Readme, Scene) {
    const Limits limits;
    const Probe hand{.position = {0, 0, -0.002}};
    const Plane plane{.normal = {0, 0, 1}, .stiffness = 500};
    const double dt = 1e-3;
    Times running{100};
    const auto tell = [](const std::string& line) { ADD_FAILURE() << line; };
    Wrench felt;
    const auto feel = [&](const Wrench& wrench) { felt = wrench; };
#include "scene.inc"
    EXPECT_GT(felt.force.z(), 500 * 0.002);  // the plane, and the part of the spring that has faded in
}

TEST(Readme, Material) {
#include "material.inc"
    EXPECT_EQ(floor.stiffness, preset("rubber")->stiffness);
}

TEST(Readme, MeshFollow) {
    const Eigen::Vector3d hand(0, 0, 0.003);
    const double radius = 0.005, stiffness = 1000;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
#include "mesh_follow.inc"
    EXPECT_NEAR(force.z(), 2, 1e-6);
}

TEST(Readme, HeightField) {
    const std::vector<float> heights(403 * 344, 0.01F);
#include "height_field.inc"
    EXPECT_EQ(field.faces(), 2U * 402 * 343);
}

TEST(Readme, MeshBuild) {
    const bool cancelled = false;
    std::uint64_t told = 0;
    const auto tell = [&](const MeshNotes& notes) { told = notes.triangles_given; };
#include "mesh_build.inc"
    EXPECT_EQ(told, 1U);
}

TEST(Readme, SerialArm) {
    using namespace knurl::drivers;
    constexpr double degrees = std::numbers::pi / 180;
    const std::array<double, 3> joints{};
    TipPose pose;
    Jacobian jacobian;
#include "serial_arm.inc"
    EXPECT_NEAR(pose.position.norm(), std::hypot(0.215, 0.170), 1e-9);
}

TEST(Readme, Offline) {
    const auto opened = drivers::open_device("sim:cartesian3");
    drivers::Device& device = *opened;
#include "offline.inc"
    EXPECT_EQ(&first, &second);
    ASSERT_EQ(hand.feedback().entries.size(), 1U);
}

/// This process's descriptor of the segment of that name.
int received(const std::string& name) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
        std::error_code gone;
        if (std::filesystem::read_symlink(entry, gone).string().starts_with("/memfd:" + name))
            return std::stoi(entry.path().filename());
    }
    return -1;
}

TEST(Readme, Rings) {
    using namespace knurl::shm;
    struct Report {
        std::uint64_t number = 7, rest[7] = {};
    } report;
    struct {
        operator int() const { return received("knurl-reports"); }
    } fd;
    constexpr std::size_t bytes = 64;
    Segment application = Segment::create("application", triple_bytes(bytes));
    triple_init(application.data());
    std::vector<TripleReader> clients;
    clients.emplace_back(application.data(), bytes);
    const std::uint64_t commands_done = 0;
    std::array<std::byte, bytes> batch{};
    WaiterFlag raised{};
    WaiterFlag* flag = &raised;
    const WakePair wake = make_wake_pair();
    const int wake_fd = wake.client.get();
    Waker waker;
    const std::array<WakeTarget, 1> sleepers{{{flag, wake.servo.get(), true}}};
    const auto use = [](const Report& read, std::uint64_t missed) {
        EXPECT_EQ(read.number, 7U);
        EXPECT_EQ(missed, 0U);
    };
#include "rings.inc"
    EXPECT_EQ(reader.published(), 1U);
}

}  // namespace
