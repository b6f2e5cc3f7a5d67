// knurl_bench_dds: measured_cp of a servo at 1 kHz to one reader that sleeps, beside a bare Cyclone writer of the same message that
// a clock wakes 1000 times a second; by turns, in one run. The knurl-dds of the servo is woken by the servo's report, so it has
// the way of a local reader to go as well (the third line).

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/dds/domain.hpp>

#include "../client/servo_process.hpp"
#include "ros_messages.h"

namespace {

using namespace std::chrono_literals;
using namespace knurl;

constexpr int rounds = 20;
constexpr auto round_time = 600ms, settle = 200ms;

std::uint32_t domain_number() {
    return 1 + static_cast<std::uint32_t>(::getpid()) % 99;
}

class Child {
  public:
    explicit Child(std::vector<std::string> words) : pid_(::fork()) {
        if (pid_ != 0) return;
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    ~Child() {
        ::kill(pid_, SIGTERM);
        ::waitpid(pid_, nullptr, 0);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    /// Seconds of CPU so far.
    double cpu() const {
        std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
        std::string text;
        std::getline(file, text);
        std::istringstream rest(text.substr(text.rfind(')') + 2));
        std::string word;
        double ticks = 0;
        for (int i = 0; i < 13 && rest >> word; ++i)
            if (i >= 11) ticks += std::stod(word);
        return ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
    }

  private:
    pid_t pid_;
};

double now_s() {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

struct Result {
    std::vector<double> us;
    double cpu = 0, seconds = 0;
    double at(double share) {
        if (us.empty()) return 0;
        std::sort(us.begin(), us.end());
        return us[std::min(us.size() - 1, static_cast<std::size_t>(share * static_cast<double>(us.size())))];
    }
};

/// One turn: a reader that sleeps in a waitset.
void read(dds::Domain& domain, const std::string& topic, const Child& writer, Result& result) {
    const dds::Entity reader = domain.reader(topic, geometry_msgs_msg_dds__PoseStamped__desc,
                                             {.message = "geometry_msgs/msg/PoseStamped", .depth = 10});
    const dds::Entity condition(dds_create_readcondition(reader.get(), DDS_ANY_STATE), "condition");
    const dds::Entity waitset(dds_create_waitset(domain.participant()), "waitset");
    dds::check(dds_waitset_attach(waitset.get(), condition.get(), 0), "waitset");
    const auto begin = std::chrono::steady_clock::now();
    std::optional<double> cpu;
    while (std::chrono::steady_clock::now() < begin + round_time) {
        dds_waitset_wait(waitset.get(), nullptr, 0, DDS_MSECS(50));
        const dds::Taken<geometry_msgs_msg_dds__PoseStamped_> taken(reader.get());
        const double now = now_s();
        if (std::chrono::steady_clock::now() < begin + settle) continue;
        if (!cpu) cpu = writer.cpu();
        for (std::size_t i = 0; i < taken.size(); ++i)
            if (taken.info(i).valid_data)
                result.us.push_back((now - taken[i].header.stamp.sec - taken[i].header.stamp.nanosec * 1e-9) *
                                    1e6);
    }
    result.cpu += writer.cpu() - cpu.value_or(0);
    result.seconds += std::chrono::duration<double>(round_time - settle).count();
}

/// The servo's report to a local reader that sleeps.
void read_local(Observer& observer, Result& result) {
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() < begin + round_time - settle)
        if (const auto report = observer.newest(50ms))
            result.us.push_back(static_cast<double>(observer.age(*report).age.count()) * 1e-3);
}

void print(const char* what, Result& result) {
    fmt::print("{:46} {:7} {:8.0f} {:8.0f} {:8.0f}", what, result.us.size(), result.at(0.5), result.at(0.99),
               result.at(1));
    if (result.seconds > 0) fmt::print(" {:9.1f} %", 100 * result.cpu / result.seconds);
    fmt::print("\n");
}

int run() {
    utsname machine{};
    ::uname(&machine);
    fmt::print("knurl_bench_dds: {} CPUs, Linux {}, Cyclone DDS 0.10; {} turns of {} ms each, loopback\n",
               ::sysconf(_SC_NPROCESSORS_ONLN), machine.release, rounds, (round_time - settle).count());
    client_test::ServoProcess servo;
    Client client = client_test::connect_beside();
    Observer observer = client.observe();
    const std::string domain = std::to_string(domain_number());
    const Child ours({KNURL_DDS, "--domain", domain, "--name", "bench"});
    const Child bare({KNURL_DDS_PEER, domain, "pose", "rt/bare", "1000"});
    dds::Domain here({.id = domain_number(), .peers = {}, .log = [](const std::string&) {}});
    std::this_thread::sleep_for(2s);  // all have found all
    Result knurl_dds, plain, local;
    for (int i = 0; i < rounds; ++i) {
        read(here, "rt/cartesian3/measured_cp", ours, knurl_dds);
        read(here, "rt/bare", bare, plain);
        read_local(observer, local);
    }
    fmt::print(
        "us                                             samples   median      p99      max    writer's "
        "CPU\n");
    print("measured_cp, from the read of the device", knurl_dds);
    print("bare Cyclone writer, from the write", plain);
    print("the servo's report to a local reader that sleeps", local);
    const double median = knurl_dds.at(0.5) / (plain.at(0.5) + local.at(0.5)),
                 cpu = knurl_dds.cpu / plain.cpu;
    fmt::print("median: {:.2f} x (bare writer + local reader); CPU: {:.2f} x the bare writer's\n", median,
               cpu);
    return 0;
}

}  // namespace

int main() {
    try {
        knurl::commandline::go_before_others();  // as knurl-dds does; the bare writer has it as well
        return run();
    } catch (const std::exception& error) {
        fmt::print(stderr, "knurl_bench_dds: {}\n", error.what());
        return 1;
    }
}
