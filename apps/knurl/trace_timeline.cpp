#include "trace_timeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include <knurl/measure/measure.hpp>

namespace knurl::cli {

namespace {

using knurl::Json;

constexpr int process = 1, cycles_track = 1, deadlines_track = 2;

double size_of(const Vec3& v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

Nanoseconds lateness(const Report& report) {
    return report.read_ns - report.deadline_ns;
}

const CycleParts* parts_of(const Timeline& timeline, std::uint64_t cycle) {
    const auto found = std::ranges::find(timeline.parts, cycle, &CycleParts::cycle);
    return found == timeline.parts.end() ? nullptr : &*found;
}

/// The index of a cycle, if it is among the reports.
std::optional<std::size_t> place_of(const Timeline& timeline, std::uint64_t cycle) {
    const auto found = std::ranges::lower_bound(timeline.reports, cycle, {}, &Report::cycle);
    if (found == timeline.reports.end() || found->cycle != cycle) return std::nullopt;
    return static_cast<std::size_t>(found - timeline.reports.begin());
}

/// Writes events with times relative to the first one.
class Writer {
  public:
    explicit Writer(Nanoseconds zero) : zero_(zero) {}

    void span(const std::string& name, Nanoseconds begin, Nanoseconds end, Json arguments) {
        Json event = {{"name", name},           {"ph", "X"},      {"ts", us(begin - zero_)},
                      {"dur", us(end - begin)}, {"pid", process}, {"tid", cycles_track}};
        if (!arguments.is_null()) event["args"] = std::move(arguments);
        events.push_back(std::move(event));
    }
    void deadline(const Report& report) {
        events.push_back({{"name", fmt::format("deadline {}", report.cycle)},
                          {"ph", "i"},
                          {"s", "t"},
                          {"ts", us(report.deadline_ns - zero_)},
                          {"pid", process},
                          {"tid", deadlines_track}});
    }
    void counter(const char* name, Nanoseconds at, Json values) {
        events.push_back({{"name", name},
                          {"ph", "C"},
                          {"ts", us(at - zero_)},
                          {"pid", process},
                          {"args", std::move(values)}});
    }
    void label(const char* what, int track, const std::string& name) {
        events.push_back(
            {{"name", what}, {"ph", "M"}, {"pid", process}, {"tid", track}, {"args", {{"name", name}}}});
    }

    Json events = Json::array();

  private:
    static double us(Nanoseconds t) { return static_cast<double>(t) * 1e-3; }
    Nanoseconds zero_;
};

/// Draws one cycle, from `free` (the end of the previous one) at the earliest. Returns the end of this one.
Nanoseconds draw(Writer& writer, const Report& report, const CycleParts* parts, bool late, Nanoseconds free) {
    const Nanoseconds from = std::max(report.deadline_ns, free);
    const Nanoseconds read = std::max(report.read_ns, from);
    Nanoseconds begin = read, end = std::max(report.write_ns, read);
    if (parts != nullptr) {
        begin = std::max(from, read - parts->ns[0] - parts->ns[1]);
        end = std::accumulate(parts->ns.begin(), parts->ns.end(), begin);
    }
    writer.span(fmt::format("cycle {}{}", report.cycle, late ? " (late)" : ""), from, end,
                {{"late_us", static_cast<double>(lateness(report)) * 1e-3},
                 {"state", static_cast<std::uint32_t>(report.state)},
                 {"faults", report.faults},
                 {"flags", report.flags},
                 {"late_count", report.late_count}});
    if (parts == nullptr) {
        writer.span("until read", from, read, {});
        writer.span("until written", read, end, {});
        return end;
    }
    writer.span("asleep too long", from, begin, {});
    for (std::size_t i = 0; i < cycle_parts.size(); begin += parts->ns[i++])
        writer.span(std::string(cycle_parts[i]), begin, begin + parts->ns[i], {});
    return end;
}

bool was_late(const Timeline& timeline, std::size_t i) {
    return i > 0 && timeline.reports[i].late_count > timeline.reports[i - 1].late_count;
}

}  // namespace

void PartsWatch::look(const DeviceView& device, std::uint64_t before, std::uint64_t after) {
    // The stamped cycle publishes its parts at its very end, so they are there when a later cycle has been
    // reported. And the next stamped cycle must not have begun.
    if (before % every == 0 || before / every != after / every) return;
    const auto count = [&device](const std::string& name) {
        const auto found = device.counters.find(name);
        return found == device.counters.end() ? std::uint64_t{0} : found->second;
    };
    Sums now{.cycle = before - before % every, .stamped = count("stamped_cycles")};
    for (std::size_t i = 0; i < cycle_parts.size(); ++i)
        now.ns[i] = count(std::string(cycle_parts[i]) + "_ns");
    if (last_ && now.stamped == last_->stamped + 1 && now.cycle == last_->cycle + every) {
        CycleParts& parts = seen_.emplace_back();
        parts.cycle = now.cycle;
        for (std::size_t i = 0; i < now.ns.size(); ++i)
            parts.ns[i] = static_cast<Nanoseconds>(now.ns[i] - last_->ns[i]);
    }
    last_ = now;
}

Stretch choose(const Timeline& timeline, Around around, std::size_t neighbours) {
    const std::vector<Report>& reports = timeline.reports;
    Stretch stretch{.middle = reports.size() - 1};
    if (around == Around::late) {
        const auto latest = std::ranges::max_element(reports, {}, lateness);
        stretch.middle = static_cast<std::size_t>(latest - reports.begin());
        for (std::size_t i = reports.size(); i-- > 0 && !stretch.late;) {
            stretch.late = was_late(timeline, i);
            if (stretch.late) stretch.middle = i;
        }
    }
    // The nearest cycle with parts: one in 64 has them, if it was watched.
    std::size_t nearest = 0, distance = std::numeric_limits<std::size_t>::max();
    for (const CycleParts& parts : timeline.parts) {
        const auto place = place_of(timeline, parts.cycle);
        if (!place) continue;
        const std::size_t away = *place > stretch.middle ? *place - stretch.middle : stretch.middle - *place;
        if (away >= distance) continue;
        nearest = *place;
        distance = away;
    }
    const bool known = distance < std::numeric_limits<std::size_t>::max();
    if (known && around == Around::last) stretch.middle = nearest;
    stretch.begin = stretch.middle - std::min(stretch.middle, neighbours);
    stretch.end = std::min(reports.size(), stretch.middle + neighbours + 1);
    // A cycle further away than stamped cycles are from each other says nothing about this moment.
    if (known && distance <= std::max<std::size_t>(neighbours, PartsWatch::every)) {
        stretch.begin = std::min(stretch.begin, nearest);
        stretch.end = std::max(stretch.end, nearest + 1);
        stretch.stamped = reports[nearest].cycle;
    }
    return stretch;
}

Json to_trace(const Timeline& timeline, const Stretch& stretch) {
    const Nanoseconds zero = timeline.reports[stretch.begin].deadline_ns;
    Writer writer(zero);
    writer.label("process_name", cycles_track, "knurl:" + timeline.servo);
    writer.label("thread_name", cycles_track, fmt::format("{} ({})", timeline.device, timeline.address));
    writer.label("thread_name", deadlines_track, "deadlines");
    Nanoseconds free = zero;
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
        const Report& report = timeline.reports[i];
        const CycleParts* parts = parts_of(timeline, report.cycle);
        free = draw(writer, report, parts, was_late(timeline, i), free);
        writer.deadline(report);
        writer.counter("lateness", report.read_ns, {{"us", static_cast<double>(lateness(report)) * 1e-3}});
        writer.counter("force", report.write_ns,
                       {{"scene N", size_of(report.scene_force)}, {"sent N", size_of(report.sent_force)}});
    }
    const measure::Machine machine = measure::this_machine();
    return {
        {"traceEvents", std::move(writer.events)},
        {"displayTimeUnit", "ns"},
        {"otherData",
         {{"servo", timeline.servo},
          {"device", timeline.device},
          {"address", timeline.address},
          {"rate", timeline.rate},
          {"zero_ns", zero},
          {"about_cycle", timeline.reports[stretch.middle].cycle},
          {"stamped_cycle", stretch.stamped ? Json(*stretch.stamped) : Json()},
          {"cause", timeline.cause.empty() ? Json() : Json(timeline.cause)},
          {"machine", fmt::format("{}, {} CPUs, Linux {}", machine.processor, machine.cpus, machine.kernel)},
          {"date", machine.date}}}};
}

}  // namespace knurl::cli
