// What every device must do, whatever it is. Each registered driver has a line in `addresses`; a driver
// without one fails the test.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/drivers/motion_device.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/sim_profile.hpp>

#include "allocations.hpp"
#include "example_device.hpp"
#include "falcon_bench.hpp"
#include "shared_sim.hpp"
#include "spacemouse_model.hpp"
#include "wooden_model.hpp"

namespace knurl::drivers {
namespace {

using usb_emulator::millisecond;

example::Board board;

/// What a shared-sim needs: a process that lives as long as the test.
std::string shared_address() {
    static const std::string path = shared_sim::file_in_memory("knurl-conformance");
    static const shared_sim::FakeDevice process(KNURL_FAKE_DEVICE, {.path = path, .capacity = 1 << 14});
    static const struct Remove {
        ~Remove() { std::filesystem::remove(path); }
    } remove;
    return process.address();
}

/// One of each on an emulated bus, plugged in before any of them is opened.
void plug_in_everything() {
    using namespace usb_emulator;
    static Bus bus;
    static const bool once = [] {
        bus.plug(falcon_at_centre(), {.port = "1-1", .serial = "FALCON01"});
        const auto wooden = std::make_shared<WoodenModel>();
        bus.plug(wooden, {.port = "1-2", .serial = "POLHEM1"});
        bus.locked([&] { wooden->counts = {0, 2171, 3011}; });  // in the middle of its workspace
        bus.plug(std::make_shared<SpaceMouseModel>(true), {.port = "1-3", .serial = ""});
        return true;
    }();
    static_cast<void>(once);
}

/// Every driver of this build, those of the tests as well; for each scheme what to open.
std::map<std::string, std::vector<std::string>> addresses() {
    static const bool once = [] {
        drivers().push_back(example::slider_driver(board));
        shared_sim::enrol();
        return true;
    }();
    static_cast<void>(once);
    return {{"sim", sim_profile_names()}, {"slider", {"bench"}},   {"shared-sim", {""}},
            {"falcon", {"FALCON01"}},     {"wooden", {"POLHEM1"}}, {"spacemouse", {""}}};
}

std::vector<std::string> everything() {
    std::vector<std::string> all = {"motion"};
    for (const auto& [scheme, whats] : addresses()) {
        for (const std::string& what : whats) {
            all.push_back(scheme + ":" + what);
        }
    }
    return all;
}

std::unique_ptr<Device> open(const std::string& address) {
    if (address == "motion") {
        return std::make_unique<MotionDevice>(parse_motion("0,0,0,0\n1,0.1,0,0\n", "m"));
    }
    plug_in_everything();
    return open_device(address == "shared-sim:" ? shared_address() : address);
}

class EveryDevice : public testing::TestWithParam<std::string> {
  protected:
    std::unique_ptr<Device> device_ = open(GetParam());
    JointSample sample_;

