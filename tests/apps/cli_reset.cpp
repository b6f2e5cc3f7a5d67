// `knurl reset`: leaves a fault, whoever holds the device, and enables nothing.

#include <chrono>

#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/reps/constant_force.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using namespace std::chrono_literals;

bool says(const std::string& text, const std::string& what) {
    return text.find(what) != std::string::npos;
}

template <class Reader>
DeviceState state_of(Reader& reader) {
    const auto report = reader.latest();
    return report ? report->state : DeviceState::disconnected;
}

/// Acts like the suspend of a machine: the servo's clock has jumped when it continues. A gap above 1 s is a
/// fault.
template <class Reader>
void suspend(const Servo& servo, Reader& reader) {
    ASSERT_TRUE(eventually([&] { return reader.latest().has_value(); }));
    ::kill(servo.pid(), SIGSTOP);
    EXPECT_TRUE(eventually([&] {
        const std::chrono::nanoseconds newest(reader.latest()->read_ns);
        return std::chrono::steady_clock::now().time_since_epoch() - newest > 1050ms;
    }));
    ::kill(servo.pid(), SIGCONT);
}

TEST(Reset, LeavesAFaultThatASuspendLeftBehind) {
    const Home home;
    const Servo servo({"--device", "sim:premium15"});
    Client client = Client::connect();
    Observer observer = client.observe();
    suspend(servo, observer);
    ASSERT_TRUE(eventually([&] { return state_of(observer) == DeviceState::fault; }));
    EXPECT_TRUE(says(knurl({"ls"}).out, "fault (clock jump; clear it with: knurl reset premium15)"));

    const Outcome outcome = knurl({"reset"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "knurl:default: premium15 has left its fault (clock jump) and is idle\n");
    EXPECT_TRUE(eventually([&] { return state_of(observer) == DeviceState::idle; }));

    const Outcome again = knurl({"reset", "premium15"});
    EXPECT_EQ(again.code, 0) << "what is wanted is so already";
    EXPECT_EQ(again.out, "knurl:default: premium15 is in no fault (idle)\n");
}

TEST(Reset, BesideWhoHoldsTheDeviceSwitchesNothingOn) {
    const Home home;
    const Servo servo({"--device", "left=sim:premium15", "--device", "right=sim:cartesian3"});
    Client client = Client::connect("knurl:default", {.name = "painter"});
    Claim hand = client.claim("right");
    hand.add(ConstantForce{.force = {0, 0, 0.1}, .recovery = 0});
    hand.arm();
    suspend(servo, hand);
    ASSERT_TRUE(eventually([&] { return state_of(hand) == DeviceState::fault; }));
    EXPECT_THROW(hand.arm(), Error);

    const Outcome which = knurl({"reset"});
    EXPECT_EQ(which.code, 1);
    EXPECT_TRUE(says(which.err, "left, right")) << which.err;
    const Outcome outcome = knurl({"reset", "right"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, "right has left its fault (clock jump) and is idle; pid " +
                                      std::to_string(::getpid()) +
                                      " painter holds it and has to arm it anew"))
        << outcome.out;
    EXPECT_TRUE(eventually([&] { return state_of(hand) == DeviceState::idle; }));
    for (int i = 0; i < 50; ++i)
        if (const auto report = hand.next_report(100ms)) {
            EXPECT_EQ(report->state, DeviceState::idle) << "no force without its holder's arm()";
        }
    hand.arm();
    EXPECT_TRUE(eventually(
        [&] { return state_of(hand) == DeviceState::ramp_up || state_of(hand) == DeviceState::active; }));
}

TEST(Reset, WithoutAServoItSaysHowToStartOne) {
    const Home home;
    const Outcome outcome = knurl({"reset"});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_TRUE(says(outcome.err, "start")) << outcome.err;
}

}  // namespace
}  // namespace knurl::test
