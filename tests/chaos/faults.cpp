#include "faults.hpp"

#include <csignal>

namespace knurl::chaos {

using drivers::shared_sim::control_unplug;
using test::eventually;
using test::Program;

namespace {

// N: a quarter of the permitted deviation from 1.6 N, at which a hand of 200 N/m and the wall of 800 N/m are
// in equilibrium.
constexpr double steady = 0.25;

std::string contains(const std::string& output, const std::string& part) {
    return output.find(part) == std::string::npos ? "missing '" + part + "' in: " + output : "";
}

// ------------------------------------------------------------------------------------- an application

void application_killed(Stage& stage) {
    const std::int64_t from = Stage::now();
    stage.wall->signal(SIGKILL);
    stage.measured("application killed: zero within 60 ms",
                   static_cast<double>(stage.wait_until_zero(from) - from) * 1e-6);
    demand(eventually([&] { return stage.state() == DeviceState::idle; }),
           "a device that nobody holds is idle");
    stage.start_wall();  // its place is free: the claim is granted
}

void application_stopped(Stage& stage) {
    const std::int64_t from = Stage::now();
    stage.wall->signal(SIGSTOP);
    stage.measured("application stopped: silence (250 ms) and fade (100 ms)",
                   static_cast<double>(stage.wait_until_zero(from) - from) * 1e-6);
    stage.wall->signal(SIGCONT);
}

void application_forks(Stage& stage) {
    const std::int64_t from = Stage::now();
    stage.wall->signal(SIGUSR2);
    stage.wall->wait_for_output("forked");
    stage.let_pass(0.2);
    demand_undisturbed(stage, from, "a child of a fork");
}

void second_application(Stage& stage) {
    const std::int64_t from = Stage::now();
    Program other(stage.home, KNURL_CHAOS_APP, {"exclusive"});
    demand(other.wait() == 0, "a claim that is refused is no crash");
    const std::string missing =
        contains(other.output(), "refused-by #1 " + std::to_string(stage.wall->pid()));
    demand(missing.empty(), "the second application is told who holds the device; " + missing);
    demand_undisturbed(stage, from, "a refused claim");
}

void slow_reader(Stage& stage) {
    const std::int64_t from = Stage::now();
    Program reader(stage.home, KNURL_CHAOS_APP, {"observer"});
    reader.wait_for_output("reading");
    reader.signal(SIGSTOP);
    stage.let_pass(5.0);  // longer than the ring of 4096 reports at 1 kHz
    reader.signal(SIGCONT);
    stage.let_pass(0.2);
    reader.signal(SIGTERM);
    demand(reader.wait() == 0,
           "what was read and what was missed make what was published: " + reader.output());
    demand(contains(reader.output(), "missed #3 0").size() > 0, "five seconds are more than the ring holds");
    demand_undisturbed(stage, from, "a reader that stands still");
}

void hostile_bytes(Stage& stage) {
    const std::int64_t from = Stage::now();
    Program other(stage.home, KNURL_CHAOS_APP,
                  {"hostile", std::to_string(stage.random()), stage.home.socket()});
    other.wait_for_output("scribbling");
    stage.let_pass(0.5);
    if (stage.random() % 2 == 0)
        other.signal(SIGKILL);
    else
        other.signal(SIGTERM);
    other.wait();
    stage.let_pass(0.1);
    demand_undisturbed(stage, from, "random bytes in another client's segment");
}

void absurd_numbers(Stage& stage) {
    const std::int64_t from = Stage::now();
    Program other(stage.home, KNURL_CHAOS_APP,
                  {"absurd", std::to_string(stage.random()), stage.home.socket()});
    demand(other.wait() == 0, "the owner of a bad batch is told: " + other.output());
    const std::string damping = std::to_string(knurl::row_of<knurl::Plane>("damping"));
    demand(contains(other.output(), "told-of-field #1 " + damping).empty(),
           "it is told which field: damping");
    demand_undisturbed(stage, from, "a batch with NaN or infinity");
}

void wrong_build(Stage& stage) {
    const std::int64_t from = Stage::now();
    test::RawClient client(stage.home);
    protocol::Hello hello;
    hello.layout = protocol::wire_hash() ^ stage.random();
    client.send(hello);
    const test::Answer answer = client.answer();
    demand(answer.refused.has_value() && answer.fds.empty(), "another layout is refused and gets no memory");
    demand_undisturbed(stage, from, "a client of another build");
}

// -------------------------------------------------------------------------------------------- attackers

/// Runs attackers of one kind during its lifetime.
class Attack {
  public:
    Attack(Stage& stage, const std::string& mode, int count) {
        for (int i = 0; i < count; ++i)
            attackers_.push_back(std::make_unique<Program>(
                stage.home, KNURL_CHAOS_ATTACKER,
                std::vector<std::string>{mode, std::to_string(stage.random()), stage.home.socket()}));
        for (const auto& attacker : attackers_) attacker->wait_for_output("attacking");
    }