    std::span<const double> joints() const {
        return {sample_.position.data(), static_cast<std::size_t>(device_->link().sensed_joints)};
    }
};

TEST(Registry, EveryDriverIsInThisSuite) {
    const auto known = addresses();
    for (const Driver& driver : drivers()) {
        EXPECT_TRUE(known.contains(driver.scheme)) << driver.scheme << ": add it to addresses()";
        EXPECT_FALSE(driver.help.empty()) << driver.scheme;
        EXPECT_ANY_THROW(driver.open("no such thing", {})) << driver.scheme;
    }
}

TEST_P(EveryDevice, DescribesItself) {
    const LinkConfig& link = device_->link();
    EXPECT_FALSE(link.name.empty());
    EXPECT_FALSE(link.description.empty());
    EXPECT_GE(link.sensed_joints, 1);
    EXPECT_LE(link.sensed_joints, max_joints);
    EXPECT_GE(link.actuated_joints, 0);
    EXPECT_LE(link.actuated_joints, link.sensed_joints);
    EXPECT_EQ(device_->mechanism().joints(), link.sensed_joints);
    EXPECT_EQ(link.radians_per_count.size(), static_cast<std::size_t>(link.sensed_joints));
    EXPECT_EQ(link.effort_limit.size(), static_cast<std::size_t>(link.actuated_joints));
    EXPECT_GT(link.workspace_radius, 0);
    EXPECT_GT(link.nominal_rate, 0);
    EXPECT_GE(link.peak_force, link.continuous_force);
    EXPECT_EQ(link.has_watchdog, link.watchdog_time > 0);
    if (link.peak_force > 0) {
        EXPECT_GT(link.damping, 0) << "else no stiffness is safe";
        EXPECT_TRUE(std::ranges::all_of(link.effort_limit, [](double limit) { return limit > 0; }));
    }
}

TEST_P(EveryDevice, IsReadBeforeAnythingIsWrittenAndIsInItsWorkspace) {
    ASSERT_EQ(device_->read(0, sample_), ReadStatus::ok);
    EXPECT_TRUE(sample_.calibrated);
    TipPose pose;
    Jacobian jacobian;
    ASSERT_TRUE(device_->mechanism().forward(joints(), pose, jacobian));
    const auto& centre = device_->link().workspace_centre;
    EXPECT_LT((pose.position - Eigen::Vector3d(centre[0], centre[1], centre[2])).norm(),
              device_->link().workspace_radius);
    EXPECT_NEAR(pose.orientation.norm(), 1, 1e-14);
    EXPECT_TRUE(jacobian.allFinite());
    if (!device_->link().senses_orientation) {
        EXPECT_TRUE(pose.orientation.isApprox(Eigen::Quaterniond::Identity()));
    }
}

TEST_P(EveryDevice, StaysFiniteWhateverIsWritten) {
    const double bad[] = {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, -1e300, 5e-324};
    Nanoseconds now = 0;
    for (std::size_t cycle = 0; cycle < 200; ++cycle) {
        device_->read(now += millisecond, sample_);
        EXPECT_TRUE(std::ranges::all_of(joints(), [](double joint) { return std::isfinite(joint); }));
        JointEfforts efforts{};
        efforts.fill(bad[cycle % std::size(bad)]);
        EXPECT_TRUE(device_->write(now, efforts));
    }
    device_->write(now, {});
}

TEST_P(EveryDevice, BearsAClockThatStandsOrGoesBackOrLeaps) {
    for (const Nanoseconds now : {Nanoseconds{0}, Nanoseconds{0}, 5 * millisecond, 2 * millisecond,
                                  Nanoseconds{-7}, 3'600'000 * millisecond, 3'600'001 * millisecond}) {
        const ReadStatus status = device_->read(now, sample_);
        EXPECT_TRUE(status == ReadStatus::ok || status == ReadStatus::stale);
        EXPECT_TRUE(std::ranges::all_of(joints(), [](double joint) { return std::isfinite(joint); }));
        EXPECT_TRUE(device_->write(now, {}));
    }
}

TEST_P(EveryDevice, AllocatesNothingOnceItIsOpen) {
    TipPose pose;
    Jacobian jacobian;
    const std::uint64_t before = allocations();
    device_->notify(Notice::enabled);
    device_->notify(Notice::claim_active);
    for (Nanoseconds cycle = 0; cycle < 300; ++cycle) {
        device_->read(cycle * millisecond, sample_);
        device_->mechanism().forward(joints(), pose, jacobian);
        device_->write(cycle * millisecond, {0.01});
    }
    device_->write(300 * millisecond, {});
    device_->notify(Notice::disabled);
    device_->make_safe();
    EXPECT_EQ(allocations(), before);
}

TEST_P(EveryDevice, CanBeMadeSafeAtAnyTimeAndReadAfterwards) {
    device_->make_safe();
    device_->read(0, sample_);
    device_->write(0, {0.1});
    device_->make_safe();
    device_->make_safe();
    device_->read(millisecond, sample_);
    EXPECT_TRUE(std::ranges::all_of(joints(), [](double joint) { return std::isfinite(joint); }));
}

INSTANTIATE_TEST_SUITE_P(Drivers, EveryDevice, testing::ValuesIn(everything()), [](const auto& name) {
    std::string word = name.param;
    std::ranges::replace_if(
        word, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
    return word;
});

TEST(AllocationCounter, CountsNewAndMalloc) {
    const std::uint64_t before = allocations();
    void* volatile memory = std::malloc(3);
    std::free(memory);
    delete new int;  // NOLINT: counted even where the optimiser could drop it
    EXPECT_GE(allocations(), before + 1);
    EXPECT_NE(std::make_unique<std::string>(100, 'x'), nullptr);
    EXPECT_GE(allocations(), before + 3);
}

TEST(ExampleSlider, ClampsItsEffortAndLeavesItsMotorAtZero) {
    example::Board bench;
    {
        example::Slider slider(bench);
        bench.encoder = 1234;
        JointSample sample;
        EXPECT_EQ(slider.read(0, sample), ReadStatus::ok);
        EXPECT_NEAR(sample.position[0], 0.01234, 1e-15);
        EXPECT_TRUE(slider.write(0, {1}));
        EXPECT_EQ(bench.milliamps, 500);
        slider.write(0, {-99});
        EXPECT_EQ(bench.milliamps, -1500);
        slider.write(0, {std::nan("")});
        EXPECT_EQ(bench.milliamps, 0);
        slider.write(0, {1});
        bench.plugged = false;
        EXPECT_EQ(slider.read(0, sample), ReadStatus::unplugged);
        EXPECT_FALSE(slider.write(0, {1}));
    }
    EXPECT_EQ(bench.milliamps, 0);
}

}  // namespace
}  // namespace knurl::drivers
