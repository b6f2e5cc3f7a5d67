// Hills from an array of heights, under the hand.

#include <math.h>

#include "example.h"

enum { COLUMNS = 121, ROWS = 121 };
static float heights[ROWS][COLUMNS];  // m

int main(int argc, char** argv) {
    const double seconds = seconds_of(argc, argv, 30);
    knurl_client* client = NULL;
    knurl_hand* hand = NULL;
    knurl_id terrain_id = 0;
    check(knurl_connect(NULL, NULL, &client));
    check(knurl_claim(client, NULL, NULL, &hand));

    for (int row = 0; row < ROWS; ++row)
        for (int column = 0; column < COLUMNS; ++column)
            heights[row][column] = (float)(0.003 * cos(0.15 * column) * cos(0.15 * row));
    const knurl_heights field = {.size = sizeof field,
                                 .heights_float = &heights[0][0],
                                 .columns = COLUMNS,
                                 .rows = ROWS,
                                 .dx = 0.001,
                                 .dy = 0.001,
                                 .corner = {-0.06, -0.06, 0}};
    knurl_sent sent = {.size = sizeof sent};
    check(knurl_keep_alive(hand, 0));  // while the field is on its way
    check(knurl_send_heights(hand, &field, &sent));
    check(knurl_keep_alive(hand, -1));
    printf("%llu triangles, %.1f mm high\n", (unsigned long long)sent.faces,
           (sent.high.z - sent.low.z) * 1e3);

    knurl_device device = {.size = sizeof device};
    check(knurl_device_of(hand, &device));
    knurl_shape terrain;
    knurl_default_shape(&terrain);
    terrain.asset = sent.asset;
    terrain.stiffness = 600;                     // N/m
    terrain.position = device.workspace_centre;  // the top of a hill, where the hand rests:
    terrain.position.z -= 0.003 + 0.005;         // below it, so that it comes from free space
    check(knurl_add_shape(hand, &terrain, NULL, &terrain_id));
    check(knurl_arm(hand));

    knurl_frame frame = {.size = sizeof frame};
    knurl_feedback felt = {.size = sizeof felt};
    int64_t first_ns = 0;
    double time = 0, most = 0;
    while (time < seconds) {
        const int code = knurl_newest(hand, 50000000, &frame);
        check(code);
        if (code == KNURL_NOTHING) continue;
        if (first_ns == 0) first_ns = frame.report.read_ns;
        time = (double)(frame.report.read_ns - first_ns) * 1e-9;
        // It rises by 7 mm within a second.
        terrain.position.z = device.workspace_centre.z - 0.008 + 0.007 * (time < 1 ? time : 1);
        check(knurl_set_shape(hand, terrain_id, &terrain));
        check(knurl_commit(hand, NULL));
        if (knurl_feedback_of(hand, terrain_id, &felt) == KNURL_OK && felt.force.z * felt.share > most)
            most = felt.force.z * felt.share;
    }
    printf("felt up to %.2f N\n", most);
    check(knurl_close(client));
    return 0;
}
