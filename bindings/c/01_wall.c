// A floor that the hand touches from above. Prints what is felt.

#include "example.h"

int main(int argc, char** argv) {
    const double seconds = seconds_of(argc, argv, 30);
    knurl_client* client = NULL;
    knurl_hand* hand = NULL;
    knurl_id floor_id = 0;
    check(knurl_connect(NULL, NULL, &client));
    check(knurl_claim(client, NULL, NULL, &hand));

    knurl_device device = {.size = sizeof device};
    check(knurl_device_of(hand, &device));
    knurl_plane floor;
    knurl_default_plane(&floor);
    floor.offset = device.workspace_centre.z + 0.002;  // m: the hand at rest is 2 mm within
    floor.stiffness = 800;                             // N/m
    check(knurl_add_plane(hand, &floor, NULL, &floor_id));
    check(knurl_arm(hand));

    knurl_frame frame = {.size = sizeof frame};
    knurl_feedback felt = {.size = sizeof felt};
    int64_t first_ns = 0, said_ns = 0;
    double most = 0;
    for (;;) {
        const int code = knurl_newest(hand, 50000000, &frame);
        check(code);
        check(knurl_commit(hand, NULL));  // "I am alive"
        if (code == KNURL_NOTHING || knurl_feedback_of(hand, floor_id, &felt) != KNURL_OK) continue;
        const knurl_report* now = &frame.report;
        if (first_ns == 0) first_ns = now->read_ns;
        if (felt.force.z * felt.share > most) most = felt.force.z * felt.share;
        if (now->read_ns - said_ns > 500000000) {
            said_ns = now->read_ns;
            printf("height %6.2f mm, force %5.2f N\n", (now->position.z - floor.offset) * 1e3,
                   felt.force.z * felt.share);
        }
        if ((double)(now->read_ns - first_ns) > seconds * 1e9) break;
    }
    printf("felt up to %.2f N\n", most);
    check(knurl_close(client));
    return 0;
}
