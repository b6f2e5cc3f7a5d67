#pragma once
// A servo with random events of every sort, and its input log.

#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include <knurl/reps/all.hpp>
#include <knurl/servo/input_log.hpp>
#include <knurl/servo/replay.hpp>

#include "core_support.hpp"

namespace knurl::servo::testing {

/// Advances at each reading.
class RestlessClock final : public Clock {
  public:
    Nanoseconds now() noexcept override { return time += 100 + (step = step * 25'214'903'917 + 11) % 5000; }
    Nanoseconds time = 1'000'000'000;
    std::uint64_t step = 1;
};

/// A kind's defaults with some values changed; the defaults if the result is illegal.
template <class Random>
std::vector<std::byte> random_params(Kind kind, Random& random) {
    const auto uniform = [&](double size) { return std::uniform_real_distribution<>(-size, size)(random); };
    std::vector<std::byte> defaults;
    [&]<class... R>(TypeList<R...>) {
        const auto take = [&]<class T>(const T& value) {
            defaults.resize(sizeof value);
            std::memcpy(defaults.data(), &value, sizeof value);
        };
        ((kind == kind_of<R> ? take(R{}) : void()), ...);
    }(Representations{});
    std::vector<std::byte> params = defaults;
    for (const Field& field : kinds()[kind].fields) {
        if (random() % 3 == 0) continue;
        for (std::size_t i = 0; i < field.reals(); ++i) {
            double value;
            std::byte* at = params.data() + field.offset + 8 * i;
            std::memcpy(&value, at, sizeof value);
            value += uniform(field.unit == "m" ? 0.02 : field.unit == "N/m" ? 300 : 0.5);
            value = std::clamp(value, field.minimum, field.maximum);
            std::memcpy(at, &value, sizeof value);
        }
    }
    return kinds()[kind].validate(params.data()) ? params : defaults;
}

struct RecordedRun {
    explicit RecordedRun(std::uint64_t seed, double rate = 1000) : random(seed) {
        options = live_options(rate);
        header.layout = input_log_layout();
        header.device_figures = figures_of(device);
        header.options = options;
        device.link_.grip_damping = 2;
        servo = std::make_unique<Servo>(device, clock, segment.data(), options);
    }

    std::uint64_t chance(std::uint64_t one_in) { return random() % one_in == 0; }
    double uniform(double size) { return std::uniform_real_distribution<>(-size, size)(random); }

    void start() { servo->record(&input_log); }

    /// One cycle, possibly with an event.
    void cycle() {
        const double t = static_cast<double>(++n) * 1e-3;
        device.tip = 0.02 * Eigen::Vector3d(std::sin(3 * t), std::cos(2 * t), std::sin(7 * t));
        if (chance(3)) device.tip += Eigen::Vector3d::Constant(uniform(1e-5));
        if (chance(300)) device.tip += Eigen::Vector3d::Constant(uniform(0.2));  // a jump
        device.has_velocity = n / 2000 % 2 == 1;
        device.velocity = {uniform(0.1), uniform(0.1), uniform(0.1)};
        device.status = drivers::ReadStatus::ok;
        if (chance(40)) device.status = drivers::ReadStatus::stale;
        if (chance(90)) device.status = drivers::ReadStatus::bad;
        if (away > 0 ? away-- > 0 : chance(900) && (away = random() % 40, true))
            device.status = drivers::ReadStatus::unplugged;
        device.there = !chance(1500);
        device.calibrated = !chance(700);
        if (chance(800)) device.tip.x() = std::nan("");
        if (chance(500)) servo->guardian_acted();
        if (chance(2000)) servo->clock_jumped();
        // As in Loop::run: said in each cycle.
        if (still > 0 ? --still == 0 : chance(3000) && (still = 1 + random() % 100, true))
            servo->guardian_is_still(still > 0);
        if (!quiet) applications();

        clock.time += 990'000;
        if (chance(400)) clock.time += 30'000'000;  // a stall
        const Nanoseconds now = clock.now();
        servo->step(now - static_cast<Nanoseconds>(random() % (chance(10) ? 3'000'000 : 50'000)), now);
        // Now and then cycles are long for a while: claims are shed, additions refused, the device ramps down.
        if (long_cycles > 0 ? long_cycles-- > 0 : chance(1500) && (long_cycles = random() % 60, true)) {
            servo->took(static_cast<Nanoseconds>(1e9 / options.rate * (1.2 + uniform(0.7))));
        } else {
            servo->took(50'000);
        }
        reports.push_back(servo->last());
        while (const Claim* back = servo->released())
            std::erase_if(leaving, [&](const auto& claim) { return &claim->servo_side() == back; });
    }

    struct Application {
        std::unique_ptr<OfflineClaim> claim;
        std::vector<std::pair<RepresentationId, Kind>> ids;
        std::uint32_t next_slot = 0;
        bool hostile = false;
    };

    void applications() {
        if (apps.size() < 3 && chance(200)) {
            ClaimTerms terms;
            terms.capacity = {.representations = 16, .batch_bytes = 16 * 512};
            protocol::ClaimRequest request;
            request.workspace_radius = chance(2) ? 0.3 : 0;
            terms.frame = frame_for(device.link(), request);
            terms.limits = limits_for(device.link(), options.rate, terms.frame);
            terms.shared = true;
            terms.woken_by_servo = 12'345;
            apps.emplace_back().claim = std::make_unique<OfflineClaim>(terms);
            servo->adopt(&apps.back().claim->servo_side());
        }
        // At times all of them leave, since the input log needs a moment without claims.
        if (!apps.empty() && (chance(1200) || n % 3000 > 2700)) {
            servo->drop(&apps.back().claim->servo_side());
            leaving.push_back(std::move(apps.back().claim));
            apps.pop_back();
        }
        for (Application& app : apps) {
            try {
                act(app);
            } catch (const std::runtime_error&) {  // its ring is full: the servo ignores it
            }
        }
    }

    void act(Application& app) {
        OfflineClaim& claim = *app.claim;
        if (chance(20)) claim.reset_fault();
        if (chance(20)) claim.arm();
        if (chance(900)) claim.disarm();
        if (chance(60) && app.ids.size() < 12) {
            claim.begin_group();
            for (std::uint64_t i = random() % 3 + 1; i > 0; --i) {
                const auto kind = static_cast<Kind>(random() % Representations::size);
                const std::vector<std::byte> params = random_params(kind, random);
                app.ids.push_back({{app.next_slot++ % 16, app.next_slot}, kind});
                claim.add(app.ids.back().first, kind, params.data(), params.size(),
                          {.probe = static_cast<std::uint32_t>(random() % 2),
                           .on_silence = static_cast<OnSilence>(random() % 3)});
            }
            claim.end_group();
        }
        if (chance(200)) claim.place_probe(1, {.offset = {uniform(0.02), 0, 0}, .radius = 1e-3});
        if (!app.ids.empty() && chance(120)) {
            claim.remove(app.ids.front().first);
            app.ids.erase(app.ids.begin());
        }
        if (!app.ids.empty() && chance(15)) {
            const auto& [id, kind] = app.ids[random() % app.ids.size()];
            const std::vector<std::byte> params = random_params(kind, random);
            claim.update(id, kind, params.data(), params.size());
            claim.commit(n, clock.time);
        }
        if (!chance(50)) claim.replies();  // most of the time they are read
        if (chance(3000)) app.hostile = true;
        if (app.hostile && chance(10)) {
            const std::uint64_t word = random();
            std::memcpy(claim.memory() + random() % (claim.layout().total / 8) * 8, &word, sizeof word);
        }
        if (chance(4000)) {  // an invalid index
            const std::uint64_t word = random();
            std::memcpy(claim.memory() + (chance(2) ? claim.layout().commands : claim.layout().batches),
                        &word, sizeof word);
        }
    }

    std::vector<InputRecord> drain() {
        std::vector<InputRecord> all;
        InputRecord record;
        while (reader.next(record) == InputLogReader::Next::record) all.push_back(record);
        return all;
    }

    std::mt19937_64 random;
    PuppetDevice device{6};
    RestlessClock clock;
    ServoOptions options;
    InputLogHeader header;
    OfflineMemory segment{protocol::device_layout().total}, memory{input_log_bytes};
    InputLog input_log{memory.data(), header};
    InputLogReader reader{memory.data(), 0};
    std::vector<std::unique_ptr<OfflineClaim>> leaving;
    std::vector<Application> apps;
    std::vector<Report> reports;
    std::uint64_t n = 0, away = 0, long_cycles = 0, still = 0;
    bool quiet = false;  // applications do nothing
    std::unique_ptr<Servo> servo;
};

}  // namespace knurl::servo::testing
