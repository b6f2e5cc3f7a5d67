// knurl device calibrate ADDRESS: mass, damping, dry friction, delay and resolution of one's own device, measured, and
// written to a file that knurld uses: ADDRESS,measured=FILE.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/json/json.hpp>
#include <knurl/servo/servo.hpp>

#include "device_bench.hpp"
#include "device_fit.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

using json = knurl::Json;

struct CalibrateOptions {
    std::string address, write;
    TrialOptions trial;
    bool as_json = false;
};

constexpr double seconds = 8;                       // of motion along each axis
constexpr double centring = 60;                     // N/m, so that it stays where it is; counted as force
constexpr double slow = 1, middle = 5, quick = 11;  // Hz, of three sines
constexpr double least_moved = 2e-3;                // m; else the fit means nothing

struct Calibration {
    std::array<Fit, 3> axes;
    double mass = 0, damping = 0, friction = 0,
           lag = 0;         // mass and friction the mean; the softest bound of the others
    double resolution = 0;  // m, the smallest step of the position
};

std::atomic<bool> stopped = false;

/// The smallest step between two positions that were read, in m.
double smallest_step(const std::vector<double>& positions) {
    double smallest = 0;
    for (std::size_t i = 1; i < positions.size(); ++i) {
        const double step = std::abs(positions[i] - positions[i - 1]);
        if (step > 1e-9 && (smallest == 0 || step < smallest)) smallest = step;
    }
    return smallest;
}

Motion1 shaken(Bench& bench, const Moment& home, Eigen::Index axis, double push) {
    Motion1 motion{.period = 1 / bench.options().rate, .position = {}, .force = {}};
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
    bench.run(seconds, [&](const Moment& m, Wrench& wanted) {
        const auto sine = [&](double hertz) { return std::sin(2 * M_PI * hertz * m.t); };
        const Eigen::Vector3d away = home.position - m.position;
        const double force =
            centring * away.dot(along) + push * (0.5 * sine(slow) + 0.5 * sine(middle) + 0.5 * sine(quick));
        wanted.force = centring * (away - away.dot(along) * along) + force * along;
        motion.position.push_back((m.position - home.position).dot(along));
        motion.force.push_back(force);
        return true;
    });
    return motion;
}

Calibration measure_all(drivers::Device& device, const CalibrateOptions& options) {
    if (device.link().actuated_joints < 3)
        throw std::runtime_error("it has no motors along three axes: nothing to measure");
    Bench bench(device, options.trial);
    bench.run(options.trial.homing_time, [](const Moment& m, Wrench&) { return !m.sample.calibrated; });
    if (!bench.known() || !bench.moment().sample.calibrated)
        throw std::runtime_error("it is not homed; home it and start again");
    const Moment home = bench.moment();
    Calibration all;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!options.as_json) fmt::print(stderr, "{} of 3: along {} ...\n", i + 1, "xyz"[i]);
        bench.settle(0.5, home);
        const Motion1 motion = shaken(bench, home, static_cast<Eigen::Index>(i), options.trial.push);
        all.axes[i] = fit(motion);
        if (all.axes[i].moved < least_moved)
            throw std::runtime_error(
                fmt::format("along {} it moved {:.1f} mm; push harder (--push), and let it hang freely",
                            "xyz"[i], all.axes[i].moved * 1e3));
        const double step = smallest_step(motion.position);
        all.resolution = all.resolution == 0 ? step : std::max(all.resolution, step);
    }
    bench.settle(0.5, home);
    const auto& a = all.axes;
    all.mass = (a[0].mass + a[1].mass + a[2].mass) / 3;
    all.friction = std::max(0.0, (a[0].friction + a[1].friction + a[2].friction) / 3);
    all.damping = std::min({a[0].damping, a[1].damping, a[2].damping});
    all.lag = std::max({a[0].lag, a[1].lag, a[2].lag});
    if (!(all.mass > 0 && all.damping > 0))
        throw std::runtime_error(
            fmt::format("the motion fits no mass and damping ({:.3g} kg, {:.3g} N s/m): was a hand on it?",
                        all.mass, all.damping));
    return all;
}

