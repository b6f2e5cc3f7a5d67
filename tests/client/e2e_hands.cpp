// Several hands on one servo: each has its own loop, claims and faults.

#include <algorithm>
#include <fstream>
#include <limits>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "../servo/probe_device.hpp"
#include "servo_process.hpp"

namespace {

using namespace knurl;
using namespace client_test;

/// A file that is removed at the end of the test.
class File {
  public:
    explicit File(const std::string& text) {
        const int fd = ::mkstemp(path_.data());
        if (fd < 0 || ::write(fd, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
            throw std::runtime_error("no file for the test");
        ::close(fd);
    }
    ~File() { ::unlink(path_.c_str()); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    const std::string& path() const { return path_; }

  private:
    std::string path_ = (std::filesystem::temp_directory_path() / "knurl-hands-XXXXXX").string();
};

/// Pushes along x with this force (N), also while its application is silent.
void push(Claim& hand, double force) {
    hand.add(at_once({force, 0, 0}), {.on_silence = OnSilence::hold});
    hand.arm();
}
/// Waits until the whole force is sent.
void feel(Claim& hand, double force) {
    read_until(hand, [&](const HandReport& report) {
        return is_active(report) && std::abs(report.sent_force.x - force) < 1e-9;
    });
}

/// The report that many cycles after the newest.
HandReport after(Claim& hand, std::uint64_t cycles) {
    while (!hand.latest()) hand.commit();
    const std::uint64_t now = hand.latest()->cycle;
    return read_until(hand, [&](const HandReport& report) { return report.cycle > now + cycles; });
}

/// Nanoseconds between the deadlines of neighbouring cycles: the minimum of 50. A stall of the machine makes
/// some longer, none shorter.
std::int64_t period_of(Claim& hand) {
    HandReport last = read_until(hand, is_active);
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (int pairs = 0; pairs < 50;) {
        const HandReport next = read_until(hand, [&](const HandReport& r) { return r.cycle > last.cycle; });
        if (next.cycle == last.cycle + 1) {
            least = std::min(least, next.deadline_ns - last.deadline_ns);
            ++pairs;
        }
        last = next;
    }
    return least;
}

TEST(Hands, two_of_one_application_feel_each_its_own_at_its_own_rate) {
    const File config(R"(
[[device]]
name = "left"
address = "sim:cartesian3"
[[device]]
name = "right"
address = "sim:premium15"
rate = 2000
)");
    ServoProcess servo({"--config", config.path()});
    Client client = connect();
    Claim left = client.claim("left"), right = client.claim("right");
    EXPECT_EQ(left.device().rate, 1000);
    EXPECT_EQ(right.device().rate, 2000);
    EXPECT_EQ(right.device().profile, "premium15");
    push(left, 0.25);
    push(right, -0.5);
    feel(left, 0.25);
    feel(right, -0.5);
    EXPECT_NEAR(after(left, 0).sent_force.x, 0.25, 1e-9);
    EXPECT_EQ(period_of(left), 1'000'000);
    EXPECT_EQ(period_of(right), 500'000);
}

TEST(Hands, one_of_each_of_two_servos_and_one_of_these_ends) {
    ServoProcess first({"--device", "hand=sim:cartesian3"});
    Client to_first = connect();
    Claim left = to_first.claim("hand");
    push(left, 0.25);
    {
        ServoProcess second({"--device", "hand=sim:premium15", "--rate", "500"});
        Client to_second = connect();
        Claim right = to_second.claim("hand");
        EXPECT_NE(to_first.servo_pid(), to_second.servo_pid());
        EXPECT_EQ(right.device().rate, 500);
        push(right, -0.5);
        feel(left, 0.25);
        feel(right, -0.5);
        second.end(SIGKILL);
        EXPECT_TRUE(eventually([&] { return !right.connected(); }));
        const HandReport later = after(left, 200);
        EXPECT_EQ(later.state, DeviceState::active);
        EXPECT_NEAR(later.sent_force.x, 0.25, 1e-9);
    }
}

/// A force on a probe at the end of a lever.
struct OnALever {
    Vec3 lever{0.01, 0.02, 0.015}, force{0, 0, 0.5};  // m in the hand's frame, N
    void add(Claim& hand) const {
        hand.place_probe(1, {.offset = lever});
        hand.add(at_once(force), {.probe = 1, .on_silence = OnSilence::hold});
        hand.arm();
    }
    HandReport felt(Claim& hand) const {
        return read_until(hand, [&](const HandReport& report) {
            return is_active(report) && std::abs(report.sent_force.z - force.z) < 1e-9;
        });
    }
};

TEST(Hands, that_render_torque_say_so_and_are_sent_the_levers) {
    ServoProcess servo({"--device", "sim:generic6"});
    Client client = connect();
    Claim hand = client.claim();
    EXPECT_TRUE(hand.device().renders_torque);
    EXPECT_TRUE(hand.device().senses_orientation);
    EXPECT_GT(hand.device().peak_torque, 0);
    const OnALever lever;
    lever.add(hand);
    const HandReport report = lever.felt(hand);
    const Eigen::Vector3d expected =
        (to_eigen(report.orientation) * to_eigen(lever.lever)).cross(to_eigen(report.sent_force));
    ASSERT_GT(expected.norm(), 1e-3);
    EXPECT_NEAR((to_eigen(report.sent_torque) - expected).norm(), 0, 1e-9)
        << to_eigen(report.sent_torque).transpose() << " against " << expected.transpose();
}

TEST(Hands, without_torque_say_so_and_are_sent_the_force_alone) {
    ServoProcess servo({"--device", "sim:premium15"});
    Client client = connect();
    Claim hand = client.claim();
    EXPECT_FALSE(hand.device().renders_torque);
    EXPECT_FALSE(hand.device().senses_orientation);
    EXPECT_EQ(hand.device().peak_torque, 0);
    const OnALever lever;
    lever.add(hand);
    EXPECT_EQ(to_eigen(lever.felt(hand).sent_torque).norm(), 0);
}

TEST(Hands, of_two_applications_one_may_end) {
    ServoProcess servo({"--device", "left=sim:cartesian3", "--device", "right=sim:cartesian3,mass=0.2"});
    Client mine = connect();
    Claim left = mine.claim("left");
    push(left, 0.25);
    {
        Client other = connect();
        Claim right = other.claim("right");
        push(right, -0.5);
        feel(left, 0.25);
        feel(right, -0.5);
        EXPECT_NEAR(after(left, 0).sent_force.x, 0.25, 1e-9);
    }
    const HandReport later = after(left, 200);
    EXPECT_EQ(later.state, DeviceState::active);
    EXPECT_NEAR(later.sent_force.x, 0.25, 1e-9);
    EXPECT_NO_THROW(mine.claim("right"));
}

TEST(Hands, one_that_hangs_does_not_hold_up_the_other) {
    const File device(std::string(sizeof(test::ProbeRecord), 0));
    const int fd = ::open(device.path().c_str(), O_RDWR | O_CLOEXEC);
    auto* const record = static_cast<test::ProbeRecord*>(
        ::mmap(nullptr, sizeof(test::ProbeRecord), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0));
    ::close(fd);
    ASSERT_NE(static_cast<void*>(record), MAP_FAILED);
    {
        ServoProcess servo({"--device", "left=sim:cartesian3", "--device", "right=probe:" + device.path()},
                           KNURLD_PROBE);
        Client client = connect();
        Claim left = client.claim("left"), right = client.claim("right");
        push(left, 0.25);
        push(right, -0.5);
        feel(left, 0.25);
        feel(right, -0.5);

        record->hang = 1;
        read_until(left, [&](const HandReport&) { return record->zeroings > 0; });  // the guardian's
        const HandReport later = after(left, 100);
        EXPECT_EQ(later.state, DeviceState::active) << "the guardian looked after the other alone";
        EXPECT_NEAR(later.sent_force.x, 0.25, 1e-9);

        record->hang = 0;
        read_until(right, [](const HandReport& r) { return is_active(r) && r.sent_force.x < -0.49; });
        EXPECT_EQ(after(left, 0).faults, 0u);
    }
    ::munmap(record, sizeof(test::ProbeRecord));
}

}  // namespace
