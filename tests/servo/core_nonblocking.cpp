// Servo::step makes no allocation, lock, page fault or system call (a puppet device makes none of its own,
// and the clock is read in user space). Three traps, each over a run with every event: claims come and go,
// groups of commands, good and bad batches, silence, a stall, a fault, an unplugged device, and a recording
// and a watcher for most of the time.
//
// This program replaces malloc and the mutexes, so it stands alone. A sanitizer replaces them too: then only
// the run itself remains.

#include <cerrno>
#include <csignal>
#include <cstring>

#include <dlfcn.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/reps/all.hpp>
#include <knurl/servo/input_log.hpp>
#include <knurl/servo/scene_log.hpp>
#include <knurl/shm/counters.hpp>

#include "../rights.hpp"
#include "core_support.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define KNURL_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define KNURL_SANITIZED 1
#endif
#endif
#ifndef KNURL_SANITIZED
#define KNURL_SANITIZED 0
#endif

namespace {

thread_local bool inside_step = false;
thread_local unsigned long allocations = 0, locks = 0;

}  // namespace

#if !KNURL_SANITIZED

extern "C" {
// glibc's own functions, under the names that are replaced here.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

static void count_allocation() {
    allocations += inside_step;
}

void* malloc(std::size_t n) {
    count_allocation();
    return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
    count_allocation();
    return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) {
    count_allocation();
    return __libc_realloc(p, n);
}
void* memalign(std::size_t alignment, std::size_t n) {
    count_allocation();
    return __libc_memalign(alignment, n);
}
void* aligned_alloc(std::size_t alignment, std::size_t n) {
    return memalign(alignment, n);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t n) {
    *out = memalign(alignment, n);
    return *out == nullptr ? ENOMEM : 0;
}
void free(void* p) {
    count_allocation();
    __libc_free(p);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
    static const auto next =
        reinterpret_cast<int (*)(pthread_mutex_t*)>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
    locks += inside_step;
    return next(mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
    static const auto next =
        reinterpret_cast<int (*)(pthread_rwlock_t*)>(dlsym(RTLD_NEXT, "pthread_rwlock_rdlock"));
    locks += inside_step;
    return next(lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
    static const auto next =
        reinterpret_cast<int (*)(pthread_rwlock_t*)>(dlsym(RTLD_NEXT, "pthread_rwlock_wrlock"));
    locks += inside_step;
    return next(lock);
}
}

#endif

namespace knurl::servo {
namespace {

using namespace testing;
using protocol::Count;

/// A client's end without calls of any kind: its messages are structs on the stack.
struct RawClient {
    ClaimTerms terms;
    protocol::ClaimLayout layout;
    OfflineMemory memory;
    Claim claim;
    shm::SpscProducer commands;
    shm::TripleWriter batches;
    shm::SpscConsumer replies;
    shm::SentCount sent;
    std::uint64_t issued = 0, sequence = 0, version = 0;

    explicit RawClient(const Limits& limits)
        : terms(with(limits)),
          layout(protocol::claim_layout(terms.capacity)),
          memory(layout.total),
          claim(terms, memory.data(), nullptr),
          commands(memory.data() + layout.commands, layout.command_cells),
          batches(memory.data() + layout.batches, layout.batch_slot_bytes),
          replies(memory.data() + layout.replies, protocol::reply_cells),
          sent(reinterpret_cast<shm::WaiterFlag*>(memory.data() + layout.waiter)) {}
    static ClaimTerms with(const Limits& limits) {
        ClaimTerms t;
        t.limits = limits;
        return t;
    }

    template <class Body, class Params>
    void command(protocol::CommandType type, const Body& body, const Params& params, std::size_t param_bytes,
                 std::size_t body_bytes, bool more = false) {
        alignas(8) std::byte cells[16 * shm::cell_bytes] = {};
        const std::size_t bytes = sizeof(protocol::CommandHeader) + body_bytes + param_bytes;
        const protocol::CommandHeader header{
            .cells = static_cast<std::uint32_t>((bytes + shm::cell_bytes - 1) / shm::cell_bytes),
            .type = type,
            .number = ++issued,
            .flags = more ? protocol::command_flags::more : 0u,
            .bytes = static_cast<std::uint32_t>(param_bytes)};
        std::memcpy(cells, &header, sizeof header);
        std::memcpy(cells + sizeof header, &body, body_bytes);
        std::memcpy(cells + sizeof header + body_bytes, &params, param_bytes);
        commands.try_push(cells, header.cells);
        sent.add();
        while (replies.available() > 0) replies.pop(replies.available());
    }
    template <class R>
    void add(RepresentationId id, const R& params) {
        const protocol::AddBody body{.id = id, .kind = kind_of<R>, .reserved = 0, .options = {}};
        command(protocol::CommandType::add, body, params, sizeof params, sizeof body);
    }
    void remove(RepresentationId id) {
        const protocol::RemoveBody body{id};
        command(protocol::CommandType::remove, body, body, 0, sizeof body);
    }
    void state(protocol::CommandType type) { command(type, 0, 0, 0, 0); }
    template <class R>
    void commit(RepresentationId id, const R& params) {
        struct {
            protocol::BatchHeader header;
            protocol::EntryHeader entry;
            R params;
        } batch{{.sequence = ++sequence,
                 .commands_before = issued,
                 .entries = 1,
                 .bytes = sizeof(protocol::EntryHeader) + sizeof(R)},
                {.id = id, .kind = kind_of<R>, .bytes = sizeof(R), .version = ++version},
                params};
        batches.publish(&batch, sizeof batch, issued);
        sent.add();
    }
};

/// The run with every event. `around` gets each call of step.
struct Everything {
    static constexpr int cycles = 12'000;
    PuppetDevice device{6};
    MonotonicClock clock;
    OfflineMemory segment{protocol::device_layout().total}, input_log_memory{input_log_bytes};
    InputLog input_log{input_log_memory.data(), {}};
    OfflineMemory scene_log_memory{scene_log_bytes};
    RecordLog scene_log{scene_log_memory.data(), scene_log_slots};
    Servo servo{device, clock, segment.data(), live_options()};
    RawClient first{limits_for(device.link(), 1000, {})};
    RawClient second{limits_for(device.link(), 1000, {})};
    Nanoseconds now = 0;
    std::uint32_t generation = 1;
    std::uint64_t times_active = 0, times_in_fault = 0;

    Everything() { servo.adopt(&first.claim); }

    template <class Around>
    void cycle(int i, Around around) {
        device.tip = 0.01 * Eigen::Vector3d(std::sin(i * 0.003), std::cos(i * 0.002), std::sin(i * 0.01));
        now += i == 7000 ? 30'000'000 : 1'000'000;  // a stall
        if (i == 5) first.add(RepresentationId{0, 1}, Plane{.stiffness = 500, .damping = 1});
        if (i == 6) first.add(RepresentationId{1, 1}, Spring{.attach = {0.01, 0, 0}, .stiffness = 20});
        if (i % 2000 == 10) {
            first.state(protocol::CommandType::reset_fault);
            first.state(protocol::CommandType::arm);
        }
        const bool silent = i > 4000 && i < 5000;
        if (i % 20 == 0 && !silent)
            first.commit(RepresentationId{0, 1}, Plane{.normal = {0.1 * std::sin(i), 0, 1},
                                                       .offset = 1e-3 * std::cos(i),
                                                       .stiffness = 500,
                                                       .damping = 1});
        if (i % 333 == 0) first.commit(RepresentationId{0, 1}, Plane{.stiffness = -1});  // refused
        if (i % 50 == 25) {
            first.add(RepresentationId{2, generation}, ConstantForce{.force = {0.3, 0, 0}});
        } else if (i % 50 == 45) {
            first.remove(RepresentationId{2, generation++});
        }
        if (i == 1) servo.record(&input_log);
        if (i == 11'500) servo.record(nullptr);
        if (i % 4000 == 2) servo.show_scenes(&scene_log);
        if (i % 4000 == 3500) servo.show_scenes(nullptr);
        if (i % 3000 == 1000) servo.adopt(&second.claim);
        if (i % 3000 == 1010) second.state(protocol::CommandType::arm);
        if (i % 3000 == 1500) servo.drop(&second.claim);
        if (i == 8500) device.status = drivers::ReadStatus::unplugged;
        if (i == 8600) device.status = drivers::ReadStatus::ok;
        if (i == 9000) device.tip.x() = std::nan("");
        device.mechanism_.broken = i == 9500;
        if (i == 11'000) servo.clock_jumped();

        around([this] { servo.step(now, now); });
        servo.released();
        times_active += servo.last().state == DeviceState::active;
        times_in_fault += servo.last().state == DeviceState::fault;
    }
    template <class Around>
    void run(int from, int to, Around around) {
        for (int i = from; i < to; ++i) cycle(i, around);
    }
    void expect_it_all_happened() {
        const shm::CountersReader counters(segment.data() + protocol::device_layout().counters,
                                           protocol::count_names);
        const auto count = [&](Count which) { return counters.read(static_cast<std::size_t>(which)); };
        EXPECT_GT(times_active, 3000u);
        EXPECT_GT(times_in_fault, 100u);
        EXPECT_GT(count(Count::batches_taken), 400u);
        EXPECT_GT(count(Count::batches_refused), 10u);
        EXPECT_GT(count(Count::commands_done), 300u);
        EXPECT_EQ(count(Count::stalls), 1u);
        EXPECT_GE(count(Count::bad_samples), 1u);
        EXPECT_GE(count(Count::kinematics_failures), 1u);
        EXPECT_GT(InputLog::written(input_log_memory.data()), 12'000u);
        EXPECT_GT(RecordLog::written(scene_log_memory.data(), scene_log_slots), 1000u);
    }
};

constexpr auto plainly = [](auto step) { step(); };

TEST(Nonblocking, TheRunItselfMakesEverythingHappen) {
    Everything all;
    all.run(0, Everything::cycles, plainly);
    all.expect_it_all_happened();
}

TEST(Nonblocking, TheTrapsCatch) {
    if (KNURL_SANITIZED) GTEST_SKIP() << "the sanitizer has replaced malloc";
    allocations = locks = 0;
    pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    inside_step = true;
    // Through a volatile pointer, since the compiler may remove an unused allocation.
    std::vector<int>* volatile kept = new std::vector<int>(100);
    delete kept;
    pthread_mutex_lock(&mutex);
    inside_step = false;
    pthread_mutex_unlock(&mutex);
    EXPECT_EQ(allocations, 4u) << "two allocated, two freed";
    EXPECT_EQ(locks, 1u);
}

TEST(Nonblocking, NothingIsAllocatedFreedOrLocked) {
    if (KNURL_SANITIZED) GTEST_SKIP() << "the sanitizer has replaced malloc";
    Everything all;
    allocations = locks = 0;
    all.run(0, Everything::cycles, [](auto step) {
        inside_step = true;
        step();
        inside_step = false;
    });
    EXPECT_EQ(allocations, 0u);
    EXPECT_EQ(locks, 0u);
    all.expect_it_all_happened();
}

TEST(Nonblocking, NoPageIsFaultedIn) {
    if (KNURL_SANITIZED) GTEST_SKIP() << "the sanitizer's shadow memory is paged in as it is used";
    // All memory is there after construction; a hundred cycles touch code and stack. Three attempts: the
    // kernel may take or move a page at any time, but not in each of three runs.
    long faults = 0;
    for (int attempt = 0; attempt < 3; ++attempt) {
        Everything all;
        all.run(0, Everything::cycles, plainly);  // code pages of every path
        Everything again;
        again.run(0, 100, plainly);
        const auto count = [] {
            rusage usage{};
            getrusage(RUSAGE_THREAD, &usage);
            return usage.ru_minflt + usage.ru_majflt;
        };
        faults = 0;
        again.run(100, Everything::cycles, [&](auto step) {
            const long before = count();
            step();
            faults += count() - before;
        });
        if (faults == 0) break;
    }
    EXPECT_EQ(faults, 0);
}

/// From here on this thread may only end the process. (Without the time stamp counter, reading the clock
/// falls back to a system call, which is allowed.)
void allow_no_system_call() {
    const sock_filter filter[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 2, 0),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clock_gettime, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const sock_fprog program{.len = static_cast<unsigned short>(std::size(filter)),
                             .filter = const_cast<sock_filter*>(filter)};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
        _exit(77);
}

/// How a child ended that runs `work` under the trap: 0, a signal's number + 128, or 77 without seccomp.
template <class Work>
int trapped(Work work) {
    const pid_t child = fork();
    if (child == 0) {
        Everything all;
        allow_no_system_call();
        work(all);
        _exit(all.times_active > 3000 ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

TEST(Nonblocking, NoSystemCallIsMade) {
    if (KNURL_SANITIZED) GTEST_SKIP() << "the sanitizer makes system calls of its own";
    const int end = trapped([](Everything& all) { all.run(0, Everything::cycles, plainly); });
    if (end == 77)
        GTEST_SKIP() << knurl::test::missing("a seccomp filter", "refused",
                                             "a kernel with CONFIG_SECCOMP_FILTER gives it to anybody");
    EXPECT_EQ(end, 0) << "128 + SIGSYS (" << 128 + SIGSYS << "): the cycle made a system call";
    EXPECT_EQ(trapped([](Everything&) { getppid(); }), 128 + SIGSYS) << "the trap itself";
}

}  // namespace
}  // namespace knurl::servo
