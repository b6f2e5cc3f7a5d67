// knurl trace: one cycle and its neighbours on a timeline, for chrome://tracing or ui.perfetto.dev.
// Read-only: it costs the servo nothing.

#include <algorithm>
#include <iostream>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/json/json.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/view/servo_view.hpp>

#include "trace_flight.hpp"
#include "trace_timeline.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

using measure::now_ns, measure::sleep_until;

// for a servo that stands still, and for a stamped cycle
constexpr Nanoseconds patience = 1'000'000'000;

struct TraceArguments {
    std::string out;
    std::string servo = "default", device;  // device: empty: the only one
    std::string around = "last";
    std::string from;  // a flight record; empty: a running servo
    std::size_t cycles = 8;
    double seconds = 0.5;
};

std::size_t find_device(const ServoView& view, const TraceArguments& arguments) {
    std::vector<std::string> names;
    for (const DeviceView& device : view.devices) names.emplace_back(device.info.name);
    return chosen_device(arguments.servo, names, arguments.device);
}

/// Reads a servo's counters so often that the parts of each stamped cycle can be separated.
Timeline watch(TraceArguments arguments) {
    const protocol::ServoAddress address = servo_said(arguments.servo);
    arguments.servo = address.name;
    ServoWatch servo(address);
    ServoView view = servo.look();
    const std::size_t place = find_device(view, arguments);
    const protocol::DeviceInfo info = view.devices[place].info;  // the view changes
    const auto newest = [&view, place] {
        const auto& report = view.devices[place].report;
        return report ? report->cycle : 0;
    };
    PartsWatch parts;
    const Nanoseconds begin = now_ns(), end = begin + static_cast<Nanoseconds>(arguments.seconds * 1e9);
    const auto pace = static_cast<Nanoseconds>(8e9 / info.rate);
    const std::uint64_t first = newest();
    for (Nanoseconds now = begin; now < end || (parts.seen().empty() && now < end + patience);
         now = now_ns()) {
        // Two looks, so that the counters of the second belong to a moment between two close reports.
        const std::uint64_t before = (view = servo.look(), newest());
        view = servo.look();
        parts.look(view.devices[place], before, newest());
        sleep_until(now_ns() + pace);
        if (before == first && now > begin + patience)
            throw std::runtime_error(
                fmt::format("knurl:{} (pid {}) stands still or has ended; a servo that died left "
                            "a flight record, which --from reads",
                            arguments.servo, view.pid));
    }
    Timeline timeline{.servo = arguments.servo,
                      .device = info.name,
                      .address = info.address,
                      .rate = info.rate,
                      .reports = servo.history(place),
                      .parts = parts.seen(),
                      .cause = {}};
    if (timeline.reports.empty()) throw std::runtime_error("the servo has not reported a cycle yet");
    return timeline;
}

Timeline from_file(const TraceArguments& arguments) {
    bool cut = false;
    Timeline timeline = read_flight_record(arguments.from, cut);
    if (cut)
        fmt::print(stderr, "knurl trace: {}: its last line is not whole, and is left out\n", arguments.from);
    return timeline;
}

std::string sentence(const Timeline& timeline, const Stretch& stretch, Around around) {
    const Report& middle = timeline.reports[stretch.middle];
    std::string text = fmt::format("{} cycles of {} around cycle {}, read {:.1f} us after its deadline",
                                   stretch.end - stretch.begin, timeline.device, middle.cycle,
                                   static_cast<double>(middle.read_ns - middle.deadline_ns) * 1e-3);
    if (around == Around::late && !stretch.late)
        text += fmt::format(" (none of {} was late; no other was read as late)", timeline.reports.size());
    text += stretch.stamped ? fmt::format("; cycle {} in all its parts", *stretch.stamped)
                            : "; the parts of no cycle are known";
    return text;
}

int run_trace(const TraceArguments& arguments) {
    if (arguments.cycles < 1 || arguments.cycles > 2000)
        throw UsageError(fmt::format("--cycles is {}; give 1 to 2000", arguments.cycles));
    if (!(arguments.seconds >= 0.1 && arguments.seconds <= 10))
        throw UsageError(fmt::format("--for is {:g} s; give 0.1 to 10", arguments.seconds));
    const Timeline timeline = arguments.from.empty() ? watch(arguments) : from_file(arguments);
    const Around around = arguments.around == "late" ? Around::late : Around::last;
    const Stretch stretch = choose(timeline, around, arguments.cycles);
    const std::string text = to_trace(timeline, stretch).dump(1) + "\n";
    measure::write_file(arguments.out, text);
    if (arguments.out == "-") return 0;
    fmt::print("{}: {}\nOpen it in chrome://tracing or https://ui.perfetto.dev.\n", arguments.out,
               sentence(timeline, stretch, around));
    return 0;
}

}  // namespace

void add_trace(commandline::Command& program) {
    auto& verb = program.verb("trace", "One cycle and its neighbours on a timeline: where the time went");
    auto arguments = std::make_shared<TraceArguments>();
    verb.option("--out", arguments->out, "trace JSON, as Chrome and Perfetto read it; - is standard output")
        .required()
        .type_name("T.json");
    verb.servo(arguments->servo, "its name").shows_default();
    verb.option("--device", arguments->device, "which of its devices; default: the only one")
        .type_name("NAME");
    verb.option("--around", arguments->around,
                "the newest cycle whose parts are known, or the newest that was late")
        .shows_default()
        .one_of({"last", "late"});
    verb.option("--cycles", arguments->cycles, "on each side of it").shows_default().type_name("N");
    verb.option("--for", arguments->seconds, "to watch, for the parts of cycles")
        .shows_default()
        .type_name("SECONDS");
    verb.option("--from", arguments->from,
                "a flight record that the guardian of a dead servo saved; it has no parts")
        .type_name("FILE.csv")
        .excludes({"--servo", "--device"});
    verb.footer(
        "A servo keeps its newest 4095 reports, and stamps the parts of one cycle in 64; such a one is drawn "
        "with "
        "all of them, the others until the device was read and until it was written.\n"
        "A cycle begins at its deadline, or when the one before it ended; it is late if it ends after the "
        "next "
        "deadline.");
    verb.action([arguments] { return run_trace(*arguments); });
}

}  // namespace knurl::cli
