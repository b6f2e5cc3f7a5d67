// The requirements for every device. Each registered driver has a line in `addresses`; a driver without one
// fails the test. conformance_bench.hpp has each far side.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <map>
#include <memory>
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <knurl/drivers/motion_device.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/sim_profile.hpp>

#include "allocations.hpp"
#include "conformance_bench.hpp"

namespace knurl::drivers {
namespace {

using usb_emulator::falcon_device;
using usb_emulator::millisecond;
using usb_emulator::wooden_device;

example::Board board;

struct Enrolled {
    std::vector<std::string> whats;  // of the addresses to open
    std::function<std::unique_ptr<Bench>()> bench;
};

/// Every driver of this build, including those of the tests.
std::map<std::string, Enrolled> addresses() {
    static const bool once = [] {
        drivers().push_back(example::slider_driver(board));
        shared_sim::enrol();
        return true;
    }();
    static_cast<void>(once);
    const auto all = []() -> UsbBench::Everything& { return UsbBench::everything(); };
    return {{"sim", {sim_profile_names(), [] { return std::make_unique<SimBench>(); }}},
            {"slider", {{"bench"}, [] { return std::make_unique<SliderBench>(board); }}},
            {"shared-sim", {{""}, [] { return std::make_unique<SharedSimBench>(); }}},
            {"falcon",
             {{"ONE"},
              [=] { return std::make_unique<UsbMotorBench>(falcon_device, all().falcon, "1-1", 4096); }}},
            {"wooden",
             {{"ONE"},
              [=] { return std::make_unique<UsbMotorBench>(wooden_device, all().wooden, "1-2", 3000); }}},
            {"dhd", {{",watchdog=0.03"}, [] { return std::make_unique<VendorBench>(12, 10e-6); }}},
            {"hd", {{""}, [] { return std::make_unique<VendorBench>(3.3, 0.0254 / 450); }}},
            {"spacemouse", {{""}, [] { return std::make_unique<SpaceMouseBench>(); }}}};
}

std::vector<std::string> everything() {
    std::vector<std::string> all = {"motion"};
    for (const auto& [scheme, enrolled] : addresses()) {
        for (const std::string& what : enrolled.whats) {
            all.push_back(scheme + ":" + what);
        }
    }
    return all;
}

/// A recording has neither motors nor a cable.
std::unique_ptr<Bench> bench_of(const std::string& address) {
    if (address == "motion") return std::make_unique<Bench>();
    return addresses().at(address.substr(0, address.find(':'))).bench();
}

std::unique_ptr<Device> open(const std::string& address) {
    if (address == "motion") {
        return std::make_unique<MotionDevice>(parse_motion("0,0,0,0\n1,0.1,0,0\n", "m"));
    }
    return open_device(address == "shared-sim:" ? SharedSimBench::address() : address);
}

class EveryDevice : public testing::TestWithParam<std::string> {
  protected:
    std::unique_ptr<Bench> bench_ = bench_of(GetParam());  // first: it plugs the device in
    std::unique_ptr<Device> device_ = open(GetParam());
    JointSample sample_;
    ReadStatus status_ = ReadStatus::stale;
    bool written_ = false;
    Nanoseconds now_ = 0;
    double largest_ = 0;  // share of its limit that any motor had