  private:
    std::vector<std::unique_ptr<Program>> attackers_;  // killed at the end
};

void under(Stage& stage, const std::string& mode, int count, const std::string& by) {
    const std::int64_t from = Stage::now();
    {
        const Attack attack(stage, mode, count);
        stage.let_pass(1.0);
        demand_undisturbed(stage, from, by);
        const std::int64_t killed = Stage::now();
        stage.wall->signal(SIGKILL);
        stage.measured("application killed beside " + by + ": zero within 60 ms",
                       static_cast<double>(stage.wait_until_zero(killed) - killed) * 1e-6);
    }
    stage.start_wall();
}

void holes_in_memory(Stage& stage) {
    under(stage, "holes", 2, "clients that take pages of their memory away");
}
void lingering_descriptors(Stage& stage) {
    under(stage, "lingering", 2, "clients that send descriptors that take an hour to close");
}
void filled_sockets(Stage& stage) {
    under(stage, "waiting", 2, "clients that are woken again and again and read nothing");
}
void too_much_work(Stage& stage) {
    under(stage, "springs", 2, "claims with more springs than a cycle has time for");
}
void adding_and_removing(Stage& stage) {
    under(stage, "adding", 7, "98 claims that add and remove 256 springs each without end");
}
void churning_clients(Stage& stage) {
    under(stage, "churn", 16, "16 clients that come, send and go");
}

void guardian_stopped(Stage& stage) {
    const std::int64_t from = Stage::now();
    kill(stage.knurld->guardian(), SIGSTOP);
    const std::int64_t zero = stage.wait_until_zero(from);
    kill(stage.knurld->guardian(), SIGCONT);
    stage.measured("guardian stopped: ramp (50 ms) begins within 50 ms",
                   static_cast<double>(zero - from) * 1e-6);
    demand_off_until_armed(stage, zero, "after the guardian stood still");
}

void guardian_killed(Stage& stage) {
    const std::int64_t from = Stage::now();
    kill(stage.knurld->guardian(), SIGKILL);
    const std::int64_t zero = stage.wait_until_zero(from);
    stage.measured("guardian killed: ramp (50 ms), then the servo ends",
                   static_cast<double>(zero - from) * 1e-6);
    demand(stage.knurld->wait() == 1, "a servo without its guardian ends");
    stage.start_servo();
    stage.wall->wait_for_output("reattached-to " + std::to_string(stage.knurld->pid()));
    demand_off_until_armed(stage, zero, "after a restart");
}

// --------------------------------------------------------------------------------------------- the servo

void servo_killed(Stage& stage) {
    const std::size_t saved = stage.flight_records().size();
    const std::int64_t from = Stage::now();
    stage.knurld->signal(SIGKILL);
    const std::int64_t zero = stage.wait_until_zero(from);
    stage.measured("servo killed: the guardian zeroes within 5 ms", static_cast<double>(zero - from) * 1e-6);
    const auto log = stage.device->log();
    demand(log.back().event == Event::guardian_write, "it is the guardian who has the last word");
    demand(eventually([&] { return stage.flight_records().size() == saved + 1; }),
           "the flight recorder is saved");
    stage.start_servo();
    const std::int64_t back = Stage::now();
    stage.wall->wait_for_output("reattached-to " + std::to_string(stage.knurld->pid()));
    stage.measured("servo restarted: the library attaches within 500 ms (and its start-up)",
                   static_cast<double>(Stage::now() - back) * 1e-6);
    demand_off_until_armed(stage, zero, "after a restart");
}

void servo_stopped(Stage& stage) {
    const std::int64_t from = Stage::now();
    stage.knurld->signal(SIGSTOP);
    const std::int64_t zero = stage.wait_until_zero(from);
    stage.measured("servo stopped: the guardian zeroes within 5 ms", static_cast<double>(zero - from) * 1e-6);
    const std::int64_t back = Stage::now();
    stage.knurld->signal(SIGCONT);
    stage.let_pass(0.6);
    // The ramp takes 0.5 s of the servo's time, which is never ahead of the device's. A servo that was
    // stopped between computing an effort and writing it still writes this one, but no second one.
    int above = 0;
    for (const Record& record : stage.device->log()) {
        const double allowed = 0.2 + 8.1 * static_cast<double>(record.t - back) * 1e-9 / 0.5;
        if (record.t >= back && is_write(record) && force_of(record) > allowed) ++above;
    }
    demand(above <= 1, "a servo that stood still comes back through the ramp, not with its old force");
}

// -------------------------------------------------------------------------------------------- the device

void device_unplugged(Stage& stage) {
    stage.device->control(control_unplug);
    demand(eventually([&] {
               return stage.state() == DeviceState::fault || stage.state() == DeviceState::disconnected;
           }),
           "an unplugged device is a fault");
    const std::int64_t from = Stage::now();
    stage.device->control(0);
    demand(eventually([&] { return stage.state() == DeviceState::idle; }), "plugged in again it is idle");
    demand_off_until_armed(stage, from, "after plugging in");
}

constexpr Fault all[] = {
    {"application killed", application_killed},
    {"application stopped", application_stopped},
    {"application forks", application_forks},
    {"second application", second_application},
    {"slow reader", slow_reader},
    {"hostile bytes", hostile_bytes},
    {"absurd numbers", absurd_numbers},
    {"wrong build", wrong_build},
    {"holes in memory", holes_in_memory},
    {"lingering descriptors", lingering_descriptors},
    {"filled sockets", filled_sockets},
    {"too much work", too_much_work},
    {"adding and removing", adding_and_removing},
    {"churning clients", churning_clients},
    {"guardian stopped", guardian_stopped},
    {"guardian killed", guardian_killed},
    {"servo killed", servo_killed},
    {"servo stopped", servo_stopped},
    {"device unplugged", device_unplugged},
};

}  // namespace

void demand_undisturbed(Stage& stage, std::int64_t from, const std::string& by) {
    const Span span = force_span(stage.device->log(), from);
    if (span.smallest > 1.6 - 4 * steady && span.largest < 1.6 + 4 * steady) return;
    throw Broken(by + " leaves the others' force alone: " + std::to_string(span.smallest) + " to " +
                 std::to_string(span.largest) + " N; " + how_it_fell(stage.device->log(), from) +
                 "; the device's state is " + std::to_string(static_cast<int>(stage.state())) +
                 ", the application said: " + stage.wall->output());
}

void demand_off_until_armed(Stage& stage, std::int64_t from, const std::string& after) {
    stage.let_pass(0.3);
    // At `from` itself the last force may still have been in effect.
    const double force = largest_force(stage.device->log(), from + 1);
    demand(force <= 0, "no force " + after + " until somebody arms, but " + std::to_string(force) + " N");
    stage.wall->signal(SIGUSR1);
}

std::span<const Fault> faults() {
    return all;
}

}  // namespace knurl::chaos
