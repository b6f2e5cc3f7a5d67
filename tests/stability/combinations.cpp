// knurl_combinations: random scenes of many parts that act on the hand together, in the closed loop of the
// real servo on simulated devices.
//
//   knurl_combinations [--count 10000] [--seed 1] [--threads 2] [--without-budget] [--flat] [--planes]
//                      [--glove] [--verbose] [--trace FILE]
//
// Each scene has up to 12 parts (planes of any stiffness and damping, on up to five probes, solved or summed;
// springs, constraints, magnets, viscosities, Taylor fields; balls, bars and boxes), spread over one to eight
// claims, on premium15, cartesian3 or generic6 with 0.05 N of dry friction. A hand comes down, slides, and
// rests. In the last half second of 5 s, half the peak-to-peak motion of the tip must be below 0.1 mm on each
// axis, without a fault. A hand that still moves more continues for 5 s and is judged again in the last half
// second: a limit cycle lasts for ever, a hand that has crept to an edge where it is released does not. A
// failure prints the seed of its scene, which repeats it alone.
//
// --planes: of planes alone, solved together, without friction and damping, on devices that render no torque.
// --glove: those by a rigid glove instead of the budget: all contacts are one nearest-point problem in the
// hand's displacement. Where the hand does not turn that is the scene's own problem, with each plane moved by
// its probe's arm.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>
#include <mutex>
#include <span>
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
    bool planes = false;  // nothing else
    bool glove = false;
    std::FILE* trace = nullptr;
};

