// libHD.so against a servo.

#include <atomic>
#include <limits>
#include <mutex>
#include <thread>

#include "hd.h"
#include "served.hpp"

namespace lookalike_test {
namespace {

constexpr double exact_mm = 1e-9;  // of 1e-12 m

void forget_errors() {
    while (hdGetError().errorCode != HD_SUCCESS) {
    }
}

class Hd : public Served {
  protected:
    explicit Hd(const std::string& right = "sim:cartesian3") : Served(right) { forget_errors(); }
    ~Hd() override {
        hdStopScheduler();
        for (HHD handle = 0; handle < 4; ++handle) hdDisableDevice(handle);
        forget_errors();
    }
    static HDerror error() { return hdGetError().errorCode; }
};

class HdWrist : public Hd {
  protected:
    HdWrist() : Hd("sim:generic6") {}
};

/// What a callback does in each turn, and what it has seen.
struct Program {
    HHD device = 0;
    std::array<double, 3> force{};
    std::atomic<int> turns{0};
    std::atomic<bool> done{false};
    double lingers = 0;  // s, within a frame
    std::mutex mutex;
    std::array<double, 3> position{}, last_position{}, again{};
    std::array<double, 16> transform{};
    HDerror worst = HD_SUCCESS;
};

HDCallbackCode frame(void* data) {
    auto& program = *static_cast<Program*>(data);
    const std::lock_guard lock(program.mutex);
    hdBeginFrame(program.device);
    hdGetDoublev(HD_CURRENT_POSITION, program.position.data());
    hdGetDoublev(HD_LAST_POSITION, program.last_position.data());
    hdGetDoublev(HD_CURRENT_TRANSFORM, program.transform.data());
    hdSetDoublev(HD_CURRENT_FORCE, program.force.data());
    while (hdGetSchedulerTimeStamp() < program.lingers) {
    }
    hdGetDoublev(HD_CURRENT_POSITION, program.again.data());
    hdEndFrame(program.device);
    if (const HDErrorInfo error = hdGetError(); error.errorCode != HD_SUCCESS)
        program.worst = error.errorCode;
    ++program.turns;
    return program.done ? HD_CALLBACK_DONE : HD_CALLBACK_CONTINUE;
}

/// A callback that ends before what it works on does.
struct Scheduled {
    Scheduled(HDSchedulerCallback callback, void* data, HDushort priority)
        : handle(hdScheduleAsynchronous(callback, data, priority)) {}
    ~Scheduled() { hdUnschedule(handle); }
    Scheduled(const Scheduled&) = delete;
    Scheduled& operator=(const Scheduled&) = delete;
    HDSchedulerHandle handle;
};

TEST_F(Hd, a_device_is_initialised_by_any_of_its_names) {
    EXPECT_EQ(hdInitDevice(nullptr), 0u);
    EXPECT_EQ(error(), HDerror{HD_SUCCESS});
    EXPECT_EQ(hdGetCurrentDevice(), 0u);
    EXPECT_STREQ(hdGetString(HD_DEVICE_MODEL_TYPE), "cartesian3");
    EXPECT_STREQ(hdGetString(HD_DEVICE_VENDOR), "Knurl");
    EXPECT_EQ(hdInitDevice("Left Device"), 1u);
    EXPECT_STREQ(hdGetString(HD_DEVICE_MODEL_TYPE), "premium15") << "the newest is the current one";
    EXPECT_EQ(error(), HDerror{HD_SUCCESS});
    EXPECT_EQ(hdInitDevice("right"), 0u);
    EXPECT_EQ(error(), HDerror{HD_DEVICE_ALREADY_INITIATED});
    EXPECT_EQ(hdInitDevice("Default PHANToM"), 0u);
    EXPECT_EQ(error(), HDerror{HD_DEVICE_ALREADY_INITIATED});
    ::setenv("KNURL_AS_DEVICES", "right,PHANToM 2=left", 1);
    EXPECT_EQ(hdInitDevice("phantom 2"), 1u) << "as the program calls it";
    EXPECT_EQ(error(), HDerror{HD_DEVICE_ALREADY_INITIATED});
    EXPECT_EQ(hdInitDevice("middle"), HD_INVALID_HANDLE);
    EXPECT_EQ(error(), HDerror{HD_COMM_ERROR});
    hdDisableDevice(1);
    hdDisableDevice(1);
    EXPECT_EQ(error(), HDerror{HD_BAD_HANDLE}) << "twice";
}

TEST_F(Hd, a_callback_is_run_in_each_cycle_and_its_force_is_felt) {
    Program program;
    program.device = hdInitDevice(nullptr);
    program.force = {0, 0, 0.4};  // towards the user: Knurl's x
    hdEnable(HD_FORCE_OUTPUT);
    ASSERT_EQ(error(), HDerror{HD_SUCCESS});
    const Scheduled scheduled(frame, &program, 65535);
    const HDSchedulerHandle handle = scheduled.handle;
    hdStartScheduler();
    ASSERT_TRUE(until(
        *right_, [](const HandReport& r) { return is_active(r) && std::abs(r.sent_force.x - 0.4) < 1e-9; },
        [] {}));
    const int turns = program.turns;
    const std::uint64_t cycle = right_->latest()->cycle;
    EXPECT_TRUE(eventually([&] { return program.turns > turns + 300; }));
    EXPECT_GE(right_->newest(1s)->cycle - cycle, 298u) << "not more than one a cycle";
    EXPECT_NE(hdWaitForCompletion(handle, HD_WAIT_CHECK_STATUS), 0);
    program.done = true;
    EXPECT_EQ(hdWaitForCompletion(handle, HD_WAIT_INFINITE), 0);
    EXPECT_EQ(program.worst, HDerror{HD_SUCCESS});
    EXPECT_TRUE(until(*right_, no_force, [] {})) << "nobody sets it any more";
}

TEST_F(Hd, a_frame_is_one_moment_in_millimetres_along_their_axes) {
    const Vec3 centre = right_->device().workspace_centre;
    Program program;
    program.lingers = 3e-3;  // several reports come meanwhile
    program.device = hdInitDevice("right");
    hdEnable(HD_FORCE_OUTPUT);
    const Scheduled scheduled(frame, &program, 100);
    hdStartScheduler();
    ASSERT_TRUE(until(*right_, is_active, [] {}));
    int moved = 0;
    std::array<double, 3> first{};
    for (int i = 0; i < 100; ++i) {
        while (right_->next_report(0ns)) {
        }
        std::vector<HandReport> seen{*right_->latest()};
        const int turns = program.turns;
        ASSERT_TRUE(eventually([&] { return program.turns > turns; }));
        const std::lock_guard lock(program.mutex);
        if (const auto next = right_->next_report(1s)) seen.push_back(*next);
        while (const auto next = right_->next_report(0ns)) seen.push_back(*next);
        double nearest = 1e3;
        for (const HandReport& r : seen)
            nearest = std::min(nearest, std::hypot(program.position[0] - 1e3 * (r.position.y - centre.y),
                                                   program.position[1] - 1e3 * (r.position.z - centre.z),
                                                   program.position[2] - 1e3 * (r.position.x - centre.x)));
        EXPECT_LE(nearest, exact_mm);
        EXPECT_EQ(program.position, program.again) << "within a frame nothing moves";
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(program.transform[12 + k], program.position[k]);
        EXPECT_EQ(program.transform[0], 1);
        EXPECT_EQ(program.transform[15], 1);
        if (i == 0) first = program.position;
        moved += std::abs(program.position[0] - first[0]) > 0.1 ? 1 : 0;
    }
    EXPECT_GT(moved, 20) << "a hand at rest proves little";
}

TEST_F(Hd, nothing_is_felt_before_the_force_output_is_enabled) {
    Program program;
    program.device = hdInitDevice(nullptr);
    program.force = {0.5, 0, 0};
    const Scheduled scheduled(frame, &program, 100);
    hdStartScheduler();
    ASSERT_TRUE(eventually([&] { return program.turns > 100; }));
    EXPECT_EQ(right_->latest()->state, DeviceState::idle);
    EXPECT_EQ(hdIsEnabled(HD_FORCE_OUTPUT), 0);
    hdEnable(HD_FORCE_OUTPUT);
    EXPECT_EQ(hdIsEnabled(HD_FORCE_OUTPUT), 1);
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_force.y - 0.5) < 1e-9; }, [] {}));
    hdDisable(HD_FORCE_OUTPUT);
    EXPECT_TRUE(until(*right_, no_force, [] {}));
}