void write_file(const CalibrateOptions& options, const Calibration& found, const std::string& serial) {
    std::ofstream file(options.write);
    file << fmt::format(
        "# Written by `knurl device calibrate`. knurld uses it: --device NAME={},measured=FILE\n[measured]\n"
        "address = {}\nserial = {}\nmass = {:.4g}         # kg at the tip, mean of three axes\n"
        "damping = {:.4g}      # N s/m, of the axis with the least\nfriction = {:.4g}     # N, dry, mean\n"
        "lag = {:.4g}          # s, of the axis with the longest\nresolution = {:.3g}   # m\n",
        options.address, json(options.address).dump(), json(serial).dump(), found.mass, found.damping,
        found.friction, found.lag, found.resolution);
    file.close();
    if (!file) throw std::runtime_error(options.write + ": cannot be written");
}

int calibrate(CalibrateOptions options) {
    if (options.trial.virtual_time && !options.address.starts_with("sim:"))
        throw UsageError("--virtual is for simulated devices: a real one has only this time");
    const std::unique_ptr<drivers::Device> device = drivers::open_device(options.address);
    options.trial.stop = &stopped;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        if (std::signal(signal, [](int) { stopped = true; }) == SIG_IGN) std::signal(signal, SIG_IGN);
    const Calibration found = measure_all(*device, options);
    drivers::LinkConfig with = device->link();
    with.damping = found.damping;
    with.lag = found.lag;
    with.measured_max_stiffness = 0;
    const double before = servo::max_stiffness(device->link(), options.trial.rate);
    const double after = servo::max_stiffness(with, options.trial.rate);
    if (!options.write.empty()) write_file(options, found, device->link().serial);
    if (options.as_json) {
        json axes = json::array();
        for (const Fit& axis : found.axes)
            axes.push_back({{"mass", axis.mass},
                            {"damping", axis.damping},
                            {"friction", axis.friction},
                            {"lag", axis.lag},
                            {"moved", axis.moved}});
        fmt::print("{}\n", json{{"address", options.address},
                                {"mass", found.mass},
                                {"damping", found.damping},
                                {"friction", found.friction},
                                {"lag", found.lag},
                                {"resolution", found.resolution},
                                {"axes", axes},
                                {"max_stiffness_stated", before},
                                {"max_stiffness", after}}
                               .dump(2));
        return 0;
    }
    fmt::print("  axis   mass kg   damping N s/m   dry friction N   lag ms\n");
    for (std::size_t i = 0; i < 3; ++i)
        fmt::print("  {}      {:.3f}     {:.3f}           {:.3f}            {:.2f}\n", "xyz"[i],
                   found.axes[i].mass, found.axes[i].damping, found.axes[i].friction,
                   found.axes[i].lag * 1e3);
    fmt::print(
        "  resolution {:.1f} um; k_max {:.0f} N/m with these figures, {:.0f} N/m with the stated ones\n",
        found.resolution * 1e6, after, before);
    if (!options.write.empty())
        fmt::print("  written: {}; use it: {},measured={}\n", options.write, options.address, options.write);
    return 0;
}

}  // namespace

void add_device_calibrate(commandline::Command& device) {
    auto& verb =
        device.verb("calibrate", "Measures mass, damping, dry friction, lag and resolution. It moves!");
    auto options = std::make_shared<CalibrateOptions>();
    verb.option("ADDRESS", options->address, "as for knurld --device: dhd:").required();
    verb.option("--write", options->write, "a file for ADDRESS,measured=FILE").type_name("FILE");
    verb.option("--rate", options->trial.rate, "Hz (1000)").within(500.0, 20000.0);
    verb.option("--push", options->trial.push, "N, the largest (1)").within(0.1, 5.0);
    verb.option("--homing-time", options->trial.homing_time, "s to wait for homing (60)").within(1.0, 600.0);
    verb.flag("--virtual", options->trial.virtual_time, "a simulated device as fast as it computes");
    verb.flag("--json", options->as_json, "the same for programs (SI units)");
    verb.footer(
        "The device must hang or rest freely, nobody's hand on it; no servo may hold it. It is shaken for 8 "
        "s along each\n"
        "axis, by about a centimetre. knurld then bounds walls by what was measured: least damping, longest "
        "lag.");
    verb.action([options] { return calibrate(*options); });
}

}  // namespace knurl::cli
