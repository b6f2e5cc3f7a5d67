#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <stdexcept>

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>

namespace knurl::measure {

namespace {

std::string first_line(const char* path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    return line;
}

std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string load() {
    double averages[3] = {};
    if (::getloadavg(averages, 3) != 3) return "unknown";
    char text[64];
    std::snprintf(text, sizeof text, "%.2f %.2f %.2f", averages[0], averages[1], averages[2]);
    return text;
}

std::string idle() {
    const std::string driver = first_line("/sys/devices/system/cpu/cpuidle/current_driver");
    std::string text = driver.empty() ? "unknown" : driver;
    // Reading makes no request: the value is the minimum over all holders.
    const int fd = ::open("/dev/cpu_dma_latency", O_RDONLY | O_CLOEXEC);
    std::int32_t microseconds = 0;
    if (fd >= 0 && ::read(fd, &microseconds, sizeof microseconds) == sizeof microseconds)
        text += ", cpu_dma_latency " + std::to_string(microseconds) + " us";
    if (fd >= 0) ::close(fd);
    return text;
}

std::string build() {
#if defined(__clang__)
    std::string text = "clang " __clang_version__;
#else
    std::string text = "gcc " __VERSION__;
#endif
#if defined(__OPTIMIZE__)
    return text + ", optimised";
#else
    return text + ", not optimised";
#endif
}

std::string date() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    ::gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

/// Nearest rank: the smallest sample that at least the fraction q of all samples does not exceed.
std::optional<double> percentile(const std::vector<double>& sorted, double q) {
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
    if (rank == 0 || sorted.size() - rank < least_above) return std::nullopt;
    return sorted[rank - 1];
}

template <class T>
knurl::Json or_null(const std::optional<T>& value) {
    return value ? knurl::Json(*value) : knurl::Json(nullptr);
}

knurl::Json to_json(const Histogram& histogram) {
    auto buckets = knurl::Json::array();
    for (const auto& [lower, count] : histogram.buckets()) buckets.push_back({lower, count});
    return buckets;
}

/// Puts one line into an otherwise indented text: `all` has the string `token` in the place of `value`.
void put_line(std::string& all, const std::string& token, const knurl::Json& value) {
    const std::string quoted = "\"" + token + "\"";
    all.replace(all.find(quoted), quoted.size(), value.dump());
}

const knurl::Json& array_of(const knurl::Json& value, const char* what) {
    if (!value.is_array()) throw knurl::JsonError(std::string("\"") + what + "\" is no array");
    return value;
}

Histogram histogram_from(const knurl::Json& buckets) {
    Histogram made;
    for (const auto& bucket : array_of(buckets, "blocks")) {
        const double lower = bucket.at(0);
        if (Histogram::lower_edge(lower) != lower || !bucket.at(1).is_number_unsigned())
            throw std::runtime_error("a bucket " + bucket.dump() + " is none of ours");
        made.record(lower, bucket.at(1));
    }
    return made;
}

std::string column(const std::optional<double>& value) {
    if (!value) return "-";
    char text[32];
    std::snprintf(text, sizeof text, *value < 10 ? "%.2f" : *value < 100 ? "%.1f" : "%.0f", *value);
    return text;
}

}  // namespace

Machine this_machine() {
    utsname system{};
    ::uname(&system);
    return {.processor = processor(),
            .cpus = static_cast<unsigned>(std::max(1L, ::sysconf(_SC_NPROCESSORS_ONLN))),
            .kernel = system.release,
            .load = load(),
            .idle = idle(),
            .build = build(),
            .date = date()};
}

Result summarise(std::string name, std::string unit, std::vector<double> samples) {
    Result result;
    result.name = std::move(name);
    result.unit = std::move(unit);
    result.n = samples.size();
    if (samples.empty()) return result;
    std::sort(samples.begin(), samples.end());
    result.p50 = percentile(samples, 0.5);
    result.p99 = percentile(samples, 0.99);
    result.p999 = percentile(samples, 0.999);
    result.max = samples.back();
    return result;
}

Result summarise_blocks(std::string name, std::string unit, const Blocks& samples) {
    const Histogram all = merged(samples.all());
    Result result;
    result.name = std::move(name);
    result.unit = std::move(unit);
    result.n = all.count();
    result.p50 = all.percentile(0.5);
    result.p99 = all.percentile(0.99);
    result.p999 = all.percentile(0.999);
    result.max = all.max();
    result.blocks = samples.all();
    return result;
}

void relate(Result& result, const Result& reference) {
    result.reference = reference.name;
    if (result.p50 && reference.p50 && *reference.p50 > 0) result.ratio = *result.p50 / *reference.p50;
}

void print(std::ostream& out, const Run& run) {
    const Machine& m = run.machine;
    out << m.processor << ", " << m.cpus << " CPUs, Linux " << m.kernel << ", load " << m.load << ", idle "
        << m.idle << "\n"
        << m.build << ", " << m.date << "\n\n";
    std::size_t width = 4;
    for (const Result& r : run.results) width = std::max(width, r.name.size());
    char line[512];
    std::snprintf(line, sizeof line, "%-*s %4s %8s %8s %8s %8s %9s  %s\n", static_cast<int>(width), "what",
                  "unit", "n", "p50", "p99", "p99.9", "max", "ratio to");
    out << line;
    for (const Result& r : run.results) {
        std::snprintf(line, sizeof line, "%-*s %4s %8zu %8s %8s %8s %9s  ", static_cast<int>(width),
                      r.name.c_str(), r.unit.c_str(), r.n, column(r.p50).c_str(), column(r.p99).c_str(),
                      column(r.p999).c_str(), column(r.max).c_str());
        out << line;
        if (r.ratio) {
            std::snprintf(line, sizeof line, "%.2f ", *r.ratio);
            out << line << *r.reference;
        }
        out << "\n";
    }
}

std::string to_json(const Run& run) {
    using knurl::Json;
    const Machine& m = run.machine;
    Json results = Json::array();
    std::vector<std::pair<std::string, Json>> lines;
    const auto line = [&lines](Json value) {
        lines.emplace_back("line " + std::to_string(lines.size()), std::move(value));
        return lines.back().first;
    };
    for (const Result& r : run.results) {
        results.push_back({{"name", r.name},
                           {"unit", r.unit},
                           {"n", r.n},
                           {"p50", or_null(r.p50)},
                           {"p99", or_null(r.p99)},
                           {"p999", or_null(r.p999)},
                           {"max", r.max},
                           {"reference", or_null(r.reference)},
                           {"ratio", or_null(r.ratio)}});
        if (r.blocks.empty()) continue;
        Json blocks = Json::array();
        for (const Histogram& block : r.blocks) blocks.push_back(to_json(block));
        results.back()["histogram"] = line(to_json(merged(r.blocks)));
        results.back()["blocks"] = line(std::move(blocks));
    }
    Json bounds = Json::array();
    for (const Bound& b : run.bounds)
        bounds.push_back({{"name", b.name},
                          {"unit", b.unit},
                          {"limit", b.limit},
                          {"n", b.n},
                          {"within", b.within},
                          {"references_within", b.references_within},
                          {"stalled", b.stalled}});
    const Json all = {{"machine",
                       {{"processor", m.processor},
                        {"cpus", m.cpus},
                        {"kernel", m.kernel},
                        {"load", m.load},
                        {"idle", m.idle},
                        {"build", m.build},
                        {"date", m.date}}},
                      {"results", results},
                      {"bounds", bounds}};
    std::string text = all.dump(2);
    for (const auto& [token, value] : lines) put_line(text, token, value);
    return text;
}

Run from_json(const std::string& text) {
    try {
        const auto all = knurl::Json::parse(text);
        const auto& m = all.at("machine");
        Run run{.machine = {.processor = m.at("processor"),
                            .cpus = m.at("cpus"),
                            .kernel = m.at("kernel"),
                            .load = m.at("load"),
                            .idle = m.at("idle"),
                            .build = m.at("build"),
                            .date = m.at("date")},
                .results = {}};
        const auto number = [](const knurl::Json& value) {
            return value.is_null() ? std::nullopt : std::optional<double>(value.get<double>());
        };
        for (const auto& r : array_of(all.at("results"), "results")) {
            Result result;
            result.name = r.at("name");
            result.unit = r.at("unit");
            result.n = r.at("n");
            result.p50 = number(r.at("p50"));
            result.p99 = number(r.at("p99"));
            result.p999 = number(r.at("p999"));
            result.max = r.at("max");
            if (!r.at("reference").is_null()) result.reference = r.at("reference");
            result.ratio = number(r.at("ratio"));
            if (r.contains("blocks"))
                for (const auto& block : array_of(r.at("blocks"), "blocks"))
                    result.blocks.push_back(histogram_from(block));
            run.results.push_back(std::move(result));
        }
        return run;
    } catch (const knurl::JsonError& error) {
        throw std::runtime_error(error.what());
    }
}

bool pin_this_thread(unsigned cpu) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(cpu, &set);
    return ::pthread_setaffinity_np(::pthread_self(), sizeof set, &set) == 0;
}

bool run_real_time(int priority) {
    const sched_param parameters{.sched_priority = priority};
    return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters) == 0;
}

std::vector<unsigned> allowed_cpus() {
    cpu_set_t set;
    CPU_ZERO(&set);
    std::vector<unsigned> cpus;
    if (::sched_getaffinity(0, sizeof set, &set) != 0) return cpus;
    for (unsigned cpu = 0; cpu < CPU_SETSIZE; ++cpu)
        if (CPU_ISSET(cpu, &set)) cpus.push_back(cpu);
    return cpus;
}

Stopwatch::Stopwatch() {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const std::uint64_t first = begin();
    while (Clock::now() - start < std::chrono::milliseconds(20)) {
    }
    const auto took = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
    nanoseconds_per_tick_ = took / static_cast<double>(begin() - first);
    std::vector<double> empty;
    for (int i = 0; i < 1001; ++i) {
        const std::uint64_t at = begin();
        empty.push_back(nanoseconds(at, end()));
    }
    std::nth_element(empty.begin(), empty.begin() + 500, empty.end());
    empty_interval_ = empty[500];
}

}  // namespace knurl::measure
