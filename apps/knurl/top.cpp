// knurl top: how a servo spends its time, and what its clients do, live. Read-only: it costs the servo
// nothing.

#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>
#include <knurl/json/json.hpp>
#include <knurl/measure/sleeper.hpp>
#include <knurl/protocol/attach.hpp>

#include "domain.hpp"
#include "top_terminal.hpp"
#include "top_text.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

using measure::Nanoseconds, measure::now_ns;
using json = knurl::Json;

// While the program searches a servo, each look waits for an answer, and Ctrl-C waits for the look.
constexpr std::chrono::milliseconds answer_time{100};

struct TopArguments {
    std::string servo = "default";
    double hertz = 2;
    std::uint64_t count = 0;  // looks; 0: until interrupted
    bool json = false;
    std::optional<std::uint64_t> domain;
};

struct Look {
    pid_t pid = 0;
    double seconds = 0;                // since the look before
    std::vector<DeviceRates> devices;  // none: see `problem`
    std::string problem;
};

/// Looks repeatedly, and finds a servo that replaces an ended one.
class Looker {
  public:
    explicit Looker(const protocol::ServoAddress& servo) : socket_(servo.socket), servo_(servo) { begin(); }

    Look look() {
        const auto reports = servo_.new_reports();
        const Nanoseconds now = now_ns();
        ServoView view = servo_.look();
        Look look{.pid = view.pid,
                  .seconds = static_cast<double>(now - then_) * 1e-9,
                  .devices = {},
                  .problem = {}};
        bool moves = false;
        for (std::size_t i = 0; i < view.devices.size(); ++i) {
            DeviceRates rates = rates_between(before_.devices[i], view.devices[i], look.seconds, reports[i]);
            moves = moves || rates.rate > 0;
            if (i < last_.size()) keep_parts(last_[i], rates);
            look.devices.push_back(std::move(rates));
        }
        last_ = look.devices;
        before_ = std::move(view);
        then_ = now;
        if (!moves) find_again(look);
        return look;
    }

  private:
    void begin() {
        before_ = servo_.look();
        last_.clear();
        servo_.new_reports();
        then_ = now_ns();
    }

    /// An ended or stopped servo leaves its memory unchanged: finds out which servo answers now.
    void find_again(Look& look) {
        try {
            ServoWatch now(socket_, answer_time);
            if (now.look().pid == look.pid) return;
            look.problem = fmt::format("pid {} has taken the place of {}", now.look().pid, look.pid);
            servo_ = std::move(now);
            begin();
        } catch (const std::runtime_error& error) {
            look.problem = fmt::format("pid {} has ended or stands still: {}", look.pid, error.what());
        }
        look.devices.clear();
    }

    std::string socket_;
    ServoWatch servo_;
    ServoView before_;
    std::vector<DeviceRates> last_;
    Nanoseconds then_ = 0;
};

std::string text_of(const std::string& servo, const Look& look) {
    if (!look.problem.empty()) return fmt::format("knurl:{}  {}\n", servo, wrong(look.problem));
    std::string text = fmt::format("knurl:{}  pid {}  in {:.2f} s\n", servo, look.pid, look.seconds);
    for (const DeviceRates& device : look.devices) text += cli::text_of(device);
    return text;
}

std::string line_of(const std::string& servo, const Look& look) {
    json devices = json::array();
    for (const DeviceRates& device : look.devices) devices.push_back(cli::json_of(device));
    const json line = {{"servo", servo},
                       {"pid", look.pid > 0 ? json(look.pid) : json()},
                       {"interval_s", look.seconds},
                       {"problem", look.problem.empty() ? json() : json(look.problem)},
                       {"devices", devices}};
    return line.dump(-1) + "\n";
}

/// All hosts' servos, as often as they say what they are.
int watch_domain(const TopArguments& arguments) {
    Terminal terminal(!arguments.json);
    for (std::uint64_t n = 0; arguments.count == 0 || n < arguments.count; ++n) {
        const std::vector<Json> servos = servos_of_domain(*arguments.domain);
        terminal.show(arguments.json ? json_of_domain(*arguments.domain, servos, -1)
                                     : text_of_domain(*arguments.domain, servos));
        commandline::flush_output();
        if (n + 1 != arguments.count && !terminal.wait(1 / arguments.hertz)) return 0;
    }
    return 0;
}

int watch(const TopArguments& arguments) {
    if (!(arguments.hertz >= 0.1 && arguments.hertz <= 20))
        throw UsageError(fmt::format("--rate is {:g} Hz; give 0.1 to 20", arguments.hertz));
    if (arguments.domain) return watch_domain(arguments);
    const protocol::ServoAddress servo = servo_said(arguments.servo);
    Looker looker(servo);
    std::string problem;
    Terminal terminal(!arguments.json);
    for (std::uint64_t n = 0; arguments.count == 0 || n < arguments.count; ++n) {
        if (!terminal.wait(1 / arguments.hertz)) return 0;
        const Look look = looker.look();
        terminal.show(arguments.json ? line_of(servo.name, look) : text_of(servo.name, look));
        commandline::flush_output();  // the reader of a pipe may have gone
        problem = look.problem;
    }
    if (!problem.empty()) throw std::runtime_error(problem);
    return 0;
}

}  // namespace

void add_top(commandline::Command& program) {
    auto& verb = program.verb("top", "A servo at work, live: where its time goes, what its clients do");
    auto arguments = std::make_shared<TopArguments>();
    verb.servo(arguments->servo, "its name").shows_default().formerly("servo");
    verb.option("--rate", arguments->hertz, "samples per second, 0.1 to 20").shows_default().type_name("HZ");
    verb.option("--count", arguments->count, "end after this number of samples; default: when interrupted")
        .type_name("N");
    verb.flag("--json", arguments->json, "a line of JSON for each sample");
    verb.option("--domain", arguments->domain, "the servos of all hosts in this DDS domain, in place of one")
        .within(0, 232);
    verb.footer(
        "lateness  from a cycle's deadline until the device has been read; of the newest 4095 cycles at "
        "most\n"
        "late      cycles whose force was written after the next deadline\n"
        "overruns  cycles that began after the next deadline\n"
        "cycle     mean times of the parts, measured in one cycle of 64; sleep: the rest of the period\n"
        "age       from the read of the report that the newest update answers until its force is written\n"
        "merged    updates that another one replaced before the servo's next cycle\n"
        "missed    reports that the client was too slow to read, by its own count (a bridge: its own)\n"
        "12 merged (+3): 12 since the client connected, 3 since the last sample. Where output is no "
        "terminal, "
        "samples are printed one after the other.");
    verb.action([arguments] { return watch(*arguments); });
}

}  // namespace knurl::cli
