// knurl-proxy: a bad network as a program. Prints its counts when it is interrupted.

#include <csignal>
#include <cstdio>
#include <string>

#include <knurl/commandline/program.hpp>

#include "proxy.hpp"

int main(int argc, char** argv) {
    using namespace knurl::bridge::proxy;
    knurl::commandline::Command app(
        "knurl-proxy",
        "Carries one TCP and UDP port to another host's, badly: loses, delays, reorders, doubles, cuts.");
    Proxy::Options options;
    double cut_after = 0, cut_for = 0;
    NetworkProfile& w = options.profile;
    app.option("--listen", options.listen, "IPv4 address").shows_default();
    app.option("--port", options.port, "port; 0: any").shows_default();
    app.option("--to", options.to, "the server's IPv4 address").shows_default();
    app.option("--to-port", options.to_port, "the server's port").required();
    app.option("--seed", options.seed, "the same seed, the same fates").shows_default();
    app.option("--loss", w.loss, "chance, 0 to 1").within(0.0, 1.0);
    app.option("--duplicate", w.duplicate, "chance, 0 to 1").within(0.0, 1.0);
    app.option("--reorder", w.reorder, "chance, 0 to 1").within(0.0, 1.0);
    app.option("--delay", w.delay, "s, each way").within(0.0, 10.0);
    app.option("--jitter", w.jitter, "s, each datagram by itself").within(0.0, 10.0);
    app.option("--swing", w.swing, "s, a delay that goes up and down").within(0.0, 10.0);
    app.option("--cut-after", cut_after, "s until the cable is pulled; 0: never").not_negative();
    app.option("--cut-for", cut_for, "s until it is back").not_negative();
    app.action([&] {
        sigset_t ends;
        sigemptyset(&ends);
        sigaddset(&ends, SIGINT);
        sigaddset(&ends, SIGTERM);
        pthread_sigmask(SIG_BLOCK, &ends, nullptr);
        const auto wait = [&](double s) {
            const timespec limit{
                .tv_sec = static_cast<time_t>(s),
                .tv_nsec = static_cast<long>((s - static_cast<double>(static_cast<time_t>(s))) * 1e9)};
            return sigtimedwait(&ends, nullptr, &limit) > 0;
        };

        Proxy proxy(options);
        std::printf("%s:%u -> %s:%u, seed %llu\n", options.listen.c_str(), unsigned{proxy.port()},
                    options.to.c_str(), unsigned{options.to_port},
                    static_cast<unsigned long long>(options.seed));
        std::fflush(stdout);
        bool ended = false;
        if (cut_after > 0) {
            ended = wait(cut_after);
            proxy.cut();
            ended = ended || wait(cut_for);
            proxy.heal();
        }
        if (!ended) sigwaitinfo(&ends, nullptr);
        const Counts c = proxy.counts();
        const char* names[] = {"forth", "back"};
        for (int way = 0; way < 2; ++way)
            std::printf("%s: %llu datagrams, %llu lost, %llu doubled, %llu delivered\n", names[way],
                        static_cast<unsigned long long>(c.datagrams[way]),
                        static_cast<unsigned long long>(c.lost[way]),
                        static_cast<unsigned long long>(c.doubled[way]),
                        static_cast<unsigned long long>(c.delivered[way]));
        return 0;
    });
    return knurl::commandline::run(app, argc, argv);
}
