// knurl_chaos --seed N [--faults M] [--kinds local|network|NAME]: M faults, in an order and with details
// drawn from the seed (0: each kind once). Ends at the first broken promise, with the seed that reproduces
// it. A fault during which the machine itself stood still is repeated, with five attempts in all. At the end
// it prints how long the promised reactions took on this machine (never judged: promises are judged by
// cycles and order of events). Faults of a USB cable and its device: tests/drivers/usb/knurld_test.cpp.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numeric>

#include <sched.h>

#include <knurl/measure/measure.hpp>
#include <knurl/measure/sleeper.hpp>

#include "faults.hpp"

namespace knurl::chaos {

void demand(bool so, const std::string& promise) {
    if (!so) throw Broken(promise);
}

Stage::Stage(unsigned seed) : random(seed) {
    // The observer in state() finds the servo by these variables, as the programs do.
    setenv("KNURL_RUNTIME_DIR", home.runtime().c_str(), 1);
    setenv("KNURL_STATE_DIR", home.state().c_str(), 1);
    begin_anew();
}

void Stage::begin_anew() {
    clear();
    constexpr std::uint64_t capacity = 1 << 20;
    device = std::make_unique<drivers::shared_sim::FakeDevice>(
        KNURL_FAKE_DEVICE, drivers::shared_sim::FakeDevice::Settings{
                               .path = drivers::shared_sim::file_in_memory("knurl-chaos", capacity),
                               .profile = "cartesian3",
                               .capacity = capacity});
    start_servo();
    start_wall();
}

Stage::~Stage() {
    clear();
}

void Stage::clear() {
    watch_.reset();
    watcher_.reset();
    watched_ = 0;
    wall.reset();
    knurld.reset();
    if (!device) return;
    const std::string file = device->path();
    device.reset();
    std::error_code gone;
    std::filesystem::remove(file, gone);
}

void Stage::start_servo() {
    knurld.reset();
    knurld = std::make_unique<test::Knurld>(
        home, std::vector<std::string>{"--device", "right=" + device->address()}, KNURLD);
}

void Stage::start_wall(const std::string& address) {
    wall.reset();
    std::vector<std::string> words{"wall"};
    if (!address.empty()) words.push_back(address);
    wall = std::make_unique<test::Program>(home, KNURL_CHAOS_APP, words);
    // An application that other work of the machine starves becomes silent and fades: a fault that nobody
    // asked for. Without the right to real-time priority this may happen.
    const sched_param above_others{.sched_priority = 1};
    sched_setscheduler(wall->pid(), SCHED_FIFO, &above_others);
    wait_until_felt();
}

void Stage::wait_until_felt() {
    const bool so = test::eventually([&] {
        const std::int64_t from = now();
        let_pass(0.1);
        const Span span = force_span(device->log(), from);
        return span.smallest > 1.35 && span.largest < 1.85;
    });
    if (!so) throw Broken("the hand never felt the wall steadily; the application said: " + wall->output());
}

std::int64_t Stage::wait_until_zero(std::int64_t from) {
    std::int64_t zero = -1;
    const bool so = test::eventually([&] {
        let_pass(0.2);
        zero = zero_since(device->log(), from);
        return zero >= 0 && now() - zero > 200'000'000;
    });
    if (!so) throw Broken("the force did not go to zero and stay there");
    return zero;
}

void Stage::let_pass(double seconds) {
    if (!device->wait_steps(static_cast<std::uint64_t>(seconds / 200e-6)))
        throw Broken("the device's process stands still");
}

std::int64_t Stage::now() {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

DeviceState Stage::state() const {
    if (watched_ != knurld->pid()) {
        watch_.reset();
        watcher_ = std::make_unique<Client>(Client::connect("knurl:default"));
        watch_ = std::make_unique<Observer>(watcher_->observe());
        watched_ = knurld->pid();
    }
    const auto report = watch_->latest();
    return report ? report->state : DeviceState::disconnected;
}

std::vector<std::filesystem::path> Stage::flight_records() const {
    return test::files_in(home.state());
}

void Stage::measured(const std::string& promise, double milliseconds) {
    const auto known = std::ranges::find(measured_, promise, &Measured::promise);
    (known == measured_.end() ? measured_.emplace_back(Measured{promise, {}}) : *known)
        .milliseconds.push_back(milliseconds);
}

void Stage::print_measured() const {
    for (const Measured& m : measured_) {
        std::vector<double> sorted = m.milliseconds;
        std::ranges::sort(sorted);
        std::printf("  %-75s n %4zu  median %7.2f ms  max %7.2f ms\n", m.promise.c_str(), sorted.size(),
                    sorted[sorted.size() / 2], sorted.back());
    }
}

namespace {

/// What broke; empty: nothing did.
std::string broken_by(const Fault& fault, Stage& stage) {
    try {
        fault.happen(stage);
        stage.wait_until_felt();
        const auto wrong = check_always(stage.device->log(), 8.5, 2000, 1e-3);
        return wrong.empty() ? "" : wrong.front();
    } catch (const std::exception& broken) {
        return broken.what();
    }
}

/// How long the machine stood still within the worst `window` since the last call, ms. Short standstills in
/// close sequence are as bad as a long one, since device, servo and guardian each need a turn in between.
double worst_standstill(measure::Witness& witness) {
    constexpr measure::Nanoseconds window = 60'000'000;
    return static_cast<double>(measure::stood_still(witness.gaps(), window)) * 1e-6;
}

int run(unsigned seed, std::size_t count, const std::vector<Fault>& kinds) {
    // A gap of 20 ms between cycles sets the servo's gain to 0: what follows is no answer to the fault.
    constexpr double excuse = 20;  // ms
    constexpr int attempts = 5;
    constexpr int above_all = 95;  // SCHED_FIFO; without the right to it nothing is excused
    Stage stage(seed);
    std::vector<std::size_t> order(kinds.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::shuffle(order, stage.random);
    for (std::size_t i = order.size(); i < count; ++i) order.push_back(stage.random() % kinds.size());
    if (count > 0) order.resize(count);

    measure::Witness witness(measure::allowed_cpus(), above_all);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Fault& fault = kinds[order[i]];
        std::printf("%4zu %s\n", i + 1, fault.name);
        for (int attempt = 1;; ++attempt) {
            std::fflush(stdout);
            worst_standstill(witness);
            const std::string broken = broken_by(fault, stage);
            if (broken.empty()) break;
            const double stood_still = worst_standstill(witness);
            if (stood_still < excuse || attempt == attempts) {
                std::printf(
                    "BROKEN in fault %zu (%s): %s\nthe machine stood still for %.0f ms of the worst 60; "
                    "again "
                    "with the same arguments and --seed %u --faults %zu\n",
                    i + 1, fault.name, broken.c_str(), stood_still, seed, count);
                return 1;
            }
            std::printf("     the machine stood still for %.0f of 60 ms meanwhile (%s): once more\n",
                        stood_still, broken.c_str());
            stage.begin_anew();
        }
    }
    std::printf("%zu faults, seed %u: all promises kept; what they took here:\n", order.size(), seed);
    stage.print_measured();
    return 0;
}

}  // namespace
}  // namespace knurl::chaos

int main(int argc, char** argv) {
    unsigned seed = 1;
    std::size_t count = 0;
    std::string which = "all";
    for (int i = 1; i < argc; i += 2) {
        const std::string word = argv[i];
        const bool known = word == "--seed" || word == "--faults" || word == "--kinds";
        if (!known || i + 1 == argc) {
            std::fprintf(stderr,
                         "knurl_chaos: '%s' is unknown or has no value; known are --seed N, --faults M, "
                         "--kinds local|network|NAME\n",
                         argv[i]);
            return 2;
        }
        if (word == "--seed") seed = static_cast<unsigned>(std::strtoul(argv[i + 1], nullptr, 10));
        if (word == "--faults") count = std::strtoul(argv[i + 1], nullptr, 10);
        if (word == "--kinds") which = argv[i + 1];
    }
    try {
        using knurl::chaos::faults, knurl::chaos::network_faults;
        std::vector<knurl::chaos::Fault> kinds;
        if (which != "network") kinds.insert(kinds.end(), faults().begin(), faults().end());
        if (which != "local") kinds.insert(kinds.end(), network_faults().begin(), network_faults().end());
        if (which != "all" && which != "local" && which != "network")
            std::erase_if(kinds, [&](const knurl::chaos::Fault& fault) { return fault.name != which; });
        if (kinds.empty()) throw std::runtime_error("no fault is named '" + which + "'");
        return knurl::chaos::run(seed, count, kinds);
    } catch (const std::exception& error) {
        std::printf("knurl_chaos: %s (seed %u)\n", error.what(), seed);
        return 1;
    }
}