    void cycle(const JointEfforts& efforts, Nanoseconds period = millisecond) {
        status_ = device_->read(now_ += period, sample_);
        written_ = device_->write(now_, efforts);
        bench_->moment();
        largest_ = std::max(largest_, bench_->share(device_.get()));
    }
    /// Runs cycles until it is so; false if it never is.
    template <class Condition>
    bool until(const JointEfforts& efforts, Condition&& so, Nanoseconds period = millisecond) {
        constexpr int patience = 5000;
        for (int i = 0; i < patience; ++i) {
            cycle(efforts, period);
            if (so()) return true;
        }
        return false;
    }
    JointEfforts limits(double times) const {
        JointEfforts efforts{};
        for (std::size_t i = 0; i < device_->link().effort_limit.size(); ++i)
            efforts[i] = times * device_->link().effort_limit[i];
        return efforts;
    }

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

// A guardian is forked between opening and the first read: from a process whose threads are idle.
TEST_P(EveryDevice, IsSentNothingBeforeItIsReadAndNothingThatWasWrittenBefore) {
    if (!bench_->sleeps_until_read()) GTEST_SKIP() << "no thread of its own writes to it";
    bench_->share(device_.get());  // what came before
    const std::size_t before = bench_->packets();
    for (int i = 0; i < 50; ++i) {
        device_->write(now_ += millisecond, limits(1));
        bench_->moment();
    }
    EXPECT_EQ(bench_->packets(), before);
    EXPECT_EQ(bench_->share(device_.get()), 0);
    device_->read(now_ += millisecond, sample_);
    for (int i = 0; i < 50; ++i) bench_->moment();
    EXPECT_GT(bench_->packets(), before) << "now its thread is awake";
    EXPECT_EQ(bench_->share(device_.get()), 0) << "nobody knew where it was when that was written";
    EXPECT_TRUE(until(limits(0.5), [&] { return bench_->share(device_.get()) > 0.1; }));
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

TEST_P(EveryDevice, LimitsWhatItsMotorsGetWhateverIsWrittenAndForgetsWhatWasTooMuch) {
    if (!bench_->has_motors()) GTEST_SKIP() << "it has no motors";
    const unsigned seed = 20261122;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    constexpr double most = std::numeric_limits<double>::max();
    for (const double size : {most, -most, 1e300, -1e300, 1e9}) {
        JointEfforts efforts{};
        efforts.fill(size);
        for (int i = 0; i < 20; ++i) cycle(efforts);
    }
    for (int i = 0; i < 200; ++i) {
        JointEfforts efforts = limits(1);
        for (double& effort : efforts) effort *= std::uniform_real_distribution(-3.0, 3.0)(random);
        cycle(efforts);
    }
    EXPECT_TRUE(until(limits(-2), [&] { return largest_ > 0.95; })) << "and no less than it can";
    JointEfforts efforts{};
    efforts.fill(most);
    ASSERT_TRUE(until(efforts, [&] { return bench_->share(device_.get()) > 0.95; }));
    // 30 ms of the device's time, after which its filters have settled; then as long as the cable takes.
    for (int i = 0; i < 30; ++i) cycle(limits(0.02));
    EXPECT_TRUE(until(
        limits(0.02), [&] { return bench_->share(device_.get()) < 0.05; }, 0));
    EXPECT_LE(largest_, 1 + 1e-9);
}

TEST_P(EveryDevice, SaysThatItIsUnpluggedAndComesBack) {
    if (!bench_->has_cable()) GTEST_SKIP() << "it has no cable";
    ASSERT_TRUE(until(limits(0.1), [&] { return status_ == ReadStatus::ok; }));
    bench_->pull(*device_);
    ASSERT_TRUE(until(limits(0.1), [&] { return status_ == ReadStatus::unplugged; }));
    for (int i = 0; i < 20; ++i) {
        cycle(limits(0.1));
        EXPECT_EQ(status_, ReadStatus::unplugged);
        EXPECT_FALSE(written_);
    }
    bench_->plug_in_again(*device_);
    EXPECT_TRUE(until({}, [&] { return status_ == ReadStatus::ok && written_; }));
}

TEST_P(EveryDevice, LeavesItsMotorsAtZeroWhenItIsClosed) {
    if (!bench_->has_motors()) GTEST_SKIP() << "it has no motors";
    if (!bench_->outlives_its_device()) GTEST_SKIP() << "its motors end with it";
    ASSERT_TRUE(until(limits(0.5), [&] { return bench_->share(device_.get()) > 0.1; }));
    device_.reset();
    bench_->moment();
    bench_->share(nullptr);  // what came before
    EXPECT_EQ(bench_->share(nullptr), 0);
}

TEST_P(EveryDevice, NeverWaitsForItsOtherSideAndSellsNoOldSampleAsNew) {
    ASSERT_TRUE(until(limits(0.1), [&] { return status_ == ReadStatus::ok; }));
    const bool frozen = bench_->freeze(true);
    int fresh = 0;
    long slept = 0;  // voluntary context switches of the thread
    auto thousand = std::async(std::launch::async, [&] {
        const auto sleeps = [] {
            rusage use{};
            ::getrusage(RUSAGE_THREAD, &use);
            return use.ru_nvcsw;
        };
        slept = -sleeps();
        for (int i = 0; i < 1000; ++i) {
            fresh += device_->read(now_ += millisecond, sample_) == ReadStatus::ok ? 1 : 0;
            EXPECT_TRUE(device_->write(now_, limits(0.1)));
        }
        slept += sleeps();
    });
    const bool returned = thousand.wait_for(std::chrono::minutes(1)) == std::future_status::ready;
    bench_->freeze(false);
    thousand.wait();
    EXPECT_TRUE(returned) << "it waited until its other side went on";
    // The mock's own locks around system calls make it wait at times; a driver that waits does so in each
    // cycle.
    EXPECT_LT(slept, 100) << "of 1000 cycles";
    if (frozen && !bench_->may_be_silent()) {
        EXPECT_LE(fresh, 4) << "those that were on their way";
    }
    EXPECT_TRUE(until({}, [&] { return status_ == ReadStatus::ok; }));
}

// A sample has no time stamp: its time is that of the read that returned it. So none may be older than the
// one before.
TEST_P(EveryDevice, ShowsSamplesInTheOrderOfTheirTime) {
    if (!bench_->has_encoder()) GTEST_SKIP() << "nothing but its hand, or nothing at all, turns its joints";
    ASSERT_TRUE(until({}, [&] { return status_ == ReadStatus::ok; }));
    const double first = sample_.position[0];
    constexpr int turns = 300;
    double before = first;
    for (int i = 0; i < turns; ++i) {
        bench_->turn(1);
        cycle({});
        EXPECT_GE(sample_.position[0], before);
        before = sample_.position[0];
    }
    const double last = first + turns * device_->link().radians_per_count[0];
    EXPECT_TRUE(until({}, [&] { return std::abs(sample_.position[0] - last) < 1e-9; }));
    bench_->turn(-turns);
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