TEST_F(Hd, callbacks_of_a_turn_add_up_and_a_frame_that_sets_nothing_changes_nothing) {
    Program program;
    program.device = hdInitDevice(nullptr);
    hdEnable(HD_FORCE_OUTPUT);
    hdStartScheduler();
    program.force = {0.5, 0, 0};
    const auto twice = [](void* data) -> HDCallbackCode {
        auto& p = *static_cast<Program*>(data);
        double before[3];
        hdBeginFrame(p.device);
        hdGetDoublev(HD_CURRENT_FORCE, before);
        const double more[3] = {before[0] + 0.1, 0, 0};
        hdSetDoublev(HD_CURRENT_FORCE, more);
        hdEndFrame(p.device);
        ++p.turns;
        return HD_CALLBACK_CONTINUE;
    };
    Program second;
    second.device = program.device;
    const Scheduled scheduled(frame, &program, 200);
    const HDSchedulerHandle adds = hdScheduleAsynchronous(twice, &second, 100);
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_force.y - 0.6) < 1e-9; }, [] {}))
        << "a later callback of a turn adds to the earlier one's force";
    program.done = true;
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_force.y - 0.1) < 1e-9; }, [] {}))
        << "which does not grow from turn to turn";
    hdUnschedule(adds);
    const int turns = second.turns;
    const auto looks = [](void* data) -> HDCallbackCode {
        auto& p = *static_cast<Program*>(data);
        double force[3] = {7, 7, 7};
        hdBeginFrame(p.device);
        hdGetDoublev(HD_CURRENT_FORCE, force);
        hdEndFrame(p.device);
        if (force[0] != 0) p.worst = HD_FORCE_ERROR;
        return ++p.turns < 500 ? HD_CALLBACK_CONTINUE : HD_CALLBACK_DONE;
    };
    Program third;
    third.device = program.device;
    hdScheduleSynchronous(looks, &third, 0);
    EXPECT_NEAR(right_->latest()->sent_force.y, 0.1, 1e-9)
        << "half a second later, that of the frame before stands";
    EXPECT_EQ(third.worst, HDerror{HD_SUCCESS}) << "a frame has commanded nothing when it begins";
    EXPECT_TRUE(until(*right_, no_force, [] {}));
    EXPECT_EQ(second.turns, turns) << "unscheduled is unscheduled";
}

