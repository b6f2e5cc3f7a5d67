// The whole cycle on the 3-axis arm, and with all features at once on the 6-axis one: read, kinematics,
// drain, plane with cross-fade, supervisor, Jacobian, write, report, feedback. The device's own dynamics are
// not included: its joints are a table. `read_and_kinematics` is the part that any loop has, in the same run.
//
//   knurl_bench_cycle --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
//
// Compare the medians.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include <knurl/reps/plane.hpp>
#include <knurl/reps/spring.hpp>
#include <knurl/servo/input_log.hpp>
#include <knurl/servo/offline.hpp>
#include <knurl/servo/scene_log.hpp>

#include "table_arm.hpp"

namespace knurl::servo {
namespace {

/// A servo with CLOCK_MONOTONIC's stamps whose cycles follow each other without a pause.
struct Rig {
    TableArm arm;
    MonotonicClock clock;
    OfflineMemory segment{protocol::device_layout().total};
    Servo servo;
    std::vector<std::unique_ptr<OfflineClaim>> claims;
    Nanoseconds now = 0;

    explicit Rig(int claim_count, std::string_view device = "premium15", std::uint32_t representations = 128)
        : arm(device), servo(arm, clock, segment.data(), options()) {
        for (int i = 0; i < claim_count; ++i) {
            ClaimTerms terms;
            terms.limits = limits_for(arm.link(), 1000, terms.frame);
            terms.capacity.representations = representations;
            if (representations > 128) terms.capacity.batch_bytes = protocol::max_batch_bytes;
            claims.push_back(std::make_unique<OfflineClaim>(terms));
            servo.adopt(&claims.back()->servo_side());
            step();
        }
    }
    static ServoOptions options() {
        ServoOptions o;
        o.start_active = true;
        o.silence = false;
        return o;
    }
    void step() {
        servo.step(now, now);
        now += 1'000'000;
    }
};

void read_and_kinematics(benchmark::State& state) {
    TableArm arm;
    MonotonicClock clock;
    drivers::JointSample sample;
    drivers::TipPose pose;
    drivers::Jacobian jacobian;
    for (auto _ : state) {
        arm.read(0, sample);
        benchmark::DoNotOptimize(clock.now());
        arm.mechanism().forward(std::span<const double>(sample.position.data(), 3), pose, jacobian);
        benchmark::DoNotOptimize(jacobian);
        arm.write(0, {});
        benchmark::DoNotOptimize(clock.now());
    }
}
BENCHMARK(read_and_kinematics);

void cycle_without_claims(benchmark::State& state) {
    Rig rig(0);
    for (auto _ : state) rig.step();
}
BENCHMARK(cycle_without_claims);

/// The cost of an onlooker: two servos, one of them looked at, alternate in blocks of 50 cycles. Each is in contact with
/// a plane that changes before every block (20 Hz at 1 kHz). CPU time of this thread; `more_percent` is the relative
/// difference of the medians of all blocks.
template <class Begin>
void compare_with_onlooker(benchmark::State& state, Begin begin_looking) {
    Rig plain(1), seen(1);
    begin_looking(seen.servo);
    Plane plane{.offset = 1.0, .stiffness = 20, .recovery = 0.05};
    struct Side {
        Rig& rig;
        RepresentationId id;
        std::vector<double> blocks = {};  // ns a cycle
    } sides[] = {{plain, plain.claims[0]->add(plane)}, {seen, seen.claims[0]->add(plane)}};
    const auto cpu_ns = [] {
        timespec t{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
    };
    for (auto _ : state) {
        plane.offset = plane.offset > 1 ? 1 : 1 + 1e-4;
        for (Side& side : sides) {
            side.rig.claims[0]->update(side.id, plane);
            side.rig.claims[0]->commit();
            const double begin = cpu_ns();
            for (int i = 0; i < 50; ++i) side.rig.step();
            side.blocks.push_back((cpu_ns() - begin) / 50);
        }
    }
    const auto median = [](std::vector<double>& blocks) {
        const auto middle = blocks.begin() + static_cast<std::ptrdiff_t>(blocks.size() / 2);
        std::nth_element(blocks.begin(), middle, blocks.end());
        return *middle;
    };
    const double without = median(sides[0].blocks), with = median(sides[1].blocks);
    state.counters["plain_ns"] = without;
    state.counters["seen_ns"] = with;
    state.counters["more_percent"] = 100 * (with / without - 1);
    if (InputLog::written(memory.data()) < 50 * static_cast<std::uint64_t>(state.iterations()))
        state.SkipWithError("nothing was recorded");
}

void cycle_that_is_recorded(benchmark::State& state) {
    OfflineMemory memory(input_log_bytes);
    InputLog input_log(memory.data(), {});
    compare_with_onlooker(state, [&](Servo& servo) { servo.record(&input_log); });
}
BENCHMARK(cycle_that_is_recorded)->Iterations(4000);

/// By somebody who watches the scenes.
void cycle_that_is_watched(benchmark::State& state) {
    OfflineMemory memory(scene_log_bytes);
    RecordLog scene_log(memory.data(), scene_log_slots);
    compare_with_onlooker(state, [&](Servo& servo) { servo.show_scenes(&scene_log); });
}
BENCHMARK(cycle_that_is_watched)->Iterations(4000);

/// In contact, the plane changed every tenth cycle and faded over ten: a fade in every cycle.
void cycle_with_a_plane_that_fades(benchmark::State& state) {
    Rig rig(1);
    OfflineClaim& claim = *rig.claims[0];
    const Plane plane{.offset = 1.0, .stiffness = 20, .recovery = 0.01};
    const RepresentationId id = claim.add(plane);
    rig.step();
    std::uint64_t n = 0;
    for (auto _ : state) {
        if (++n % 10 == 0) {
            state.PauseTiming();  // the client's work
            Plane changed = plane;
            changed.offset += n % 20 == 0 ? 1e-4 : 0;
            claim.update(id, changed);
            claim.commit();
            state.ResumeTiming();
        }
        rig.step();
    }
    if ((rig.servo.last().flags & report_flags::touching) == 0) state.SkipWithError("not in contact");
}
BENCHMARK(cycle_with_a_plane_that_fades)->Iterations(40'000);

void cycle_with_a_resting_plane(benchmark::State& state) {
    Rig rig(1);
    rig.claims[0]->add(Plane{.offset = 1.0, .stiffness = 20});
    for (auto _ : state) rig.step();
}
BENCHMARK(cycle_with_a_resting_plane);

/// The median and the 99th percentile of single cycles, in ns of this thread's clock (its own reading
/// included).
template <class Cycle>
void percentiles(benchmark::State& state, Cycle cycle) {
    std::vector<double> taken;
    taken.reserve(static_cast<std::size_t>(state.max_iterations));
    MonotonicClock clock;
    for (auto _ : state) {
        const Nanoseconds begin = clock.now();
        cycle();
        taken.push_back(static_cast<double>(clock.now() - begin));
    }
    std::sort(taken.begin(), taken.end());
    state.counters["median_ns"] = taken[taken.size() / 2];
    state.counters["p99_ns"] = taken[taken.size() * 99 / 100];
    state.counters["max_ns"] = taken.back();
}

/// All of the paper's features at once: three planes with snags and recovery, two probes, four springs, on
/// six axes.
void cycle_with_all_features(benchmark::State& state) {
    Rig rig(1, "generic6");
    OfflineClaim& claim = *rig.claims[0];
    claim.place_probe(1, {.offset = {0.02, 0, 0}, .radius = 0.005});
    const Snag snag{.k_kinetic = 0.3, .k_stick = 500, .d_snap = 1e-3, .d_mean = 2e-3, .d_spread = 1e-3};
    Plane floor{.normal = {0, 0, 1}, .offset = 1, .stiffness = 5, .recovery = 0.05, .snag = snag};
    const RepresentationId id = claim.add(floor);
    claim.add(Plane{.normal = {1, 0, 0.2}, .offset = 1, .stiffness = 5, .snag = snag}, {.probe = 1});
    claim.add(Plane{.normal = {0, 1, 0.2}, .offset = 1, .stiffness = 5, .snag = snag});
    for (std::uint32_t i = 0; i < 4; ++i) {
        claim.add(
            Spring{.anchor = {0.05 * i, 0, 0}, .attach = {0, 0.01, 0}, .rest_length = 0.01, .stiffness = 50},
            {.probe = i % 2});
    }
    rig.step();
    std::uint64_t n = 0;
    percentiles(state, [&] {
        if (++n % 50 == 0) {  // 20 Hz: one cycle in fifty takes an update, all of them fade it
            floor.offset += n % 100 == 0 ? 1e-4 : -1e-4;
            claim.update(id, floor);
            claim.commit();
        }
        rig.step();
    });
    if ((rig.servo.last().flags & report_flags::touching) == 0) state.SkipWithError("not in contact");
}
BENCHMARK(cycle_with_all_features)->Iterations(100'000);

/// The cycle that takes a batch of updates, minus the client's own work.
void cycle_that_takes_updates(benchmark::State& state) {
    Rig rig(1, "premium15", 1024);
    OfflineClaim& claim = *rig.claims[0];
    std::vector<RepresentationId> ids;
    for (int i = 0; i < state.range(0); ++i) {
        ids.push_back(claim.add(Plane{.offset = -1, .stiffness = 20}));
        if (i % 32 == 31) rig.step();
    }
    for (int i = 0; i < 100; ++i) rig.step();
    std::vector<double> taken;
    double offset = -1;
    for (auto _ : state) {
        offset = offset < -1 ? -1 : -1.001;
        for (const RepresentationId id : ids) claim.update(id, Plane{.offset = offset, .stiffness = 20});
        claim.commit();
        const Nanoseconds begin = rig.clock.now();
        rig.step();
        taken.push_back(static_cast<double>(rig.clock.now() - begin));
        for (int i = 0; i < 20; ++i) rig.step();
    }
    std::sort(taken.begin(), taken.end());
    state.counters["median_ns"] = taken[taken.size() / 2];
    state.counters["p99_ns"] = taken[taken.size() * 99 / 100];
}
BENCHMARK(cycle_that_takes_updates)->Arg(1)->Arg(100)->Arg(1000)->Iterations(500);

void cycle_with_idle_claims(benchmark::State& state) {
    Rig rig(static_cast<int>(state.range(0)));
    for (auto _ : state) rig.step();
}
BENCHMARK(cycle_with_idle_claims)->Arg(1)->Arg(16)->Arg(100)->Arg(128);

}  // namespace
}  // namespace knurl::servo

BENCHMARK_MAIN();
