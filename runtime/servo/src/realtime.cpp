#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <knurl/servo/realtime.hpp>

#include "rights.hpp"

namespace knurl::servo {

namespace {

void note_priority(Shortfalls& missing, int priority, const char* who, int error) {
    missing.ordinary.push_back(fmt::format("{} {}", who, priority));
    missing.priority_error = error;
    missing.highest_priority = std::max(missing.highest_priority, priority);
}

#if !defined(__has_feature)  // GCC 12 defines macros instead
#define __has_feature(name) 0
#endif
#if defined(__SANITIZE_THREAD__) || __has_feature(thread_sanitizer)
constexpr bool thread_sanitized = true;
#else
constexpr bool thread_sanitized = false;
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = thread_sanitized;
#endif

// ThreadSanitizer's own locks spin on sched_yield, which under SCHED_FIFO does not yield to lower priorities.
// A servo thread would spin for ever on a lock held by a slower thread on its CPU. So that build runs without
// priorities.
constexpr int allowed_priority(int priority) {
    return thread_sanitized ? 0 : priority;
}

// Stack frames with sanitizers are several times larger.
constexpr std::size_t stack_scale = sanitized ? 8 : 1;

void* run_body(void* body) {
    (*static_cast<std::function<void()>*>(body))();
    return nullptr;
}

/// Owns a pthread_attr_t.
struct Attributes {
    Attributes() {
        if (pthread_attr_init(&value) != 0) throw std::runtime_error("knurld: cannot make thread attributes");
    }
    ~Attributes() { pthread_attr_destroy(&value); }
    Attributes(const Attributes&) = delete;
    Attributes& operator=(const Attributes&) = delete;
    pthread_attr_t value;
};

}  // namespace

std::string why_no_priority(int priority) {
    return Rights().why_no_priority(priority);
}

std::vector<std::string> Shortfalls::report() const {
    std::vector<std::string> all = lines;
    if (!ordinary.empty()) {
        all.push_back(fmt::format("no real-time priority ({}) for {}: {}", std::strerror(priority_error),
                                  fmt::join(ordinary, ", "), why_no_priority(highest_priority)));
    }
    return all;
}

void tame_malloc() noexcept {
    // With all memory locked each arena would be resident, and so would memory that freed claims leave
    // behind. One arena, with large blocks (claims' tables) from mmap, returns memory to the system when a
    // client leaves.
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_THRESHOLD, 64 * 1024);
    mallopt(M_TRIM_THRESHOLD, 64 * 1024);
    mallopt(M_TOP_PAD, 64 * 1024);
}

void lock_memory(Shortfalls& missing) {
    // With a finite limit MCL_FUTURE makes later allocations fail, so only existing memory is locked.
    rlimit limit{};
    getrlimit(RLIMIT_MEMLOCK, &limit);
    const bool unlimited = limit.rlim_cur == RLIM_INFINITY || Rights().capable(Rights::ipc_lock);
    if (unlimited && mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return;
    const int error = unlimited ? errno : ENOMEM;
    const bool some = mlockall(MCL_CURRENT) == 0;
    missing.lines.push_back(
        fmt::format("memory is {} locked ({}; the limit is {} KiB): page faults will cost cycles; run: {}",
                    some ? "only partly" : "not", std::strerror(error), limit.rlim_cur / 1024,
                    Rights().memory_command()));
}

void become_real_time(int priority, const char* who, Shortfalls& missing) {
    priority = allowed_priority(priority);
    if (priority == 0) return;
    sched_param parameters{};
    parameters.sched_priority = priority;
    const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
    if (error != 0) note_priority(missing, priority, who, error);
}

std::vector<int> allowed_cpus() {
    cpu_set_t set;
    CPU_ZERO(&set);
    std::vector<int> cpus;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return {0};
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
        if (CPU_ISSET(cpu, &set)) cpus.push_back(cpu);
    }
    return cpus;
}

void keep_off_cpu(int cpu) noexcept {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) != 0) return;
    CPU_CLR(cpu, &set);
    if (CPU_COUNT(&set) > 0) sched_setaffinity(0, sizeof set, &set);
}

shm::UniqueFd hold_idle_polling(Shortfalls& missing) {
    constexpr const char* path = "/dev/cpu_dma_latency";
    shm::UniqueFd fd(open(path, O_WRONLY | O_CLOEXEC));
    const std::int32_t no_latency = 0;  // us
    if (fd && write(fd.get(), &no_latency, sizeof no_latency) == sizeof no_latency) return fd;
    const int error = errno;
    missing.lines.push_back(
        fmt::format("idle = \"poll\" is not in force: {}: {}; {}", path, std::strerror(error),
                    error == ENOENT ? fmt::format("in a container; run: docker run --device {} ...", path)
                                    : fmt::format("run: sudo setfacl -m u:{}:rw {}", geteuid(), path)));
    return {};
}

Thread::Thread(const ThreadOptions& options, std::function<void()> body, Shortfalls& missing)
    : body_(std::make_unique<std::function<void()>>(std::move(body))) {
    Attributes attributes;
    pthread_attr_setstacksize(&attributes.value, stack_scale * options.stack_bytes);
    if (options.cpu >= 0) {
        cpu_set_t set;
        CPU_ZERO(&set);
        CPU_SET(static_cast<std::size_t>(options.cpu), &set);
        pthread_attr_setaffinity_np(&attributes.value, sizeof set, &set);
    }
    // Set explicitly, since the creating thread may run in real time itself.
    pthread_attr_setinheritsched(&attributes.value, PTHREAD_EXPLICIT_SCHED);
    const auto create = [&](int policy, int priority) {
        sched_param parameters{};
        parameters.sched_priority = priority;
        pthread_attr_setschedpolicy(&attributes.value, policy);
        pthread_attr_setschedparam(&attributes.value, &parameters);
        return pthread_create(&thread_, &attributes.value, run_body, body_.get());
    };
    int error = EPERM;
    if (const int priority = allowed_priority(options.priority); priority > 0) {
        error = create(SCHED_FIFO, priority);
        if (error == EPERM) note_priority(missing, priority, options.name, error);
    }
    if (error == EPERM) error = create(SCHED_OTHER, 0);
    if (error != 0) {
        throw std::runtime_error(fmt::format("cannot start the {} thread on CPU {}: {}", options.name,
                                             options.cpu, std::strerror(error)));
    }
    running_ = true;
    pthread_setname_np(thread_, options.name);
}

void Thread::join() noexcept {
    if (running_) pthread_join(thread_, nullptr);
    running_ = false;
}

WakeLateness measure_wake_lateness(int priority, int cpu, int samples) {
    std::vector<Nanoseconds> late(static_cast<std::size_t>(samples));
    Shortfalls unused;
    Thread(
        {.name = "knurl-lateness", .priority = priority, .cpu = cpu, .stack_bytes = small_stack_bytes},
        [&late] {
            MonotonicClock clock;
            Nanoseconds deadline = clock.now();
            for (Nanoseconds& sample : late) {
                deadline += 1'000'000;
                const timespec until{.tv_sec = deadline / 1'000'000'000, .tv_nsec = deadline % 1'000'000'000};
                clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
                sample = clock.now() - deadline;
            }
        },
        unused)
        .join();
    std::sort(late.begin(), late.end());
    return {.samples = samples, .p50 = late[late.size() / 2], .max = late.back()};
}

}  // namespace knurl::servo
