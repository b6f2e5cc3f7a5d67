// What a user of C writes, in ISO C11 with every warning an error.

#include <knurl.h>
#include <knurl_offline.h>

#include "kinds_table.h"

_Static_assert(offsetof(knurl_frame, report) % 8 == 0, "the report in the frame has its alignment");
_Static_assert(sizeof(knurl_code) == sizeof(int), "a code is an int");

double force_in_c(void) {
    knurl_offline* servo = NULL;
    knurl_plane floor;
    knurl_id id = 0;
    knurl_pose pose = KNURL_POSE_INIT;
    knurl_cycle felt = {.size = sizeof felt};
    knurl_default_plane(&floor);
    floor.stiffness = 800;
    pose.position.z = -0.001;
    if (knurl_offline_open(NULL, NULL, &servo) != KNURL_OK ||
        knurl_offline_add(servo, KNURL_PLANE, &floor, NULL, &id) != KNURL_OK ||
        knurl_offline_step(servo, &pose, &felt) != KNURL_OK || knurl_offline_close(servo) != KNURL_OK)
        return -1;
    return felt.force.z;
}

int connect_in_c(const char* address) {
    knurl_connect_options options;
    knurl_client* client = NULL;
    knurl_default_connect_options(&options);
    options.wait_ns = 0;
    return knurl_connect(address, &options, &client) != KNURL_OK ? knurl_close(client) : KNURL_OK;
}
