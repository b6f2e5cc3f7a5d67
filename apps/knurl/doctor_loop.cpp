#include "doctor_loop.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <knurl/client/client.hpp>

namespace knurl::cli {

namespace {

using namespace std::chrono_literals;

constexpr int loop_priority = 80, loop_witness_priority = 90;
constexpr Nanoseconds settling = 100'000'000;  // after arming: first page faults, ramp
constexpr Nanoseconds looking_pace = 2'000'000;
// The witness sleeps 1 ms at a time, so it may notice a standstill later than the loop.
constexpr Nanoseconds same_time = 2'000'000;

}  // namespace

std::unique_ptr<Witness> witness_on(unsigned cpu) {
    auto witness = std::make_unique<Witness>(std::vector{cpu}, loop_witness_priority);
    if (witness->watching() == 0) witness.reset();
    return witness;
}

Beginnings bare_loop(double rate, unsigned cpu, Nanoseconds length, const std::atomic<bool>& stop) {
    const auto period = static_cast<Nanoseconds>(std::llround(1e9 / rate));
    return measure::bare_loop({.cpu = cpu,
                               .priority = loop_priority,
                               .first = now_ns() + period,
                               .period = period,
                               .length = length,
                               .stop = &stop});
}

Beginnings servo_loop(const std::string& address, Nanoseconds length, const std::atomic<bool>& stop) {
    ConnectOptions options;
    options.name = "knurl doctor";
    options.wait = 10s;
    options.reattach = false;
    Client client = Client::connect(address, options);
    Claim hand = client.claim();
    hand.add(Plane{.stiffness = 500});
    hand.arm();
    hand.commit();
    Beginnings seen;
    const Nanoseconds begin = now_ns() + settling, end = begin + length;
    for (Nanoseconds now = now_ns(); now < end && !stop; now = now_ns()) {
        // Does not wait for reports: waking this thread for each would be extra work for the servo.
        sleep_until(now + looking_pace);
        while (const auto report = hand.next_report(0ns)) {
            if (report->deadline_ns < begin || report->deadline_ns >= end) continue;
            seen.deadline.push_back(report->deadline_ns);
            seen.late.push_back(report->read_ns - report->deadline_ns);
        }
        hand.commit();
        if (!hand.connected()) throw std::runtime_error("the servo ended during the measurement");
    }
    hand.release();
    return seen;
}

Stalls take_out_stalls(Beginnings& beginnings, const std::vector<Gap>& gaps) {
    Stalls stalls;
    Beginnings kept;
    auto gap = gaps.begin();
    const Gap* last = nullptr;
    for (std::size_t i = 0; i < beginnings.deadline.size(); ++i) {
        const Nanoseconds deadline = beginnings.deadline[i], begun = deadline + beginnings.late[i];
        while (gap != gaps.end() && gap->end + same_time < deadline) ++gap;
        const bool stalled =
            beginnings.late[i] >= Witness::long_gap && gap != gaps.end() && gap->begin - same_time < begun;
        if (!stalled) {
            kept.deadline.push_back(deadline);
            kept.late.push_back(beginnings.late[i]);
            continue;
        }
        if (last != &*gap) ++stalls.count;
        last = &*gap;
        stalls.longest = std::max(stalls.longest, beginnings.late[i]);
    }
    beginnings = std::move(kept);
    return stalls;
}

}  // namespace knurl::cli
