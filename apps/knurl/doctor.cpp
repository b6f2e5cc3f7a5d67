// knurl doctor: is this machine fit for a hand, at which rate, and what would improve it?

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>
#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/private_servo.hpp>
#include <knurl/measure/progress.hpp>
#include <knurl/servo/realtime.hpp>

#include "doctor_machine.hpp"
#include "doctor_verdict.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

using json = knurl::Json;

constexpr double rates[] = {500, 1000, 2000, 4000, 10'000};  // Hz
constexpr double main_rate = 1000;
constexpr int rounds = 3;           // the servo and the bare loop take turns
constexpr double idle_share = 0.1;  // share of the time for the test of idle polling

struct DoctorArguments {
    double seconds = 50;
    int servo_cpu = -1;  // -1: the last one allowed
    std::string idle = "sleep";
    double spin = 0;  // s
    bool json = false;
};

struct Idle {
    std::optional<double> sleeping, polling;  // us late at the median at main_rate, of the bare loop
    std::string problem;                      // why it could not be tested
};

struct Examination {
    unsigned servo_cpu = 0;
    std::optional<unsigned> witness_cpu;
    bool real_time = true;
    std::vector<Finding> findings;
    std::vector<RateVerdict> rates;  // the judged rates
    Idle idle;
    bool interrupted = false;
};

void append(Beginnings& all, const Beginnings& more) {
    all.deadline.insert(all.deadline.end(), more.deadline.begin(), more.deadline.end());
    all.late.insert(all.late.end(), more.late.begin(), more.late.end());
}

class Doctor {
  public:
    Doctor(const DoctorArguments& arguments, const std::atomic<bool>& stop)
        : arguments_(arguments), stop_(stop), progress_("knurl doctor") {
        const auto cpus = measure::allowed_cpus();
        if (cpus.empty()) throw std::runtime_error("the CPUs that this process may use cannot be read");
        result_.servo_cpu =
            arguments.servo_cpu >= 0 ? static_cast<unsigned>(arguments.servo_cpu) : cpus.back();
        if (std::find(cpus.begin(), cpus.end(), result_.servo_cpu) == cpus.end()) {
            throw UsageError(fmt::format("--servo-cpu is {}, which this process may not use; give one of {}",
                                         result_.servo_cpu, fmt::join(cpus, ", ")));
        }
        for (const unsigned cpu : cpus) {
            if (cpu != result_.servo_cpu && !result_.witness_cpu) result_.witness_cpu = cpu;
        }
    }

    Examination examine() {
        const auto begin = now_ns();
        const Disturbance before = count_disturbances("/", result_.servo_cpu);
        if (result_.witness_cpu) witness_ = witness_on(*result_.witness_cpu);
        if (!witness_) result_.witness_cpu.reset();
        result_.findings = look_at_settings("/", result_.servo_cpu);
        const double each = arguments_.seconds * (1 - idle_share) / (2 * rounds * std::size(rates));
        std::string said;
        begin_ = begin;
        for (const double rate : rates)
            if (!stop_) examine_at(rate, each, said);
        if (!stop_) try_idle(arguments_.seconds * idle_share / 2);
        progress_.clear();
        result_.interrupted = stop_;
        if (result_.rates.empty()) throw std::runtime_error("interrupted before the first rate was judged");
        const Disturbance after = count_disturbances("/", result_.servo_cpu);
        const double seconds = static_cast<double>(now_ns() - begin) * 1e-9;

        std::vector<Finding> findings = look_at_rights(said);
        for (auto& more : {std::move(result_.findings),
                           look_at_disturbances(before, after, seconds, result_.servo_cpu), look_at_usb("/")})
            findings.insert(findings.end(), more.begin(), more.end());
        result_.findings = std::move(findings);
        return std::move(result_);
    }

  private:
    void progress(const std::string& text) {
        const double done = static_cast<double>(now_ns() - begin_) * 1e-9;
        progress_.show(fmt::format("{}: {}", measure::seconds_of(done, arguments_.seconds), text));
    }

    void examine_at(double rate, double seconds, std::string& said) {
        const auto length = static_cast<Nanoseconds>(seconds * 1e9);
        Beginnings of_servo, bare;
        std::vector<Gap> gaps;
        for (int round = 0; round < rounds && !stop_; ++round) {
            progress(fmt::format("{:g} Hz, {} of {} turns", rate, round + 1, rounds));
            {
                measure::PrivateServo servo({"--device", "sim:cartesian3", "--rate",
                                             fmt::format("{:g}", rate), "--cpu",
                                             std::to_string(result_.servo_cpu), "--idle", arguments_.idle,
                                             "--spin", fmt::format("{:g}", arguments_.spin)});
                try {
                    append(of_servo, servo_loop(servo.address(), length, stop_));
                } catch (const std::exception&) {
                    servo.require_running();  // says why it does not run
                    throw;
                }
                said = servo.said();
            }
            servo::Shortfalls none;
            const shm::UniqueFd held =
                arguments_.idle == "poll" ? servo::hold_idle_polling(none) : shm::UniqueFd{};
            append(bare, bare_loop(rate, result_.servo_cpu, length, stop_));
            if (witness_) {
                const auto more = witness_->gaps();
                gaps.insert(gaps.end(), more.begin(), more.end());
            }
        }
        if (stop_) return;  // an incomplete set of turns cannot support the verdict
        result_.real_time = said.find("no real-time priority") == std::string::npos;
        result_.rates.push_back(
            judge(rate, figures(of_servo, gaps, rate), figures(bare, gaps, rate), result_.real_time));
    }

    /// Runs the bare loop once more, with idle CPUs polling: the effect of that setting.
    void try_idle(double seconds) {
        const auto length = static_cast<Nanoseconds>(seconds * 1e9);
        progress("with and without idle polling");
        result_.idle.sleeping =
            figures(bare_loop(main_rate, result_.servo_cpu, length, stop_), {}, main_rate).p50;
        servo::Shortfalls missing;
        const shm::UniqueFd held = servo::hold_idle_polling(missing);
        if (!held)
            result_.idle.problem = fmt::format("{}", fmt::join(missing.report(), "; "));
        else
            result_.idle.polling =
                figures(bare_loop(main_rate, result_.servo_cpu, length, stop_), {}, main_rate).p50;
    }

    DoctorArguments arguments_;
    const std::atomic<bool>& stop_;
    measure::Progress progress_;
    Nanoseconds begin_ = 0;
    Examination result_;
    std::unique_ptr<Witness> witness_;
};

const char* mark(Grade grade) {
    return grade == Grade::good ? "ok  " : grade == Grade::note ? "note" : "BAD ";
}

std::string figures_line(const char* who, const LoopFigures& f) {
    const auto number = [](const std::optional<double>& us) { return us ? fmt::format("{:.1f}", *us) : "-"; };
    std::string line =
        fmt::format("           {:<9}  late by p50 {:>6}, p99 {:>7}, p99.9 {:>7}, max {:>8} us of {} cycles",
                    who, number(f.p50), number(f.p99), number(f.p999), number(f.max), f.cycles);
    if (f.stalls.count > 0)
        line += fmt::format("; besides {} standstill{} of the machine, the longest {:.1f} ms", f.stalls.count,
                            f.stalls.count == 1 ? "" : "s", static_cast<double>(f.stalls.longest) / 1e6);
    return line + "\n";
}

void print_text(const Examination& found, const DoctorArguments& arguments) {
    const measure::Machine machine = measure::this_machine();
    fmt::print("{}, {} CPUs, Linux {}, load {}, {}\nservo on CPU {}, idle \"{}\", spin {:g} s; {}\n\n",
               machine.processor, machine.cpus, machine.kernel, machine.load, machine.date, found.servo_cpu,
               arguments.idle, arguments.spin,
               found.witness_cpu ? fmt::format("witness of standstills on CPU {}", *found.witness_cpu)
                                 : "no other CPU for a witness of standstills, or no right to its priority");
    for (const Finding& finding : found.findings) {
        fmt::print("{} {}: {}\n", mark(finding.grade), finding.what, finding.says);
        if (finding.grade != Grade::good && !finding.mend.empty())
            fmt::print("       mend: {}\n", finding.mend);
    }
    if (!found.idle.problem.empty()) {
        fmt::print("     idle polling could not be tried: {}\n", found.idle.problem);
    } else if (found.idle.sleeping && found.idle.polling) {
        fmt::print("     idle polling takes a bare loop's median lateness from {:.1f} to {:.1f} us\n",
                   *found.idle.sleeping, *found.idle.polling);
    }
    fmt::print("\n");
    for (const RateVerdict& verdict : found.rates) {
        fmt::print("{:>6g} Hz  {}: {}\n", verdict.rate, name_of(verdict.fitness), verdict.reason);
        fmt::print("{}{}", figures_line("servo", verdict.servo), figures_line("bare loop", verdict.bare));
        if (const measure::Comparison& c = verdict.lateness; c.problem.empty())
            fmt::print("           the servo's median is {:.2f} ({:.2f} to {:.2f}) of the bare loop's{}\n",
                       c.ratio, c.interval.low, c.interval.high,
                       c.verdict == measure::Verdict::undecided ? ": that may be chance" : "");
    }
}

/// From microseconds.
json seconds(const std::optional<double>& us) {
    return us ? json(*us / 1e6) : json();
}

json to_json(const LoopFigures& f) {
    return {{"cycles", f.cycles},
            {"on_time", f.on_time},
            {"late_p50_s", seconds(f.p50)},
            {"late_p99_s", seconds(f.p99)},
            {"late_p999_s", seconds(f.p999)},
            {"late_max_s", seconds(f.max)},
            {"stalls", f.stalls.count},
            {"longest_stall_s", static_cast<double>(f.stalls.longest) * 1e-9}};
}

json to_json(const Examination& found, const DoctorArguments& arguments) {
    const measure::Machine machine = measure::this_machine();
    json findings = json::array(), verdicts = json::array();
    for (const Finding& finding : found.findings) {
        findings.push_back({{"what", finding.what},
                            {"grade", finding.grade == Grade::good   ? "good"
                                      : finding.grade == Grade::note ? "note"
                                                                     : "bad"},
                            {"says", finding.says},
                            {"mend", finding.mend.empty() ? json() : json(finding.mend)}});
    }
    for (const RateVerdict& verdict : found.rates) {
        const measure::Comparison& c = verdict.lateness;
        verdicts.push_back(
            {{"rate", verdict.rate},
             {"fitness", name_of(verdict.fitness)},
             {"reason", verdict.reason},
             {"servo", to_json(verdict.servo)},
             {"bare_loop", to_json(verdict.bare)},
             {"servo_to_bare",
              c.problem.empty() ? json{{"ratio", c.ratio}, {"low", c.interval.low}, {"high", c.interval.high}}
                                : json()}});
    }
    return {{"machine",
             {{"processor", machine.processor},
              {"cpus", machine.cpus},
              {"kernel", machine.kernel},
              {"load", machine.load},
              {"idle", machine.idle},
              {"date", machine.date}}},
            {"servo_cpu", found.servo_cpu},
            {"witness_cpu", found.witness_cpu ? json(*found.witness_cpu) : json()},
            {"idle", arguments.idle},
            {"spin_s", arguments.spin},
            {"real_time", found.real_time},
            {"ended", found.interrupted ? json("interrupted") : json()},
            {"findings", findings},
            {"idle_polling",
             {{"sleeping_late_p50_s", seconds(found.idle.sleeping)},
              {"polling_late_p50_s", seconds(found.idle.polling)},
              {"problem", found.idle.problem.empty() ? json() : json(found.idle.problem)}}},
            {"rates", verdicts}};
}

int run_doctor(const DoctorArguments& arguments) {
    if (!(arguments.seconds >= 5 && arguments.seconds <= 3600))
        throw UsageError(fmt::format("--seconds is {:g}; give 5 to 3600", arguments.seconds));
    commandline::stop_on_signals();
    const Examination found = Doctor(arguments, commandline::stop).examine();
    if (arguments.json)
        fmt::print("{}\n", to_json(found, arguments).dump(2));
    else
        print_text(found, arguments);
    if (found.interrupted)
        throw std::runtime_error(fmt::format("interrupted; {} of {} rates were judged until then",
                                             found.rates.size(), std::size(rates)));
    const auto main = std::find_if(found.rates.begin(), found.rates.end(),
                                   [](const auto& v) { return v.rate == main_rate; });
    return main->fitness == Fitness::unfit ? 1 : 0;
}

}  // namespace

void add_doctor(commandline::Command& program) {
    auto& verb = program.verb(
        "doctor", "Is this machine fit for a hand, at which rate, and what would make it better?");
    auto arguments = std::make_shared<DoctorArguments>();
    verb.option("--seconds", arguments->seconds, "to measure for, in all").shows_default().type_name("S");
    verb.option("--servo-cpu", arguments->servo_cpu, "where the servo runs; default: the last CPU")
        .within(0, 1023)
        .type_name("CPU");
    verb.option("--idle", arguments->idle, "as knurld's: what idle CPUs do")
        .shows_default()
        .one_of({"sleep", "poll"});
    verb.option("--spin", arguments->spin, "as knurld's: the last part of each sleep that the servo spins")
        .shows_default()
        .type_name("S");
    verb.flag("--json", arguments->json, "for programs");
    verb.footer(
        "Starts servos of its own, on a simulated device, beside a loop with nothing in it; run it on a "
        "machine that is as busy as "
        "it will be, and with no other servo on that CPU.\nCtrl-C ends it with the verdicts that it has. "
        "Exit code 1: unfit at 1 kHz, or interrupted.");
    verb.action([arguments] { return run_doctor(*arguments); });
}

}  // namespace knurl::cli