TEST_F(Hd, synchronous_callbacks_run_in_the_schedulers_thread_and_are_waited_for) {
    hdInitDevice(nullptr);
    hdStartScheduler();
    struct Seen {
        std::thread::id thread{};
        int turns = 0;
    } seen;
    const auto body = [](void* data) -> HDCallbackCode {
        auto& s = *static_cast<Seen*>(data);
        s.thread = std::this_thread::get_id();
        return ++s.turns < 5 ? HD_CALLBACK_CONTINUE : HD_CALLBACK_DONE;
    };
    hdScheduleSynchronous(body, &seen, 32767);
    EXPECT_EQ(seen.turns, 5);
    EXPECT_NE(seen.thread, std::this_thread::get_id());
    // From within the scheduler it runs at once, and does not wait for itself.
    const auto nested = [](void* data) -> HDCallbackCode {
        hdScheduleSynchronous(
            [](void* inner) -> HDCallbackCode { return ++*static_cast<int*>(inner), HD_CALLBACK_DONE; }, data,
            0);
        hdStopScheduler();
        return HD_CALLBACK_DONE;
    };
    int ran = 0;
    hdScheduleSynchronous(nested, &ran, 0);
    EXPECT_EQ(ran, 1);
}

TEST_F(Hd, the_urgent_callback_is_the_first) {
    hdInitDevice(nullptr);
    std::vector<int> order;
    struct Entry {
        std::vector<int>* order;
        int name;
    };
    Entry low{&order, 1}, high{&order, 2}, middle{&order, 3};
    const auto body = [](void* data) -> HDCallbackCode {
        const auto& entry = *static_cast<Entry*>(data);
        entry.order->push_back(entry.name);
        return HD_CALLBACK_DONE;
    };
    hdScheduleAsynchronous(body, &low, 0);
    hdScheduleAsynchronous(body, &high, 65535);
    const HDSchedulerHandle last = hdScheduleAsynchronous(body, &middle, 100);
    hdStartScheduler();
    hdWaitForCompletion(last, HD_WAIT_INFINITE);
    hdStopScheduler();
    EXPECT_EQ(order, (std::vector<int>{2, 3, 1}));
}

