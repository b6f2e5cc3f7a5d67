// What programs do before anything is open, and what becomes of nonsense. No servo runs.

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "../temp_folder.hpp"
#include "dhd.h"
#include "drd.h"
#include "hd.h"

namespace {

class WithoutServo : public ::testing::Test {
  protected:
    WithoutServo() {
        ::setenv("KNURL_RUNTIME_DIR", folder_.path().c_str(), 1);
        *dhdErrnoLocation() = 0;
        while (hdGetError().errorCode != HD_SUCCESS) {
        }
    }
    knurl::test::TempFolder folder_;
};

TEST_F(WithoutServo, nothing_can_be_opened_and_the_error_says_so) {
    EXPECT_EQ(dhdGetDeviceCount(), 0);
    EXPECT_EQ(dhdErrorGetLast(), 5);
    EXPECT_EQ(dhdOpen(), -1);
    EXPECT_EQ(dhdErrorGetLast(), 5);
    EXPECT_NE(std::string(dhdErrorGetLastStr()).find("no device"), std::string::npos);
    EXPECT_EQ(dhdOpenID(0), -1);
    EXPECT_EQ(dhdOpenSerial(1), -1);
    EXPECT_EQ(dhdOpenType(33), -1);
    EXPECT_EQ(drdOpen(), -1);
    EXPECT_EQ(hdInitDevice(nullptr), HD_INVALID_HANDLE);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_COMM_ERROR});
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_SUCCESS}) << "each is taken once";
}

TEST_F(WithoutServo, before_a_device_is_open_every_call_is_refused) {
    double x = 7, y = 7, z = 7, m[9] = {};
    int status[17] = {};
    EXPECT_EQ(dhdGetPosition(&x, &y, &z, -1), -1);
    EXPECT_EQ(dhdErrorGetLast(), 12);
    EXPECT_EQ(x, 7) << "nothing is written";
    EXPECT_EQ(dhdSetForce(1, 0, 0, -1), -1);
    EXPECT_EQ(dhdGetOrientationFrame(m, 0), -1);
    EXPECT_EQ(dhdGetStatus(status, 0), -1);
    EXPECT_EQ(dhdEnableForce(1, -1), -1);
    EXPECT_EQ(dhdStop(-1), -1);
    EXPECT_EQ(dhdClose(-1), -1);
    EXPECT_EQ(dhdSetDevice(0), -1);
    EXPECT_EQ(dhdGetDeviceID(), -1);
    EXPECT_EQ(dhdGetButton(0, -1), -1);
    EXPECT_EQ(dhdGetButtonMask(-1), 0u);
    EXPECT_EQ(dhdGetSystemName(-1), nullptr);
    EXPECT_FALSE(dhdHasWrist(-1));
    EXPECT_FALSE(drdIsInitialized(-1));
    drdWaitForTick(-1);

    hdGetDoublev(HD_CURRENT_POSITION, m);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_BAD_HANDLE});
    hdBeginFrame(0);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_BAD_HANDLE});
    hdEndFrame(HD_INVALID_HANDLE);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_BAD_HANDLE});
    hdEnable(HD_FORCE_OUTPUT);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_BAD_HANDLE});
    hdDisableDevice(3);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_BAD_HANDLE});
    EXPECT_EQ(hdGetCurrentDevice(), 0u);
    EXPECT_STREQ(hdGetString(HD_DEVICE_MODEL_TYPE), "");
}

TEST_F(WithoutServo, a_device_number_out_of_range_is_an_invalid_index) {
    double x, y, z;
    for (const int id : {16, 100, 127}) {
        EXPECT_EQ(dhdGetPosition(&x, &y, &z, static_cast<char>(id)), -1);
        EXPECT_EQ(dhdErrorGetLast(), 15) << id;
        EXPECT_EQ(dhdOpenID(static_cast<char>(id)), -1);
        EXPECT_EQ(dhdErrorGetLast(), 15) << id;
    }
}

