// Octave calls C through a function like this one; wall.m compiles it. It has what wall.m needs; more is more lines.
//     hand = knurl_mex("claim")         centre = knurl_mex("centre", hand)        knurl_mex("arm", hand)
//     id = knurl_mex("add_plane", hand, offset, stiffness)                        knurl_mex("commit", hand)
//     force = knurl_mex("force", hand, id)                                        knurl_mex("close")

#include <knurl.h>
#include <mex.h>
#include <string.h>

static knurl_client* client;

static void check(int code) {
    if (code < 0) mexErrMsgTxt(knurl_error(NULL));
}
static mxArray* number64(uint64_t value) {
    mxArray* const array = mxCreateNumericMatrix(1, 1, mxUINT64_CLASS, mxREAL);
    *(uint64_t*)mxGetData(array) = value;
    return array;
}
static mxArray* vector(knurl_vec3 v, double by) {
    mxArray* const array = mxCreateDoubleMatrix(3, 1, mxREAL);
    double* const to = mxGetPr(array);
    to[0] = v.x * by, to[1] = v.y * by, to[2] = v.z * by;
    return array;
}

void mexFunction(int outputs, mxArray* output[], int inputs, const mxArray* input[]) {
    char what[16] = "";
    (void)outputs;
    if (inputs < 1 || mxGetString(input[0], what, sizeof what) != 0) mexErrMsgTxt("knurl_mex: what to do?");
    knurl_hand* hand = inputs > 1 ? (knurl_hand*)(uintptr_t) * (const uint64_t*)mxGetData(input[1]) : NULL;
    if (strcmp(what, "claim") == 0) {
        check(knurl_connect(NULL, NULL, &client));
        check(knurl_claim(client, NULL, NULL, &hand));
        output[0] = number64((uintptr_t)hand);
    } else if (strcmp(what, "centre") == 0) {
        knurl_device device = {.size = sizeof device};
        check(knurl_device_of(hand, &device));
        output[0] = vector(device.workspace_centre, 1);
    } else if (strcmp(what, "add_plane") == 0 && inputs == 4) {
        knurl_plane plane;
        knurl_id id = 0;
        knurl_default_plane(&plane);
        plane.offset = mxGetScalar(input[2]);
        plane.stiffness = mxGetScalar(input[3]);
        check(knurl_add_plane(hand, &plane, NULL, &id));
        output[0] = number64(id);
    } else if (strcmp(what, "arm") == 0) {
        check(knurl_arm(hand));
    } else if (strcmp(what, "commit") == 0) {
        check(knurl_commit(hand, NULL));
        check(knurl_wait_applied(hand, 0, 50000000));
    } else if (strcmp(what, "force") == 0 && inputs == 3) {
        knurl_feedback felt = {.size = sizeof felt};
        check(knurl_feedback_of(hand, *(const uint64_t*)mxGetData(input[2]), &felt));
        output[0] = vector(felt.force, felt.share);
    } else if (strcmp(what, "close") == 0) {
        check(knurl_close(client));
    } else {
        mexErrMsgTxt("knurl_mex: no such thing to do, or too few arguments");
    }
}
