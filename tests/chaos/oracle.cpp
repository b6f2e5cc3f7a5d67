#include "oracle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knurl::chaos {

namespace {

std::string line(const char* what, const Record& record, double is, double limit) {
    char text[160];
    std::snprintf(text, sizeof text, "%s at device time %.6f s: %.4g, allowed %.4g", what,
                  static_cast<double>(record.t) * 1e-9, is, limit);
    return text;
}

double apart(const Record& a, const Record& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.force.size(); ++i)
        sum += (a.force[i] - b.force[i]) * (a.force[i] - b.force[i]);
    return std::sqrt(sum);
}

}  // namespace

double force_of(const Record& record) {
    return std::hypot(record.force[0], record.force[1], record.force[2]);
}

std::vector<std::string> check_always(const std::vector<Record>& log, double peak_force, double slew,
                                      double period) {
    std::vector<std::string> wrong;
    const Record* last = nullptr;
    for (const Record& record : log) {
        const double force = force_of(record);
        if (!std::isfinite(force)) wrong.push_back(line("not finite", record, force, 0));
        // Efforts have 15 bits on the way to the device; 0.1 % allows for their rounding.
        if (force > peak_force * (1 + 1e-3)) wrong.push_back(line("force", record, force, peak_force));
        if (last != nullptr && is_write(record) && force > force_of(*last)) {
            // A late servo's writes may arrive close together. So the rise of `missed` + 1 cycles is allowed,
            // whatever the time between the writes.
            const double cycles = std::max(
                1.0 + record.missed, std::ceil(static_cast<double>(record.t - last->t) * 1e-9 / period));
            const double allowed = slew * period * (cycles + 1);
            if (apart(record, *last) > allowed)
                wrong.push_back(line("step", record, apart(record, *last), allowed));
        }
        last = &record;
    }
    return wrong;
}

std::int64_t zero_since(const std::vector<Record>& log, std::int64_t from) {
    std::int64_t since = -1;
    bool zero = true;
    for (const Record& record : log) {
        const bool now = force_of(record) <= 0;
        if (now && (!zero || since < from)) since = std::max(record.t, from);
        zero = now;
    }
    return zero ? since : -1;
}

double largest_force(const std::vector<Record>& log, std::int64_t from) {
    double largest = 0;
    for (const Record& record : log)
        if (record.t >= from) largest = std::max(largest, force_of(record));
    return largest;
}

Span force_span(const std::vector<Record>& log, std::int64_t from) {
    Span span{1e300, 0};
    double before = 0;
    for (const Record& record : log) {
        if (record.t < from) {
            before = force_of(record);
            continue;
        }
        span.smallest = std::min(span.smallest, force_of(record));
        span.largest = std::max(span.largest, force_of(record));
    }
    return {std::min(span.smallest, before), std::max(span.largest, before)};
}

std::string how_it_fell(const std::vector<Record>& log, std::int64_t from) {
    const auto first = std::ranges::find_if(log, [&](const Record& record) { return record.t >= from; });
    if (first == log.end()) return "nothing was written";
    const auto lowest = std::ranges::min_element(first, log.end(), {}, force_of);
    std::int64_t still = 0, still_since = from, high = from;
    for (auto record = first; record != lowest; ++record) {
        if (force_of(*record) > 1) high = record->t;
        if ((record + 1)->t - record->t <= still) continue;
        still = (record + 1)->t - record->t;
        still_since = record->t;
    }
    const auto ms = [&](std::int64_t t) { return std::to_string(static_cast<double>(t) * 1e-6) + " ms"; };
    return "lowest after " + ms(lowest->t - from) + " by " +
           (lowest->event == Event::guardian_write ? "the guardian" : "the servo") +
           ", last above 1 N after " + ms(high - from) + ", unchanged for " + ms(still) + " from " +
           ms(still_since - from);
}

}  // namespace knurl::chaos
