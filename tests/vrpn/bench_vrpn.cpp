// knurl_bench_vrpn: how late a VRPN client of knurl-vrpn is. In alternating blocks of one run:
//   - a report, from the servo's write to the client's thread that was blocked in recv()
//   - the same way with nothing of VRPN: a thread that waits for the report and sends a datagram of the same size
//   - a plane that the client sends, until the write of the first force by it
// and, with --beside, the reports of any other VRPN server on this host, from the stamp that it gives them.
//
//   knurl_bench_vrpn [--blocks N] [--json FILE] [--beside SENDER@PORT]

#include <atomic>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <random>
#include <thread>

#include <knurl/commandline/program.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/vrpn/server.hpp>

#include "../client/servo_process.hpp"
#include "wire_client.hpp"

namespace {

using namespace client_test;
using namespace vrpn_test;
namespace measure = knurl::measure;
using knurl::HandReport;
using knurl::Observer;

constexpr int reports_a_block = 300, planes_a_block = 30;
constexpr std::size_t datagram_bytes = 88 + 96 + 48 + 80;  // pose, velocity, force, contact point
constexpr double goal_ratio = 1.2;

std::int64_t clock_ns(clockid_t clock) {
    timespec now{};
    ::clock_gettime(clock, &now);
    return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

std::int64_t stamp_ns(const Header& header) {
    return header.seconds * std::int64_t{1'000'000'000} + header.microseconds * std::int64_t{1000};
}

/// The server in a thread of its own, as knurl-vrpn has it.
class Served {
  public:
    Served()
        : server_({.port = 0, .force_peers = {host_range("localhost")}, .log = [](const std::string& line) {
                       std::fprintf(stderr, "%s\n", line.c_str());
                   }}) {
        server_.on_tick([this] {
            if (stop_) server_.stop();
        });
        thread_ = std::thread([this] { server_.run(); });
    }
    ~Served() {
        stop_ = true;
        thread_.join();
    }
    std::uint16_t port() const { return server_.port(); }

  private:
    Server server_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

/// Reports that were drained, to find one by the time at which it was read.
std::vector<HandReport> drained(Observer& observer) {
    std::vector<HandReport> all(4096);
    all.resize(observer.drain(all));
    return all;
}

/// From the servo's write to the client. The stamp of a message is when its report was read.
std::vector<double> report_block(WireClient& client, Observer& observer) {
    drained(observer);
    client.forget();
    std::vector<std::pair<std::int64_t, std::int64_t>> seen;  // read, got
    for (int i = 0; i < reports_a_block; ++i) {
        const auto header = client.wait(Type::force);
        const std::int64_t got = clock_ns(CLOCK_MONOTONIC);
        if (!header) throw std::runtime_error("no report within 5 s");
        const std::int64_t to_wall = clock_ns(CLOCK_REALTIME) - clock_ns(CLOCK_MONOTONIC);
        seen.emplace_back(stamp_ns(*header) - to_wall, got);
    }
    const std::vector<HandReport> reports = drained(observer);
    std::vector<double> microseconds;
    std::size_t at = 0;
    for (const auto& [read, got] : seen) {
        while (at < reports.size() && reports[at].read_ns < read - 300'000) ++at;
        if (at == reports.size() || reports[at].read_ns > read + 300'000) continue;
        microseconds.push_back(static_cast<double>(got - reports[at].write_ns) * 1e-3);
    }
    return microseconds;
}

/// Waits for reports in one thread and sends a datagram; another one receives it.
std::vector<double> bare_block(Observer& observer) {
    const LoopbackSocket from(SOCK_DGRAM), to(SOCK_DGRAM);
    std::atomic<bool> ends{false};
    drained(observer);
    std::thread sender([&] {
        std::vector<std::byte> datagram(datagram_bytes);
        while (!ends) {
            const auto frame = observer.newest(100ms);
            if (!frame) continue;
            std::memcpy(datagram.data(), &frame->write_ns, sizeof frame->write_ns);
            from.send(datagram, to.port);
        }
    });
    std::vector<double> microseconds;
    std::array<std::byte, 2048> datagram;
    for (int i = 0; i < reports_a_block; ++i) {
        if (::recv(to.fd, datagram.data(), datagram.size(), 0) < 0) break;
        const std::int64_t got = clock_ns(CLOCK_MONOTONIC);
        std::int64_t written = 0;
        std::memcpy(&written, datagram.data(), sizeof written);
        microseconds.push_back(static_cast<double>(got - written) * 1e-3);
    }
    ends = true;
    sender.join();
    return microseconds;
}

/// One way between two threads that are asleep.
std::vector<double> one_way_block() {
    const LoopbackSocket from(SOCK_DGRAM), to(SOCK_DGRAM);
    std::vector<double> microseconds;
    std::thread receiver([&] {
        std::array<std::byte, 2048> datagram;
        for (int i = 0; i < reports_a_block; ++i) {
            if (::recv(to.fd, datagram.data(), datagram.size(), 0) < 0) return;
            const std::int64_t got = clock_ns(CLOCK_MONOTONIC);
            std::int64_t sent = 0;
            std::memcpy(&sent, datagram.data(), sizeof sent);
            microseconds.push_back(static_cast<double>(got - sent) * 1e-3);
        }
    });
    std::vector<std::byte> datagram(datagram_bytes);
    for (int i = 0; i < reports_a_block; ++i) {
        std::this_thread::sleep_for(1ms);
        const std::int64_t now = clock_ns(CLOCK_MONOTONIC);
        std::memcpy(datagram.data(), &now, sizeof now);
        from.send(datagram, to.port);
    }
    receiver.join();
    return microseconds;
}

/// y <= height is inside: up in the client's axes.
void put_plane(PayloadWriter& out, float share) {
    out.clear();
    for (const float value : {0.f, 1.f, 0.f, -0.005f, share, 0.f, 0.f, 0.f}) out.put(value);
    out.put(std::int32_t{0}).put(std::int32_t{0});  // index; at once
}

/// From the client's send to the write of the first force by the new plane. The plane is by turns soft and stiff, which
/// the force shows at once; the moments are spread over the cycle.
std::vector<double> plane_block(WireClient& client, Observer& observer, std::mt19937& chance) {
    std::vector<double> microseconds;
    PayloadWriter out;
    std::uniform_int_distribution<int> spread(0, 1000);
    for (int i = 0; i < planes_a_block; ++i) {
        put_plane(out, i % 2 == 0 ? 0.02f : 0.04f);
        std::this_thread::sleep_for(20ms + std::chrono::microseconds(spread(chance)));
        drained(observer);
        const auto before = observer.latest();
        const std::int64_t sent = clock_ns(CLOCK_MONOTONIC);
        client.send(Type::plane, out.bytes());
        double last = before ? before->scene_force.z : 0;
        for (int n = 0; n < 20; ++n) {
            const auto report = observer.next_report(100ms);
            if (!report) break;
            const double force = report->scene_force.z;
            if (std::abs(force - last) > 0.2 * std::abs(last) && report->write_ns > sent) {
                microseconds.push_back(static_cast<double>(report->write_ns - sent) * 1e-3);
                break;
            }
            last = force;
        }
        client.forget();
    }
    return microseconds;
}

/// From the server's own stamp, whole microseconds of the wall clock.
std::vector<double> beside_block(WireClient& client) {
    std::vector<double> microseconds;
    client.forget();
    for (int i = 0; i < reports_a_block; ++i) {
        const auto header = client.wait(Type::pos_quat);
        const std::int64_t got = clock_ns(CLOCK_REALTIME);
        if (!header) throw std::runtime_error("the other server sends no report within 5 s");
        microseconds.push_back(static_cast<double>(got - stamp_ns(*header)) * 1e-3);
    }
    return microseconds;
}

/// Waits until the plane is felt in full.
void arm(WireClient& client, Observer& observer) {
    PayloadWriter out;
    put_plane(out, 0.02f);
    client.send(Type::plane, out.bytes());
    if (!eventually([&] {
            const auto report = observer.latest();
            return report && report->state == knurl::DeviceState::active;
        }))
        throw std::runtime_error("the force is never switched on");
    client.forget();
}

struct Options {
    int blocks = 40;
    const char* file = nullptr;
    std::string sender;
    std::uint16_t port = 0;
};

int run(const Options& options) {
    if (options.file) measure::require_writable(options.file);
    measure::Run run{.machine = measure::this_machine(), .results = {}};
    ServoProcess servo({"--device", "right=sim:premium15,grip=1"});
    knurl::Client watcher = connect();
    Observer observer = watcher.observe();
    Served served;
    std::mt19937 chance(1);
    measure::Blocks reports, bare, one_way, planes, beside;
    for (int i = 0; i < options.blocks; ++i) {
        {
            WireClient client(served.port(), "Phantom0");
            reports.add(report_block(client, observer));
            arm(client, observer);
            planes.add(plane_block(client, observer, chance));
        }
        bare.add(bare_block(observer));
        one_way.add(one_way_block());
        if (options.port == 0) continue;
        WireClient other(options.port, options.sender);
        beside.add(beside_block(other));
    }
    run.results = {measure::summarise_blocks("servo's write, wake-up, one datagram", "us", bare),
                   measure::summarise_blocks("servo's write to a VRPN client", "us", reports),
                   measure::summarise_blocks("one datagram, receiver asleep", "us", one_way),
                   measure::summarise_blocks("a client's plane to the force's write", "us", planes)};
    measure::relate(run.results[1], run.results[0]);
    if (options.port != 0) {
        run.results.push_back(
            measure::summarise_blocks("another VRPN server's stamp to a client", "us", beside));
        measure::relate(run.results.back(), run.results[2]);
    }
    measure::print(std::cout, run);
    const double ratio = run.results[1].ratio.value_or(0);
    std::printf("a report at most %g x wake-up and datagram: %s\n", goal_ratio,
                ratio <= goal_ratio ? "kept" : "not kept");
    if (run.results[3].p99 && run.results[2].p99) {
        const double most = 1000 + *run.results[2].p99;
        std::printf("a plane at 99 %% within a cycle and one way, %.0f us: %s\n", most,
                    *run.results[3].p99 <= most ? "kept" : "not kept");
    }
    if (options.file) measure::write_file(options.file, measure::to_json(run));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; i += 2) {
        const std::string word = argv[i], value = i + 1 < argc ? argv[i + 1] : "";
        const std::size_t at = value.find('@');
        if (word == "--json" && !value.empty()) {
            options.file = argv[i + 1];
        } else if (word == "--blocks" && !value.empty()) {
            options.blocks = std::max(1, std::atoi(argv[i + 1]));
        } else if (word == "--beside" && at != std::string::npos) {
            options.sender = value.substr(0, at);
            options.port = static_cast<std::uint16_t>(std::atoi(value.c_str() + at + 1));
        } else {
            std::fprintf(stderr,
                         "knurl_bench_vrpn: '%s': use [--blocks N] [--json FILE] [--beside SENDER@PORT]\n",
                         argv[i]);
            return 2;
        }
    }
    try {
        knurl::commandline::go_before_others();  // as knurl-vrpn does; the reference has it as well
        return run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurl_bench_vrpn: %s\n", error.what());
        return 1;
    }
}