TEST_F(Hd, nonsense_is_an_error_and_changes_nothing) {
    const HHD device = hdInitDevice(nullptr);
    double values[16];
    hdGetDoublev(0x1234, values);
    EXPECT_EQ(error(), HDerror{HD_INVALID_ENUM});
    hdGetDoublev(HD_CURRENT_JACOBIAN, values);
    EXPECT_EQ(error(), HDerror{HD_INVALID_OPERATION});
    hdGetDoublev(HD_CURRENT_POSITION, nullptr);
    EXPECT_EQ(error(), HDerror{HD_INVALID_VALUE});
    hdEndFrame(device);
    EXPECT_EQ(error(), HDerror{HD_ILLEGAL_END});
    hdEnable(0x4711);
    EXPECT_EQ(error(), HDerror{HD_INVALID_ENUM});
    hdSetSchedulerRate(333'333);
    EXPECT_EQ(error(), HDerror{HD_INVALID_VALUE});
    hdSetSchedulerRate(500);
    EXPECT_EQ(error(), HDerror{HD_SUCCESS});
    hdSetSchedulerRate(1000);
    EXPECT_EQ(error(), HDerror{HD_SUCCESS});
    hdBeginFrame(device);
    const double good[3] = {0, 0.1, 0};
    hdSetDoublev(HD_CURRENT_FORCE, good);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const double force[3] = {0, bad, 0};
        hdSetDoublev(HD_CURRENT_FORCE, force);
        EXPECT_EQ(error(), HDerror{HD_INVALID_VALUE});
    }
    hdGetDoublev(HD_CURRENT_FORCE, values);
    EXPECT_EQ(values[1], 0.1) << "the one before stands";
    hdSetDoublev(HD_CURRENT_POSITION, good);
    EXPECT_EQ(error(), HDerror{HD_INVALID_ENUM}) << "nobody sets a position";
    hdEndFrame(device);
    EXPECT_EQ(error(), HDerror{HD_SUCCESS});
}

TEST_F(Hd, what_a_device_is_can_be_asked_in_any_type) {
    hdInitDevice(nullptr);
    const DeviceDescription about = right_->device();
    int whole = 0;
    hdGetIntegerv(HD_UPDATE_RATE, &whole);
    EXPECT_EQ(whole, 1000);
    hdGetIntegerv(HD_INPUT_DOF, &whole);
    EXPECT_EQ(whole, 3);
    double real = 0;
    hdGetDoublev(HD_NOMINAL_MAX_STIFFNESS, &real);
    EXPECT_DOUBLE_EQ(real, 1e-3 * about.max_stiffness);
    float small = 0;
    hdGetFloatv(HD_NOMINAL_MAX_FORCE, &small);
    EXPECT_FLOAT_EQ(small, static_cast<float>(about.peak_force));
    long buttons = 7;
    hdGetLongv(HD_CURRENT_BUTTONS, &buttons);
    EXPECT_EQ(buttons, 0);
    HDboolean safe = 0;
    hdGetBooleanv(HD_CURRENT_SAFETY_SWITCH, &safe);
    EXPECT_EQ(safe, 1);
    double box[6];
    hdGetDoublev(HD_USABLE_WORKSPACE_DIMENSIONS, box);
    EXPECT_DOUBLE_EQ(box[5], 1e3 * about.workspace_radius);
    EXPECT_EQ(hdCheckCalibration(), HDenum{HD_CALIBRATION_OK});
    EXPECT_EQ(error(), HDerror{HD_SUCCESS});
}

