#include "child_process.hpp"

#include <csignal>
#include <string_view>

#include <fcntl.h>
#include <sched.h>
#include <spawn.h>
#include <unistd.h>

#include <knurl/shm/fd.hpp>

extern char** environ;

namespace knurl::servo {

namespace {

struct SpawnSettings {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    SpawnSettings() {
        posix_spawn_file_actions_init(&actions);
        posix_spawnattr_init(&attributes);
    }
    ~SpawnSettings() {
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
    }
    SpawnSettings(const SpawnSettings&) = delete;
    SpawnSettings& operator=(const SpawnSettings&) = delete;
};

}  // namespace

int start_child(const std::string& program, const std::vector<std::string>& arguments,
                const std::array<int, 2>& standard, int policy, pid_t& child) {
    std::vector<const char*> words{program.c_str()};
    for (const std::string& argument : arguments) words.push_back(argument.c_str());
    words.push_back(nullptr);
    SpawnSettings with;
    for (int i = 0; i < 2; ++i)
        if (standard[static_cast<std::size_t>(i)] >= 0)
            posix_spawn_file_actions_adddup2(&with.actions, standard[static_cast<std::size_t>(i)], i);
    // The broker runs in real time; its children must not.
    const sched_param none{};
    posix_spawnattr_setschedparam(&with.attributes, &none);
    posix_spawnattr_setschedpolicy(&with.attributes, policy);
    sigset_t unblocked;
    sigemptyset(&unblocked);
    posix_spawnattr_setsigmask(&with.attributes, &unblocked);
    posix_spawnattr_setflags(&with.attributes, POSIX_SPAWN_SETSCHEDULER | POSIX_SPAWN_SETSIGMASK);
    return ::posix_spawn(&child, program.c_str(), &with.actions, &with.attributes,
                         const_cast<char* const*>(words.data()), environ);
}

void leave_protection() noexcept {
    const shm::UniqueFd file(::open("/proc/self/oom_score_adj", O_RDWR | O_CLOEXEC));
    char sign = 0;
    if (!file || ::pread(file.get(), &sign, 1, 0) != 1 || sign != '-') return;
    constexpr std::string_view ordinary = "0";                                  // everybody may raise his own
    if (::pwrite(file.get(), ordinary.data(), ordinary.size(), 0) < 0) return;  // a wish, no more
}

}  // namespace knurl::servo
