/* wall_hd STIFFNESS SECONDS: a wall at height 0 as programs for OpenHaptics compute it, in a scheduler's callback. A figure for
   scripts/lookalike_walls; not a test. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "hd.h"

static double stiffness; /* N/mm */

static HDCallbackCode wall(void* data) {
    double position[3], force[3] = {0, 0, 0};
    hdBeginFrame(*(const HHD*)data);
    hdGetDoublev(HD_CURRENT_POSITION, position);
    if (position[1] < 0) force[1] = -stiffness * position[1];
    hdSetDoublev(HD_CURRENT_FORCE, force);
    hdEndFrame(*(const HHD*)data);
    return HD_CALLBACK_CONTINUE;
}

int main(int argc, char** argv) {
    HHD device = hdInitDevice(NULL);
    const double seconds = argc > 2 ? atof(argv[2]) : 5;
    struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - (double)(long)seconds))};
    HDSchedulerHandle handle;
    if (device == HD_INVALID_HANDLE)
        return fprintf(stderr, "%s\n", hdGetErrorString(hdGetError().errorCode)), 1;
    stiffness = 1e-3 * (argc > 1 ? atof(argv[1]) : 500);
    hdEnable(HD_FORCE_OUTPUT);
    handle = hdScheduleAsynchronous(wall, &device, 65535);
    hdStartScheduler();
    nanosleep(&time, NULL);
    hdStopScheduler();
    hdUnschedule(handle);
    hdDisableDevice(device);
    return 0;
}
