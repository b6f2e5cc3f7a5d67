// knurl-proxy: a bad network by hand. Prints what it did when it is interrupted.

#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include <CLI/CLI.hpp>

#include "proxy.hpp"

int main(int argc, char** argv) try {
    using namespace knurl::bridge::proxy;
    CLI::App app(
        "Carries one TCP and UDP port to another host's, badly: loses, delays, reorders, doubles, cuts.");
    Proxy::Options options;
    double cut_after = 0, cut_for = 0;
    Weather& w = options.weather;
    app.add_option("--listen", options.listen, "IPv4 address")->capture_default_str();
    app.add_option("--port", options.port, "port; 0: any")->capture_default_str();
    app.add_option("--to", options.to, "the server's IPv4 address")->capture_default_str();
    app.add_option("--to-port", options.to_port, "the server's port")->required();
    app.add_option("--seed", options.seed, "the same seed, the same fates")->capture_default_str();
    app.add_option("--loss", w.loss, "chance, 0 to 1")->check(CLI::Range(0.0, 1.0));
    app.add_option("--duplicate", w.duplicate, "chance, 0 to 1")->check(CLI::Range(0.0, 1.0));
    app.add_option("--reorder", w.reorder, "chance, 0 to 1")->check(CLI::Range(0.0, 1.0));
    app.add_option("--delay", w.delay, "s, each way")->check(CLI::Range(0.0, 10.0));
    app.add_option("--jitter", w.jitter, "s, each datagram by itself")->check(CLI::Range(0.0, 10.0));
    app.add_option("--swing", w.swing, "s, a delay that goes up and down")->check(CLI::Range(0.0, 10.0));
    app.add_option("--cut-after", cut_after, "s until the cable is pulled; 0: never")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--cut-for", cut_for, "s until it is back")->check(CLI::NonNegativeNumber);
    CLI11_PARSE(app, argc, argv);

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
                options.to.c_str(), unsigned{options.to_port}, static_cast<unsigned long long>(options.seed));
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
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
