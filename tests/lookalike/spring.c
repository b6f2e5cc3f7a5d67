/* A program as users have it: written for the vendor's library, linked with -ldhd, it knows nothing of Knurl. A spring draws the
   hand to the centre until a key comes. */
#include <stdio.h>

#include "dhd.h"

int main(int argc, char** argv) {
    const double stiffness = 150; /* N/m */
    double x, y, z;
    int device = dhdOpen();
    (void)argc;
    if (device < 0) {
        printf("%s: cannot open: %s\n", argv[0], dhdErrorGetLastStr());
        return 3;
    }
    dhdEnableForce(1, (char)device);
    printf("opened %s\n", dhdGetSystemName((char)device));
    fflush(stdout);
    while (!dhdKbHit()) {
        if (dhdGetPosition(&x, &y, &z, -1) < 0 ||
            dhdSetForce(-stiffness * x, -stiffness * y, -stiffness * z, -1) < 0) {
            printf("lost: %s\n", dhdErrorGetLastStr());
            dhdClose(-1);
            return 4;
        }
    }
    dhdClose(-1);
    printf("done\n");
    return 0;
}
