// knurl_combinations: random scenes of many parts that act on the hand together, in the closed loop of the real
// servo on simulated devices.
//
//   knurl_combinations [--count 10000] [--seed 1] [--threads 2] [--without-budget] [--flat] [--verbose] [--trace FILE]
//
// Each scene: up to 12 parts (planes of any stiffness and damping, on up to five probes, solved or summed; springs,
// constraints, magnets, viscosities, Taylor fields; balls, bars and boxes), spread over one to eight claims, on
// premium15, cartesian3 or generic6 with 0.05 N of dry friction; a hand that comes down, slides, and rests. In the
// last half second of 5 s half of peak to peak of the tip's place is below 0.1 mm on each axis, and there is no
// fault. A failure prints the seed of its scene, which alone replays it.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>
#include <knurl/drivers/sim_device.hpp>
#include <knurl/servo/offline.hpp>

#include "../reps/scene_tools.hpp"

namespace {

using namespace knurl;
using namespace knurl::test;
using Eigen::Vector3d;

constexpr double run_time = 5, judged_from = 4.5, rest_from = 2;  // s
constexpr double most_cycle = 1e-4;                               // m

struct Options {
    bool budget = true;
    bool curved = true;
    bool damped = true;
    std::FILE* trace = nullptr;
};

struct Outcome {
    double cycle = 0;          // m, the largest of the axes
    HandScales scales;         // the budget's, at the end
    double force = 0;          // N, on the hand at the end
    std::uint32_t faults = 0;  // bits: protocol::fault
    std::string device, parts;
    bool failed() const { return faults != 0 || !(cycle < most_cycle); }
};

/// Towards the hand from below: no plane contradicts another.
Vector3d upwards(Rng& rng) {
    if (between(rng, 0, 1)) return Vector3d::UnitZ();
    const double lean = uniform(rng, 0, 75) * M_PI / 180, turn = uniform(rng, 0, 2 * M_PI);
    return {std::sin(lean) * std::cos(turn), std::sin(lean) * std::sin(turn), std::cos(lean)};
}

double any_stiffness(Rng& rng) {
    switch (between(rng, 0, 3)) {
        case 0:
            return infinity;
        case 1:
            return 1000;
        default:
            return scale(rng, 50, 1e5);
    }
}
double any_damping(Rng& rng, const Options& options) {
    if (!options.damped) return 0;
    switch (between(rng, 0, 3)) {
        case 0:
            return scale(rng, 0.1, 1e9);
        case 1:
            return scale(rng, 0.1, 30);
        default:
            return 0;
    }
}

template <class R>
void put_material(Rng& rng, R& surface, const Options& options) {
    surface.stiffness = any_stiffness(rng);
    surface.damping = any_damping(rng, options);
    if (between(rng, 0, 2) == 0) {
        surface.friction.dynamic = uniform(rng, 0, 1.2);
        surface.friction.static_ = surface.friction.dynamic * uniform(rng, 1, 1.5);
        if (between(rng, 0, 1)) surface.friction.viscous = any_damping(rng, options);
    }
}

Vec3 near_rest(Rng& rng, double within) {
    return to_plain(uniform(rng, 0, within) * direction(rng) + Vector3d(0, 0, -4e-3));
}

/// One part; its name.
std::string add_part(Rng& rng, servo::OfflineClaim& claim, std::uint32_t probes, const Options& options) {
    const Use use{.probe = static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(probes) - 1))};
    switch (between(rng, 0, options.curved ? 11 : 8)) {
        case 0:
        case 1:
        case 2: {
            Plane plane{.normal = to_plain(upwards(rng)), .offset = -uniform(rng, 0, 4e-3)};
            put_material(rng, plane, options);
            if (between(rng, 0, 4) == 0) plane.combine = PlaneCombine::sum;
            claim.add(plane, use);
            return "plane";
        }
        case 3:
        case 4: {
            Spring spring{.anchor = near_rest(rng, 5e-3),
                          .stiffness = any_stiffness(rng),
                          .damping = any_damping(rng, options)};
            if (between(rng, 0, 2) == 0) spring.rest_length = uniform(rng, 1e-3, 2e-2);
            if (between(rng, 0, 2) == 0) spring.attach = to_plain(uniform(rng, 0, 0.04) * direction(rng));
            claim.add(spring, use);
            return "spring";
        }
        case 5: {
            Constraint constraint{.origin = near_rest(rng, 3e-3),
                                  .direction = to_plain(direction(rng)),
                                  .stiffness = any_stiffness(rng),
                                  .damping = any_damping(rng, options)};
            constraint.shape = static_cast<ConstraintShape>(between(rng, 0, 2));
            claim.add(constraint, use);
            return "constraint";
        }
        case 6: {
            Magnet magnet{.position = near_rest(rng, 6e-3)};
            magnet.stiffness = scale(rng, 50, 5000);
            magnet.damping = any_damping(rng, options);
            magnet.max_force = scale(rng, 0.2, 5);
            magnet.max_distance = magnet.max_force / magnet.stiffness * uniform(rng, 1.5, 4);
            if (between(rng, 0, 2) == 0) magnet.radius = uniform(rng, 1e-3, 8e-3);
            claim.add(magnet, use);
            return "magnet";
        }
        case 7: {
            claim.add(Viscosity{.damping = options.damped ? scale(rng, 0.1, 1e9) : 0,
                                .angular_damping = any_damping(rng, options)},
                      use);
            return "viscosity";
        }
        case 8: {
            Taylor taylor{.origin = near_rest(rng, 5e-3),
                          .force = to_plain(uniform(rng, 0, 1) * direction(rng))};
            Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
            for (int i = 0; i < 3; ++i) {
                const Vector3d u = direction(rng);
                j -= scale(rng, 10, 3000) * u * u.transpose();
            }
            taylor.jacobian = to_mat3(j);
            taylor.radius = uniform(rng, 5e-3, 5e-2);
            taylor.edge = static_cast<TaylorEdge>(between(rng, 0, 1));
            claim.add(taylor, use);
            return "taylor";
        }
        case 9: {
            Sphere sphere{};
            sphere.radius = uniform(rng, 5e-3, 3e-2);
            sphere.center = to_plain(-(sphere.radius + uniform(rng, 0, 4e-3)) * upwards(rng));
            put_material(rng, sphere, options);
            claim.add(sphere, use);
            return "sphere";
        }
        case 10: {
            Capsule capsule{};
            capsule.radius = uniform(rng, 5e-3, 3e-2);
            const Vector3d middle = -(capsule.radius + uniform(rng, 0, 4e-3)) * upwards(rng);
            capsule.center = to_plain(middle);
            capsule.axis = to_plain(Vector3d::UnitZ().cross(direction(rng)));
            capsule.half_length = uniform(rng, 0.01, 0.05);
            put_material(rng, capsule, options);
            claim.add(capsule, use);
            return "capsule";
        }
        default: {
            Box box{};
            box.half_size = {uniform(rng, 5e-3, 0.03), uniform(rng, 5e-3, 0.03), uniform(rng, 5e-3, 0.02)};
            box.center = {uniform(rng, -5e-3, 5e-3), uniform(rng, -5e-3, 5e-3),
                          -box.half_size.z - uniform(rng, 0, 4e-3)};
            put_material(rng, box, options);
            claim.add(box, use);
            return "box";
        }
    }
}

