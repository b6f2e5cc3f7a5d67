// A pyramid in memory, sent in steps, that comes up under the hand and goes down again while it turns.

#include <math.h>

#include "example.h"

static const double vertices[][3] = {
    {-0.03, -0.03, 0}, {0.03, -0.03, 0}, {0.03, 0.03, 0}, {-0.03, 0.03, 0}, {0, 0, 0.03}};
// Counter-clockwise as seen from outside.
static const uint32_t triangles[][3] = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 2, 1}, {0, 3, 2}};

int main(int argc, char** argv) {
    const double seconds = seconds_of(argc, argv, 30);
    knurl_client* client = NULL;
    knurl_hand* hand = NULL;
    knurl_sending* sending = NULL;
    knurl_id pyramid_id = 0;
    check(knurl_connect(NULL, NULL, &client));
    check(knurl_claim(client, NULL, NULL, &hand));

    const knurl_mesh mesh = {.size = sizeof mesh,
                             .vertices = &vertices[0][0],
                             .vertex_count = sizeof vertices / sizeof *vertices,
                             .triangles = &triangles[0][0],
                             .triangle_count = sizeof triangles / sizeof *triangles};
    knurl_sent sent = {.size = sizeof sent};
    check(knurl_begin_sending_mesh(hand, &mesh, &sending));
    for (int code = KNURL_NOTHING; code == KNURL_NOTHING; check(code)) {
        check(knurl_commit(hand, NULL));  // the program goes on meanwhile
        code = knurl_sending_done(sending, 10000000, &sent);
    }
    printf("%llu triangles, %llu open edges\n", (unsigned long long)sent.faces,
           (unsigned long long)sent.edges_open);

    knurl_device device = {.size = sizeof device};
    check(knurl_device_of(hand, &device));
    knurl_shape pyramid;
    knurl_default_shape(&pyramid);
    pyramid.asset = sent.asset;
    pyramid.stiffness = 500;  // N/m
    pyramid.position = device.workspace_centre;
    pyramid.position.z -= 0.05;
    check(knurl_add_shape(hand, &pyramid, NULL, &pyramid_id));
    check(knurl_arm(hand));

    knurl_frame frame = {.size = sizeof frame};
    int64_t first_ns = 0;
    double time = 0;
    unsigned long long touches = 0;
    while (time < seconds) {
        const int code = knurl_newest(hand, 50000000, &frame);
        check(code);
        if (code == KNURL_NOTHING) continue;
        if (first_ns == 0) first_ns = frame.report.read_ns;
        time = (double)(frame.report.read_ns - first_ns) * 1e-9;
        touches += frame.touches;
        pyramid.position.z = device.workspace_centre.z - 0.035 - 0.008 * cos(3 * time);
        pyramid.orientation = (knurl_quat){.w = cos(0.2 * time), .z = sin(0.2 * time)};
        check(knurl_set_shape(hand, pyramid_id, &pyramid));
        check(knurl_commit(hand, NULL));
    }
    printf("touched %llu times\n", touches);
    check(knurl_close(client));
    return 0;
}
