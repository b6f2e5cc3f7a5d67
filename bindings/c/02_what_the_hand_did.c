// Every report of the device as a line of CSV, though the program looks only now and then. It holds nothing: whoever has the device
// goes on. (A device that nobody has claimed rests, and reports about once a second.)

#include "example.h"

int main(int argc, char** argv) {
    const double seconds = seconds_of(argc, argv, 10);
    knurl_client* client = NULL;
    knurl_hand* hand = NULL;
    check(knurl_connect(NULL, NULL, &client));
    check(knurl_observe(client, NULL, &hand));

    enum { MANY = 256 };
    static knurl_report reports[MANY];
    int64_t first_ns = 0;
    double time = 0;
    printf("time,x,y,z,vx,vy,vz,fx,fy,fz,buttons\n");
    while (time < seconds) {
        size_t count = 0;
        // Sleeps until there is one, and takes the others that have come meanwhile.
        reports[0].size = reports[1].size = sizeof reports[0];
        const int code = knurl_next_report(hand, 100000000, &reports[0]);
        check(code);
        if (code == KNURL_NOTHING) continue;
        check(knurl_reports(hand, &reports[1], MANY - 1, &count));
        for (size_t i = 0; i <= count && time < seconds; ++i) {
            const knurl_report* r = &reports[i];
            if (first_ns == 0) first_ns = r->read_ns;
            time = (double)(r->read_ns - first_ns) * 1e-9;
            printf("%.6f,%.6g,%.6g,%.6g,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%u\n", time, r->position.x,
                   r->position.y, r->position.z, r->velocity.x, r->velocity.y, r->velocity.z, r->sent_force.x,
                   r->sent_force.y, r->sent_force.z, (unsigned)r->buttons);
        }
    }
    uint64_t missed = 0;
    check(knurl_missed(hand, &missed));
    fprintf(stderr, "%llu reports were missed\n", (unsigned long long)missed);
    check(knurl_close(client));
    return 0;
}