drivers::Motion some_motion(Rng& rng) {
    std::vector<drivers::MotionRow> rows{{.t = 0, .position = {0, 0, 2e-3}},
                                         {.t = 0.2, .position = {0, 0, 2e-3}}};
    for (double t = 0.6; t < rest_from + 0.1; t += 0.35)
        rows.push_back(
            {.t = t,
             .position = {uniform(rng, -4e-3, 4e-3), uniform(rng, -4e-3, 4e-3), uniform(rng, -8e-3, 1e-3)}});
    rows.push_back({.t = run_time + 1, .position = rows.back().position});
    return drivers::Motion(std::move(rows));
}

Outcome live(std::uint64_t seed, Options options) {
    Rng rng(seed);
    options.damped = between(rng, 0, 1) == 0;  // dampers hide what is too stiff
    Outcome out;
    out.device =
        std::array{"premium15", "cartesian3", "generic6"}[static_cast<std::size_t>(between(rng, 0, 2))];
    drivers::SimProfile profile = drivers::sim_profile(out.device);
    profile.coulomb = 0.05;
    profile.hand.push = uniform(rng, 0, 2);
    drivers::SimDevice device(profile, some_motion(rng));
    servo::ServoOptions servo_options;
    servo_options.silence = false;
    servo_options.budget = options.budget;
    servo::Offline servo(device, servo_options);
    const int claims = between(rng, 0, 1) ? 1 : between(rng, 2, 8), parts = between(rng, 1, 12);
    const auto probes = static_cast<std::uint32_t>(between(rng, 1, 5));
    std::vector<servo::OfflineClaim*> all;
    for (int c = 0; c < claims; ++c) {
        servo::ClaimTerms terms;
        terms.limits = servo::limits_for(device.link(), servo_options.rate, terms.frame);
        all.push_back(&servo.claim(std::move(terms)));
        for (std::uint32_t p = 1; p < probes; ++p)
            all.back()->place_probe(p, {.offset = {0.01 * p, uniform(rng, -0.01, 0.01), 0}});
    }
    for (int i = 0; i < parts; ++i)
        out.parts +=
            add_part(rng, *all[static_cast<std::size_t>(between(rng, 0, claims - 1))], probes, options) + " ";
    for (servo::OfflineClaim* claim : all) claim->arm();
    Vector3d low = Vector3d::Constant(infinity), high = -low;
    const auto cycles = static_cast<int>(run_time * servo_options.rate);
    for (int i = 0; i < cycles; ++i) {
        const Report& report = servo.step();
        out.faults |= report.faults;
        if (options.trace != nullptr) {
            const Vector3d& p = device.state().position;
            fmt::print(options.trace, "{},{},{},{},{},{},{},{},{}\n", i, p.x(), p.y(), p.z(),
                       report.sent_force.x, report.sent_force.y, report.sent_force.z,
                       protocol::scales_of(all.front()->feedback().header).contacts,
                       protocol::scales_of(all.front()->feedback().header).effects);
        }
        if (i < judged_from * servo_options.rate) continue;
        low = low.cwiseMin(device.state().position);
        high = high.cwiseMax(device.state().position);
    }
    out.force = to_eigen(servo.servo().last().sent_force).norm();
    out.scales = protocol::scales_of(all.front()->feedback().header);
    out.cycle = 0.5 * (high - low).maxCoeff();
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    commandline::Command app("knurl_combinations",
                             "Random scenes of many parts in the closed loop: no limit cycle, no fault.");
    std::uint64_t count = 10'000, first = 1;
    int threads = 2;
    std::string trace;
    bool without = false, flat = false, verbose = false;
    app.option("--count", count, "scenes, 5 s each");
    app.option("--seed", first, "of the first scene; the next has the next");
    app.option("--threads", threads, "that work side by side").within(1, 256);
    app.flag("--without-budget", without, "each part is clamped by itself alone, for comparison");
    app.flag("--flat", flat, "without balls, bars and boxes");
    app.option("--trace", trace, "each cycle's place, force and scales to this file, of one scene");
    app.flag("--verbose", verbose, "name every failure");
    app.action([&] {
        std::FILE* const file = trace.empty() ? nullptr : std::fopen(trace.c_str(), "w");
        std::atomic<std::uint64_t> next = 0;
        std::mutex mutex;
        std::uint64_t cycles = 0, faults = 0, scaled = 0;
        double largest = 0, forces = 0;
        const auto work = [&] {
            for (std::uint64_t i = next++; i < count; i = next++) {
                const Outcome out = live(first + i, {.budget = !without, .curved = !flat, .trace = file});
                const std::lock_guard lock(mutex);
                largest = std::max(largest, out.cycle);
                faults += out.faults != 0;
                cycles += !(out.cycle < most_cycle);
                scaled += !(out.scales == HandScales{});
                forces += out.force;
                if (out.failed() && (verbose || cycles + faults <= 10))
                    fmt::print(
                        "{}: faults {:#x}, a cycle of {:.3f} mm on {}, scales {:.3f} {:.3f} {:.3f}: {}\n  "
                        "replay: "
                        "knurl_combinations --seed {} --count 1\n",
                        first + i, out.faults, 1e3 * out.cycle, out.device, out.scales.contacts,
                        out.scales.effects, out.scales.damping, out.parts, first + i);
            }
        };
        std::vector<std::thread> pool;
        for (int i = 0; i < threads; ++i) pool.emplace_back(work);
        for (std::thread& thread : pool) thread.join();
        fmt::print(
            "{} scenes from seed {}: {} limit cycles, {} faults, largest {:.4f} mm; {} end scaled, with "
            "{:.2f} N\n",
            count, first, cycles, faults, 1e3 * largest, scaled, forces / static_cast<double>(count));
        return cycles + faults == 0 || without ? 0 : 1;
    });
    return commandline::run(app, argc, argv);
}
