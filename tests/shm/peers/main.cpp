#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <numeric>
#include <optional>
#include <random>
#include <stdexcept>
#include <string_view>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>

#include "transport.hpp"
#include "verdicts.hpp"

namespace {

using namespace knurl;
using namespace knurl::shm::peers;

constexpr Nanoseconds period = 1'000'000, patience = 10'000'000'000;
constexpr std::size_t cold = 2;  // messages of a block that are left out
// As for knurld and a client of high priority; each on a separate CPU.
constexpr int servo_priority = 80, waker_priority = 60, client_priority = 70;

struct Arguments {
    std::size_t blocks = 60, messages = 172;  // of each: enough for a 99.9th percentile
    std::uint64_t seed = std::random_device{}();
    std::string json;  // a file; empty: none
};

/// The process that receives by one transport. It ends with this object, or with this process.
class Receiver {
  public:
    Receiver(Transport& transport, Inbox& inbox, const Place& place) {
        const pid_t parent = ::getpid();
        pid_ = ::fork();
        if (pid_ < 0) throw std::runtime_error("cannot fork");
        if (pid_ > 0) return;
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != parent) ::_exit(1);
        measure::settle_on(place.client_cpu, place.client_priority);
        try {
            transport.receive(inbox);
        } catch (const std::exception& error) {
            std::fprintf(stderr, "knurl_bench_peers: the receiver of %s: %s\n", transport.name().c_str(),
                         error.what());
        }
        ::_exit(1);
    }
    ~Receiver() {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    Receiver(const Receiver&) = delete;
    Receiver& operator=(const Receiver&) = delete;

  private:
    pid_t pid_;
};

double process_cpu_ns() {
    timespec t{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
}

struct Channel {
    Transport& transport;
    Inbox& inbox;
    Seen& seen;
    std::uint64_t number = 0;  // of the newest message

    /// Waits until the first message has arrived: a subscription takes time.
    void wait_until_heard() const {
        for (const Nanoseconds begin = now_ns(); inbox.took(0) < 0;) {
            if (now_ns() - begin > patience) throw std::runtime_error("its receiver hears nothing");
            transport.send({.sent = now_ns(), .number = 0});
            measure::sleep_until(now_ns() + 10 * period);
        }
    }

    void block(std::size_t messages, const measure::Stopwatch& clock) {
        const std::uint64_t first = number + 1;
        std::vector<double> pays, has_it;
        std::vector<Nanoseconds> sent;
        const double cpu = process_cpu_ns();
        Nanoseconds due = now_ns() + 2 * period;
        for (std::size_t i = 0; i < messages; ++i) {
            measure::sleep_until(due);
            const Message message{.sent = now_ns(), .number = ++number};
            sent.push_back(message.sent);
            const std::uint64_t begin = measure::Stopwatch::begin();
            transport.send(message);
            const double took = clock.nanoseconds(begin, measure::Stopwatch::end());
            if (i >= cold) pays.push_back(took);
            // Like a servo, it skips what it has missed.
            due = std::max(due, now_ns() - period) + period;
        }
        measure::sleep_until(due);
        const double spent = process_cpu_ns() - cpu;
        for (int i = 0; i < 200 && inbox.took(number) < 0; ++i) measure::sleep_until(now_ns() + period);
        // Where the newest wins, a skipped message counts as arrived with the next newer one. Else a
        // transport that drops late messages would look fast.
        std::optional<Nanoseconds> known;
        for (std::size_t i = messages; i-- > cold;) {
            const Nanoseconds took = inbox.took(first + i);
            if (took >= 0)
                known = sent[i] + took;
            else
                ++seen.overtaken;
            if (known) has_it.push_back(static_cast<double>(*known - sent[i]));
        }
        seen.sent += messages - cold;
        constexpr double ns = 1e-3;  // in us
        seen.has_it.add(has_it, ns);
        seen.pays.add(pays, ns);
        seen.cpu.add({spent / static_cast<double>(messages)}, ns);
    }
};

std::vector<Seen> run(const Arguments& arguments, const Place& place) {
    Transports transports;
    add_floors(transports, place);
    add_knurl(transports, place);
    add_zeromq(transports);
    add_cyclone(transports);
    std::vector<Seen> seen;
    std::vector<std::unique_ptr<Inbox>> inboxes;
    std::vector<std::unique_ptr<Receiver>> receivers;
    for (const auto& transport : transports) {
        seen.push_back({.name = transport->name(), .settings = transport->settings()});
        inboxes.push_back(std::make_unique<Inbox>(arguments.blocks * arguments.messages));
    }
    // Before there is any other thread.
    for (std::size_t i = 0; i < transports.size(); ++i)
        receivers.push_back(std::make_unique<Receiver>(*transports[i], *inboxes[i], place));
    measure::settle_on(place.servo_cpu, place.servo_priority);
    std::vector<Channel> channels;
    for (std::size_t i = 0; i < transports.size(); ++i) {
        Channel channel{.transport = *transports[i], .inbox = *inboxes[i], .seen = seen[i]};
        try {
            transports[i]->connect(*inboxes[i]);
            channel.wait_until_heard();
            channels.push_back(channel);
        } catch (const std::exception& error) {
            std::fprintf(stderr, "knurl_bench_peers: %s is left out: %s\n", seen[i].name.c_str(),
                         error.what());
        }
    }
    const measure::Stopwatch clock;
    std::mt19937_64 random(arguments.seed);
    std::vector<std::size_t> order(channels.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t block = 0; block < arguments.blocks; ++block) {
        std::shuffle(order.begin(), order.end(), random);
        for (const std::size_t next : order) channels[next].block(arguments.messages, clock);
    }
    std::erase_if(seen, [](const Seen& one) { return one.sent == 0; });
    return seen;
}

std::vector<measure::Result> results_of(const std::vector<Seen>& all) {
    std::vector<measure::Result> results;
    for (const auto& [what, blocks] : {std::pair("client has it", &Seen::has_it),
                                       {"send call", &Seen::pays},
                                       {"sender's CPU a message", &Seen::cpu}}) {
        const std::size_t floor = results.size();
        for (const Seen& one : all) {
            results.push_back(measure::summarise_blocks(one.name + ": " + what, "us", one.*blocks));
            if (results.size() > floor + 1) measure::relate(results.back(), results[floor]);
        }
    }
    return results;
}

void write_json(const std::string& path, const measure::Run& run, const std::vector<Seen>& all,
                knurl::Json more) {
    more["settings"] = knurl::Json::object();
    for (const Seen& one : all) more["settings"][one.name] = one.settings;
    // The blocks stay one per line; additions go to the end.
    std::string text = measure::to_json(run);
    text.erase(text.rfind('}'));
    text.erase(text.find_last_not_of(" \n") + 1);
    measure::write_file(path, text + "," + more.dump(2).substr(1) + "\n");
}

bool number_in(const char* text, auto& value) {
    const std::string_view word = text;
    return std::from_chars(word.data(), word.data() + word.size(), value).ptr == word.data() + word.size() &&
           !word.empty();
}

int measure_peers(const Arguments& arguments) {
    if (!arguments.json.empty()) measure::require_writable(arguments.json);
    const std::vector<unsigned> cpus = measure::allowed_cpus();
    if (cpus.size() < 2) throw std::runtime_error("needs two CPUs");
    Place place{.servo_cpu = cpus.back(), .client_cpu = cpus.front()};
    const pid_t trial = ::fork();
    if (trial == 0) ::_exit(measure::run_real_time(servo_priority) ? 0 : 1);
    int status = 1;
    ::waitpid(trial, &status, 0);
    const bool real_time = status == 0;
    if (real_time) {
        place.servo_priority = servo_priority;
        place.waker_priority = waker_priority;
        place.client_priority = client_priority;
    } else {
        std::fprintf(stderr,
                     "knurl_bench_peers: no right to real-time priority (ulimit -r %d): all of them run as "
                     "ordinary threads\n",
                     servo_priority);
    }
    const std::vector<Seen> all = run(arguments, place);
    const measure::Run told{.machine = measure::this_machine(), .results = results_of(all)};
    const measure::Machine& machine = told.machine;
    std::cout << machine.processor << ", " << machine.cpus << " CPUs, Linux " << machine.kernel << ", load "
              << machine.load << ", idle " << machine.idle << "\n"
              << machine.build << ", " << machine.date << "\n";
    Verdicts verdicts = judge(all);
    std::cout << "seed " << arguments.seed << ", " << arguments.blocks << " blocks of " << arguments.messages
              << " messages each, in random order; " << (real_time ? "SCHED_FIFO" : "ordinary priority")
              << ", sender on CPU " << place.servo_cpu << ", receivers on CPU " << place.client_cpu << "\n\n"
              << table(all) << "\n"
              << verdicts.text << "\n";
    for (const Seen& one : all) std::cout << one.name << ": " << one.settings << "\n";
    verdicts.json["seed"] = arguments.seed;
    verdicts.json["real_time"] = real_time;
    if (!arguments.json.empty()) write_json(arguments.json, told, all, std::move(verdicts.json));
    return 0;
}

}  // namespace

int main(int argc, char** argv) try {
    Arguments arguments;
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        const char* const value = i + 1 < argc ? argv[++i] : "";
        bool good = true;
        if (word == "--json")
            arguments.json = value;
        else if (word == "--blocks")
            good = number_in(value, arguments.blocks) && arguments.blocks >= 1 && arguments.blocks <= 10'000;
        else if (word == "--messages")
            good = number_in(value, arguments.messages) && arguments.messages > cold &&
                   arguments.messages <= 10'000;
        else if (word == "--seed")
            good = number_in(value, arguments.seed);
        else
            good = false;
        if (good) continue;
        std::fprintf(
            stderr,
            "knurl_bench_peers [--blocks 60] [--messages 172] [--seed N] [--json FILE]\n"
            "  256 bytes at 1 kHz to a sleeping process: Knurl's report ring, UDP, ZeroMQ, Cyclone DDS,\n"
            "  and the bare wake-up, in blocks by turns. 30 blocks are the fewest for a verdict.\n");
        return 2;
    }
    return measure_peers(arguments);
} catch (const std::exception& error) {
    std::fprintf(stderr, "knurl_bench_peers: %s\n", error.what());
    return 1;
}
