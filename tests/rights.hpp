#pragma once
// What a machine may forbid a test. Found out by trying, not guessed from who runs it: root in a container
// may do less than anybody with a limit raised. A test that needs one of these begins with KNURL_NEEDS(...):
// where the right is missing it is skipped with one line that names the right and what gives it. scripts/test
// counts those lines.

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include <fcntl.h>
#include <grp.h>
#include <pthread.h>
#include <sched.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

namespace knurl::test {

/// Empty: the right is there. Else the line.
using Missing = std::string;

#define KNURL_NEEDS(right) \
    if (const knurl::test::Missing missing = (right); !missing.empty()) GTEST_SKIP() << missing

/// scripts/test counts by what stands before the first " (".
inline Missing missing(const std::string& right, const std::string& why, const std::string& what_gives_it) {
    return "missing right: " + right + " (" + why + "); " + what_gives_it;
}

namespace trying {

/// What `attempt` ends with in a child: 0, or the errno of what it was not allowed.
template <class Attempt>
int tried_in_child(Attempt attempt) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(attempt() ? 0 : errno & 0xff);
    int status = 0;
    if (child < 0 || ::waitpid(child, &status, 0) != child) return errno;
    return WIFEXITED(status) ? WEXITSTATUS(status) : EPERM;
}

inline Missing unless(int error, const char* right, const std::string& what_gives_it) {
    return error == 0 ? Missing{} : missing(right, std::strerror(error), what_gives_it);
}

}  // namespace trying

/// SCHED_FIFO at this priority, for a thread.
inline Missing missing_real_time(int priority) {
    int error = 0;
    std::thread([&] {
        const sched_param parameters{.sched_priority = priority};
        error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
    }).join();
    return trying::unless(error, "real-time priority",
                          "`ulimit -r " + std::to_string(priority) +
                              "` or CAP_SYS_NICE gives it, in a cgroup with real-time budget");
}

/// To start programs as somebody else, without any right.
inline Missing missing_other_user() {
    const int error = trying::tried_in_child(
        [] { return ::setgroups(0, nullptr) == 0 && ::setgid(65534) == 0 && ::setuid(65534) == 0; });
    return trying::unless(error, "to become another user",
                          "root has it, unless CAP_SETUID and CAP_SETGID were taken from it");
}

/// For who floods and who is flooded: on one processor the flood itself keeps all others from running.
inline Missing missing_second_processor() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (::sched_getaffinity(0, sizeof set, &set) != 0 || CPU_COUNT(&set) > 1) return {};
    return "no second processor (this process may use one only); a flood from the processor of the bridge "
           "proves nothing";
}

/// To run a program without a free descriptor.
inline Missing missing_programs_without_descriptors() {
#if defined(__SANITIZE_ADDRESS__)
    return "UBSan, which this build has, too (it opens a pipe to look at an object, and takes each for a "
           "wrong one where it gets none)";
#else
    return {};
#endif
}

/// A pseudo-terminal, for programs that look at theirs.
inline Missing missing_terminal() {
    const int controller = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    int error = controller < 0 ? errno : 0;
    if (controller >= 0) {
        char name[64] = {};
        int terminal = -1;
        if (::grantpt(controller) != 0 || ::unlockpt(controller) != 0 ||
            ::ptsname_r(controller, name, sizeof name) != 0 ||
            (terminal = ::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC)) < 0)
            error = errno;
        if (terminal >= 0) ::close(terminal);
        ::close(controller);
    }
    return trying::unless(error, "a pseudo-terminal",
                          "`mount -t devpts devpts /dev/pts` with /dev/ptmx gives it");
}

/// To follow a child instruction by instruction.
inline Missing missing_ptrace() {
    return trying::unless(
        trying::tried_in_child([] { return ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0; }), "ptrace",
        "a container that allows it (docker: --cap-add SYS_PTRACE) gives it");
}

}  // namespace knurl::test