TEST_F(WithoutServo, what_is_not_available_says_so) {
    int counts[8];
    unsigned short motor[8] = {};
    EXPECT_EQ(dhdGetEnc(counts, 0xff, 0), -1);
    EXPECT_EQ(dhdErrorGetLast(), 6);
    EXPECT_EQ(dhdSetMot(motor, 0xff, 0), -1);
    EXPECT_EQ(dhdErrorGetLast(), 6);
    EXPECT_EQ(dhdEmulateButton(1, 0), -1);
    EXPECT_EQ(dhdErrorGetLast(), 6);
    double gap = 7;
    EXPECT_EQ(dhdGetGripperGap(&gap, 0), -1);
    EXPECT_EQ(gap, 0) << "programs seldom look at what is returned";
    EXPECT_EQ(drdStart(0), -1);
    EXPECT_EQ(dhdErrorGetLast(), 6);
    EXPECT_EQ(drdMoveToPos(0, 0, 0, 1, 0), -1);
    EXPECT_EQ(dhdErrorGetLast(), 22) << "no regulation";
    hdScaleGimbalAngles(1, 1, 1, nullptr);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_INVALID_OPERATION});
}

TEST_F(WithoutServo, an_error_belongs_to_the_thread_that_made_it) {
    EXPECT_EQ(dhdClose(99), -1);
    EXPECT_EQ(dhdErrorGetLast(), 15);
    *dhdErrnoLocation() = 0;
    std::thread([] {
        EXPECT_EQ(dhdErrorGetLast(), 0);
        EXPECT_EQ(dhdClose(-1), -1);
        EXPECT_EQ(dhdErrorGetLast(), 12);
        hdBeginFrame(5);
    }).join();
    EXPECT_EQ(dhdErrorGetLast(), 0);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_SUCCESS});
}

TEST_F(WithoutServo, every_error_has_a_text) {
    for (int error = 0; error <= 22; ++error) EXPECT_STRNE(dhdErrorGetStr(error), "unknown error") << error;
    EXPECT_STREQ(dhdErrorGetStr(99), "unknown error");
    for (const HDerror error :
         {HD_INVALID_ENUM, HD_BAD_HANDLE, HD_DEVICE_FAULT, HD_ILLEGAL_END, HD_SCHEDULER_FULL})
        EXPECT_STRNE(hdGetErrorString(error), "unknown error") << error;
    EXPECT_STREQ(hdGetErrorString(12345), "unknown error");
}

TEST_F(WithoutServo, an_error_stack_that_nobody_reads_has_an_end) {
    for (int i = 0; i < 10'000; ++i) hdBeginFrame(0);
    int count = 0;
    while (hdGetError().errorCode != HD_SUCCESS) ++count;
    EXPECT_EQ(count, 64);
}

HDCallbackCode count(void* times) {
    return ++*static_cast<int*>(times) < 3 ? HD_CALLBACK_CONTINUE : HD_CALLBACK_DONE;
}

TEST_F(WithoutServo, a_scheduler_that_does_not_run_runs_synchronous_callbacks_at_once) {
    int times = 0;
    hdScheduleSynchronous(count, &times, 0);
    EXPECT_EQ(times, 3);
    hdScheduleSynchronous(nullptr, nullptr, 0);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_INVALID_VALUE});
    EXPECT_EQ(hdScheduleAsynchronous(nullptr, nullptr, 0), HD_INVALID_HANDLE);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_INVALID_VALUE});
    hdUnschedule(4711);
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_INVALID_VALUE});
    EXPECT_EQ(hdWaitForCompletion(4711, HD_WAIT_INFINITE), 0) << "it is not scheduled";
    hdStopScheduler();
    hdStopScheduler();
    EXPECT_EQ(hdGetError().errorCode, HDerror{HD_SUCCESS});
}

TEST_F(WithoutServo, a_scheduler_without_a_device_goes_on_with_its_callbacks) {
    int times = 0;
    hdStartScheduler();
    hdStartScheduler();
    const HDSchedulerHandle handle = hdScheduleAsynchronous(count, &times, 0);
    EXPECT_EQ(hdWaitForCompletion(handle, HD_WAIT_INFINITE), 0);
    EXPECT_EQ(times, 3);
    hdStopScheduler();
}

}  // namespace
