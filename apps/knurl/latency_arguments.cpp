#include "latency_arguments.hpp"

#include <fmt/format.h>

#include <knurl/client/address.hpp>
#include <knurl/measure/measure.hpp>

#include "verbs.hpp"

namespace knurl::cli {

void check(const LatencyArguments& arguments) {
    if (arguments.updates < 1)
        throw UsageError("--updates is 0; give 1 or more (10000 for a 99.9th percentile)");
    if (!(arguments.rate >= 500 && arguments.rate <= 20'000)) {
        throw UsageError(fmt::format("--rate is {:g} Hz; give 500 to 20000 Hz", arguments.rate));
    }
    if (!(arguments.wait >= 0 && arguments.wait <= 3600)) {
        throw UsageError(fmt::format("--wait is {:g} s; give 0 to 3600 s", arguments.wait));
    }
    if (!(arguments.seconds >= 0 && arguments.seconds <= 1e6))
        throw UsageError(fmt::format("--for is {:g} s; give up to 1000000 s", arguments.seconds));
    if (!(arguments.percentile >= 0 && arguments.percentile < 100))
        throw UsageError(
            fmt::format("--percentile is {:g}; give one between 0 and 100", arguments.percentile));
    const std::size_t needed = arguments.percentile > 0 ? measure::needed_for(arguments.percentile / 100) : 0;
    if (arguments.seconds == 0 && arguments.measured.empty() && needed > arguments.updates)
        throw UsageError(
            fmt::format("--percentile {:g} of {} updates would have fewer than ten of them above it; "
                        "give --updates {}",
                        arguments.percentile, arguments.updates, needed));
    if (!arguments.measured.empty() && arguments.compare.empty())
        throw UsageError("--measured is compared with an earlier run; name that by --compare OLD.json");
}

std::function<void()> add_latency_options(commandline::Command& verb, LatencyArguments& arguments) {
    verb.servo(arguments.connect,
               "measure this servo, whose device is armed and feels forces of 4 mN at most; "
               "default: a private one on sim:cartesian3")
        .type_name("knurl:NAME|knurl://HOST:PORT")
        .checked(check_address);
    verb.option("--echo", arguments.echo,
                "a plain UDP and TCP echo on the servo's host: the floors of a measurement over a "
                "network; default: one of its own, where that is this host")
        .type_name("HOST:PORT");
    verb.option("--serve-echo", arguments.serve_echo,
                "runs that echo until interrupted, and measures nothing")
        .type_name("HOST:PORT");
    verb.option("--device", arguments.device, "which of its devices; default: the only one")
        .type_name("NAME");
    verb.option("--updates", arguments.updates, "at random phase, and at least a quarter as many commands")
        .shows_default()
        .type_name("N");
    verb.option(
            "--for", arguments.seconds,
            "measure for that long, whatever the number of updates; hours take no more memory than minutes")
        .type_name("SECONDS")
        .excludes({"--updates"});
    verb.option("--percentile", arguments.percentile,
                "one more than the table has; refused where it would have fewer than ten samples above it")
        .type_name("P");
    verb.option("--load", arguments.load,
                "a thread of ordinary priority on each CPU meanwhile: spin counts, memory moves 32 MiB "
                "to and fro")
        .shows_default()
        .one_of({"none", "spin", "memory"});
    verb.option("--compare", arguments.compare,
                "an earlier run's --json: what became better or worse since, and what may be noise")
        .type_name("OLD.json");
    verb.option("--measured", arguments.measured, "compare this run of --json's, and measure nothing")
        .type_name("NEW.json");
    verb.option("--rate", arguments.rate, "of the private servo").shows_default().type_name("HZ");
    verb.option("--servo-cpu", arguments.servo_cpu, "where the servo runs; default: the last CPU")
        .within(0, 1023)
        .type_name("CPU");
    verb.option(
            "--priority", arguments.priority,
            "SCHED_FIFO, of the client's thread: what it would see on a CPU of its own; default: ordinary")
        .within(1, 79)
        .type_name("N");
    verb.option("--seed", arguments.seed, "of the random phases").shows_default().type_name("N");
    verb.option("--wait", arguments.wait, "for a servo that is still starting")
        .shows_default()
        .type_name("SECONDS");
    auto& json = verb.option("--json", arguments.json_file, "for programs, into FILE or standard output")
                     .value_may_be_missing()
                     .type_name("FILE");
    verb.footer(
        "A bridge that asks for keys: KNURL_KEY names the file with yours, as for every application "
        "(KNURL_KEY=~/anna.key knurl latency --servo knurl://lab:4096).\n"
        "A percentile with fewer than ten samples above it is left out (null).\n"
        "Coordinated omission: a program that waits for a late answer before its next request makes too few "
        "requests just when answers are late. So updates count from the times at which they should have been "
        "sent. Where samples are due at a fixed rate, a sample that took longer also stands for those that "
        "it delayed.\nCtrl-C ends a measurement: its results so far are printed.");
    return [&arguments, &json] {
        arguments.json = json.given();
        if (arguments.json_file.empty()) arguments.json_file = "-";
    };
}

}  // namespace knurl::cli
