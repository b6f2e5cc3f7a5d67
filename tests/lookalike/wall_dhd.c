/* wall_dhd STIFFNESS SECONDS [HZ]: a wall at height 0 as programs for Force Dimension's library compute it: F = -k z in a loop of
   their own, without a clock, or HZ times a second. A figure for scripts/lookalike_walls; not a test. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "dhd.h"

int main(int argc, char** argv) {
    const double stiffness = argc > 1 ? atof(argv[1]) : 500, seconds = argc > 2 ? atof(argv[2]) : 5,
                 rate = argc > 3 ? atof(argv[3]) : 0;
    double x, y, z, end;
    struct timespec due;
    if (dhdOpen() < 0) return fprintf(stderr, "%s\n", dhdErrorGetLastStr()), 1;
    dhdEnableForce(1, -1);
    clock_gettime(CLOCK_MONOTONIC, &due);
    for (end = dhdGetTime() + seconds; dhdGetTime() < end;) {
        if (dhdGetPosition(&x, &y, &z, -1) < 0) break;
        if (dhdSetForce(0, 0, z < 0 ? -stiffness * z : 0, -1) < 0) break;
        if (rate > 0) {
            due.tv_nsec += (long)(1e9 / rate);
            if (due.tv_nsec >= 1000000000L) due.tv_nsec -= 1000000000L, ++due.tv_sec;
            clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
        }
    }
    return dhdClose(-1) < 0;
}