TEST_F(HdWrist, torque_is_in_newton_millimetres_about_their_axes) {
    const HHD device = hdInitDevice(nullptr);
    hdEnable(HD_FORCE_OUTPUT);
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_torque.x - 0.02) < 1e-6; },
        [&] {
            const double torque[3] = {0, 0, 20};
            hdBeginFrame(device);
            hdSetDoublev(HD_CURRENT_TORQUE, torque);
            hdEndFrame(device);
        }));
    const auto r = to_eigen(right_->latest()->orientation).toRotationMatrix();
    double m[16], gimbals[3];
    hdBeginFrame(device);
    hdGetDoublev(HD_CURRENT_TRANSFORM, m);
    hdGetDoublev(HD_CURRENT_GIMBAL_ANGLES, gimbals);
    hdEndFrame(device);
    // Their axis i is Knurl's axis of[i], for the base and the tool alike.
    constexpr int of[3] = {1, 2, 0};
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) EXPECT_NEAR(m[4 * column + row], r(of[row], of[column]), 1e-2);
    EXPECT_NEAR(gimbals[0], right_->latest()->joints[3], 1e-2);
}

TEST_F(Hd, two_devices_are_driven_from_one_callback) {
    static HHD right, left;
    right = hdInitDevice("right");
    hdEnable(HD_FORCE_OUTPUT);
    left = hdInitDevice("left");
    hdEnable(HD_FORCE_OUTPUT);
    const auto body = [](void*) -> HDCallbackCode {
        const double one[3] = {0.2, 0, 0}, other[3] = {0, 0.3, 0};
        hdBeginFrame(right);
        hdSetDoublev(HD_CURRENT_FORCE, one);
        hdBeginFrame(left);
        hdSetDoublev(HD_CURRENT_FORCE, other);
        hdEndFrame(left);
        hdEndFrame(right);
        return HD_CALLBACK_CONTINUE;
    };
    const Scheduled scheduled(body, nullptr, 0);
    hdStartScheduler();
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return std::abs(r.sent_force.y - 0.2) < 1e-9; }, [] {}));
    EXPECT_TRUE(until(
        *left_, [](const HandReport& r) { return std::abs(r.sent_force.z - 0.3) < 1e-9; }, [] {}));
}

TEST_F(Hd, the_servo_is_killed_and_the_callbacks_go_on) {
    Program program;
    program.device = hdInitDevice(nullptr);
    program.force = {0, 0.1, 0};
    hdEnable(HD_FORCE_OUTPUT);
    const Scheduled scheduled(frame, &program, 100);
    hdStartScheduler();
    ASSERT_TRUE(until(*right_, is_active, [] {}));
    servo_.end(SIGKILL);
    const int turns = program.turns;
    EXPECT_TRUE(eventually([&] { return program.turns > turns + 50; }));
    {
        const std::lock_guard lock(program.mutex);
        EXPECT_EQ(program.worst, HDerror{HD_COMM_ERROR});
    }
    servo_.start();
    EXPECT_TRUE(until(
        *right_, [](const HandReport& r) { return is_active(r) && r.sent_force.z > 0.09; }, [] {}));
    hdStopScheduler();
}

}  // namespace
}  // namespace lookalike_test