struct Outcome {
    double cycle = 0;            // m, the largest of the axes
    HandScales scales;           // the budget's, at the end
    double force = 0;            // N, on the hand at the end
    bool comes_to_rest = false;  // later than it should
    double depth = 0;            // m, of the deepest plane at the end (--planes)
    double stands = 0;           // N/m, of the device
    double processor_time = 0;   // s
    std::uint32_t faults = 0;    // bits: protocol::fault
    std::string device, parts;
    bool cycles() const { return !(cycle < most_cycle) && !comes_to_rest; }
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
    const AddOptions use{.probe = static_cast<std::uint32_t>(between(rng, 0, static_cast<int>(probes) - 1))};
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

/// A plane on a probe that sits at an offset from the tip, and where that is deepest.
struct OffsetPlane {
    Vector3d normal, offset;
    double height = 0;  // m, normal . x of the surface
    double depth(const Vector3d& tip) const { return height - normal.dot(tip + offset); }
};

/// Bare planes by the budget, or by the rigid glove.
void add_planes(Rng& rng, std::span<servo::OfflineClaim* const> claims, std::span<const Vec3> offsets,
                int parts, bool glove, std::vector<OffsetPlane>& planes) {
    for (int i = 0; i < parts; ++i) {
        const auto at = [&rng](std::size_t size) {
            return static_cast<std::size_t>(between(rng, 0, static_cast<int>(size) - 1));
        };
        const std::size_t claim = at(claims.size()), probe = at(offsets.size());
        Plane plane{.normal = to_plain(upwards(rng)), .offset = -uniform(rng, 0, 4e-3)};
        plane.stiffness = any_stiffness(rng);
        const Vector3d n = to_eigen(plane.normal).normalized(), arm = to_eigen(offsets[probe]);
        planes.push_back({.normal = n, .offset = arm, .height = plane.offset});
        if (glove) {
            plane.offset -= n.dot(arm);
            claims.front()->add(plane);
        } else {
            claims[claim]->add(plane, {.probe = static_cast<std::uint32_t>(probe)});
        }
    }
}

double processor_time() {  // s, of this thread
    timespec time{};
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

drivers::Motion some_motion(Rng& rng) {
    std::vector<drivers::MotionRow> rows{{.t = 0, .position = {0, 0, 2e-3}},
                                         {.t = 0.2, .position = {0, 0, 2e-3}}};
    for (double t = 0.6; t < rest_from + 0.1; t += 0.35)
        rows.push_back(
            {.t = t,
             .position = {uniform(rng, -4e-3, 4e-3), uniform(rng, -4e-3, 4e-3), uniform(rng, -8e-3, 1e-3)}});
    rows.push_back({.t = 2 * run_time + 1, .position = rows.back().position});
    return drivers::Motion(std::move(rows));
}

/// 5 s from `begin` on. How far the hand moves in the last half second: m, the most of the axes.
double run(servo::Offline& servo, drivers::SimDevice& device, servo::OfflineClaim& claim, double begin,
           std::FILE* trace, std::uint32_t& faults) {
    constexpr double rate = 1000;  // ServoOptions' own
    Vector3d low = Vector3d::Constant(infinity), high = -low;
    for (int i = 0; i < static_cast<int>(run_time * rate); ++i) {
        const Report& report = servo.step();
        faults |= report.faults;
        const Vector3d& p = device.state().position;
        if (trace != nullptr) {
            const HandScales scales = protocol::scales_of(claim.feedback().header);
            fmt::print(trace, "{},{},{},{},{},{},{},{},{}\n", i + static_cast<int>(begin * rate), p.x(),
                       p.y(), p.z(), report.sent_force.x, report.sent_force.y, report.sent_force.z,
                       scales.contacts, scales.effects);
        }
        if (i < judged_from * rate) continue;
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return 0.5 * (high - low).maxCoeff();
}

Outcome live(std::uint64_t seed, Options options) {
    Rng rng(seed);
    options.damped = between(rng, 0, 1) == 0;  // dampers hide what is too stiff
    Outcome out;
    if (options.planes) options.damped = false;
    out.device = std::array{"premium15", "cartesian3",
                            "generic6"}[static_cast<std::size_t>(between(rng, 0, options.planes ? 1 : 2))];
    drivers::SimProfile profile = drivers::sim_profile(out.device);
    profile.coulomb = 0.05;
    profile.hand.push = uniform(rng, 0, 2);
    drivers::SimDevice device(profile, some_motion(rng));
    servo::ServoOptions servo_options;
    servo_options.silence = false;
    servo_options.budget = options.budget && !options.glove;
    servo::Offline servo(device, servo_options);
    const int claims = between(rng, 0, 1) ? 1 : between(rng, 2, 8), parts = between(rng, 1, 12);
    const auto probes = static_cast<std::uint32_t>(between(rng, 1, 5));
    std::vector<servo::OfflineClaim*> all;
    std::vector<Vec3> offsets{{}};
    for (std::uint32_t p = 1; p < probes; ++p)
        if (options.planes) offsets.push_back({0.01 * p, uniform(rng, -0.01, 0.01), 0});
    for (int c = 0; c < claims; ++c) {
        servo::ClaimTerms terms;
        terms.limits = servo::limits_for(device.link(), servo_options.rate, terms.frame);
        all.push_back(&servo.claim(std::move(terms)));
        for (std::uint32_t p = 1; p < probes; ++p)
            all.back()->place_probe(
                p, {.offset = options.planes ? offsets[p] : Vec3{0.01 * p, uniform(rng, -0.01, 0.01), 0}});
    }
    std::vector<OffsetPlane> planes;
    if (options.planes) add_planes(rng, all, offsets, parts, options.glove, planes);
    for (int i = 0; i < parts && !options.planes; ++i)
        out.parts +=
            add_part(rng, *all[static_cast<std::size_t>(between(rng, 0, claims - 1))], probes, options) + " ";
    for (servo::OfflineClaim* claim : all) claim->arm();
    const double from = processor_time();
    out.cycle = run(servo, device, *all.front(), 0, options.trace, out.faults);
    out.processor_time = processor_time() - from;
    out.force = to_eigen(servo.servo().last().sent_force).norm();
    out.scales = protocol::scales_of(all.front()->feedback().header);
    out.stands = servo::max_stiffness(device.link(), servo_options.rate);
    for (const OffsetPlane& plane : planes)
        out.depth = std::max(out.depth, plane.depth(device.state().position));
    if (!(out.cycle < most_cycle))
        out.comes_to_rest =
            run(servo, device, *all.front(), run_time, options.trace, out.faults) < most_cycle;
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    commandline::Command app("knurl_combinations",
                             "Random scenes of many parts in the closed loop: no limit cycle, no fault.");
    std::uint64_t count = 10'000, first = 1;
    int threads = 2;
    std::string trace;
    bool without = false, flat = false, planes = false, glove = false, verbose = false;
    app.option("--count", count, "scenes, 5 s each");
    app.option("--seed", first, "of the first scene; the next has the next");
    app.option("--threads", threads, "that work side by side").within(1, 256);
    app.flag("--without-budget", without, "each part is clamped by itself alone, for comparison");
    app.flag("--flat", flat, "without balls, bars and boxes");
    app.flag("--planes", planes, "planes alone, without friction and damping");
    app.flag("--glove", glove, "the same by a rigid glove instead of the budget");
    app.option("--trace", trace, "each cycle's place, force and scales to this file, of one scene");
    app.flag("--verbose", verbose, "name every failure");
    app.action([&] {
        std::FILE* const file = trace.empty() ? nullptr : std::fopen(trace.c_str(), "w");
        std::atomic<std::uint64_t> next = 0;
        std::mutex mutex;
        std::uint64_t cycles = 0, faults = 0, scaled = 0, late = 0, deep = 0;
        double largest = 0, forces = 0, depth = 0, softer = 0, processor = 0;
        const auto work = [&] {
            for (std::uint64_t i = next++; i < count; i = next++) {
                const Outcome out = live(first + i, {.budget = !without,
                                                     .curved = !flat,
                                                     .planes = planes || glove,
                                                     .glove = glove,
                                                     .trace = file});
                const std::lock_guard lock(mutex);
                largest = std::max(largest, out.cycle);
                faults += out.faults != 0;
                cycles += out.cycles();
                late += out.comes_to_rest;
                processor += out.processor_time;
                if (out.depth > 0 && out.force > 0) {
                    ++deep;
                    depth += out.depth;
                    softer += std::log(out.depth * out.stands / out.force);
                }
                scaled += !(out.scales == HandScales{});
                forces += out.force;
                if (out.failed() && (verbose || cycles + faults + late <= 10))
                    fmt::print(
                        "{}: faults {:#x}, {} {:.3f} mm on {}, scales {:.3f} {:.3f} {:.3f}: {}\n  "
                        "replay: "
                        "knurl_combinations --seed {} --count 1\n",
                        first + i, out.faults, out.comes_to_rest ? "late at rest, by" : "a cycle of",
                        1e3 * out.cycle, out.device, out.scales.contacts, out.scales.effects,
                        out.scales.damping, out.parts, first + i);
            }
        };
        std::vector<std::thread> pool;
        for (int i = 0; i < threads; ++i) pool.emplace_back(work);
        for (std::thread& thread : pool) thread.join();
        fmt::print(
            "{} scenes from seed {}: {} limit cycles, {} late at rest, {} faults, largest {:.4f} mm; {} end "
            "scaled, with {:.2f} N\n",
            count, first, cycles, late, faults, 1e3 * largest, scaled, forces / static_cast<double>(count));
        if (planes || glove)
            fmt::print(
                "the deepest plane {:.3f} mm in the mean of {} that touch, {:.2f} times (geometric mean) as "
                "far as "
                "the device need give way; {:.2f} us of processor time a cycle\n",
                1e3 * depth / static_cast<double>(std::max<std::uint64_t>(deep, 1)), deep,
                std::exp(softer / static_cast<double>(std::max<std::uint64_t>(deep, 1))),
                1e6 * processor / (static_cast<double>(count) * run_time * 1000));
        return cycles + faults == 0 || without ? 0 : 1;
    });
    return commandline::run(app, argc, argv);
}
