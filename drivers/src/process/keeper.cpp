#include "process/keeper.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace knurl::drivers::process {

namespace {

namespace fs = std::filesystem;

std::string device_program() {
    if (const char* given = std::getenv("KNURL_DEVICE_PROGRAM"); given != nullptr && *given != '\0')
        return given;
    std::error_code none;
    const fs::path here = fs::read_symlink("/proc/self/exe", none).parent_path();
    // When installed all are in one folder; in a build tree each has its own.
    for (const fs::path& candidate :
         {here / "knurl-device", here.parent_path() / "knurl-device" / "knurl-device"})
        if (fs::is_regular_file(candidate, none)) return candidate.string();
    throw std::runtime_error("there is no knurl-device beside this program (" + here.string() +
                             "): it talks to the device; install the package knurl-server");
}

std::runtime_error system_error(const std::string& what) {
    return std::runtime_error("knurl-device: " + what + ": " + std::strerror(errno));
}

/// Above those that the child gets, so that none is overwritten before it is passed on.
int raised(int fd) {
    const int other = fd < 0 ? -1 : fcntl(fd, F_DUPFD_CLOEXEC, 10);
    if (fd >= 0) close(fd);
    return other;
}

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

std::string how(int status) {
    if (WIFSIGNALED(status)) return std::string("killed by signal ") + std::to_string(WTERMSIG(status));
    return "ended with code " + std::to_string(WEXITSTATUS(status));
}

std::string message_of(const std::array<char, 512>& from) {
    return {from.begin(), std::find(from.begin(), from.end(), '\0')};
}

}  // namespace

Keeper::Fd::~Fd() {
    reset();
}

void Keeper::Fd::reset(int other) noexcept {
    if (number >= 0) close(number);
    number = other;
}

Keeper::Keeper(Plan plan) : plan_(std::move(plan)), program_(device_program()) {
    mapping_.number = raised(memfd_create("knurl-device", MFD_CLOEXEC));
    if (mapping_.number < 0 || ftruncate(mapping_.number, sizeof(Shared)) != 0)
        throw system_error("no memory to share");
    servo_.number = raised(static_cast<int>(syscall(SYS_pidfd_open, getpid(), 0)));
    if (servo_.number < 0) throw system_error("pidfd_open");
    stop_.number = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (stop_.number < 0) throw system_error("eventfd");
    void* memory =
        mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, mapping_.number, 0);
    if (memory == MAP_FAILED) throw system_error("no memory to share");
    shared_ = new (memory) Shared;
    try {
        start(shared_->lane[0], 0);
        const std::string problem = wait_until_ready(shared_->lane[0]);
        if (!problem.empty()) throw std::runtime_error(plan_.scheme + ":" + plan_.what + ": " + problem);
        description_ = shared_->lane[0].description;
        session_.store(1, std::memory_order_release);
        sigset_t all, before;  // signals are the program's concern
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before);
        const int error = pthread_create(
            &thread_, nullptr,
            [](void* self) -> void* {
                static_cast<Keeper*>(self)->live();
                return nullptr;
            },
            this);
        pthread_sigmask(SIG_SETMASK, &before, nullptr);
        if (error != 0)
            throw std::runtime_error(std::string("knurl-device: no thread: ") + std::strerror(error));
    } catch (...) {
        end();
        munmap(shared_, sizeof(Shared));
        throw;
    }
    pthread_setname_np(thread_, "knurl-keeper");
}

Keeper::~Keeper() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t n = write(stop_.number, &one, sizeof one);
    pthread_join(thread_, nullptr);
    end();
    munmap(shared_, sizeof(Shared));
}

/// Starts a process with a lane to itself.
void Keeper::start(Lane& lane, unsigned number) {
    lane.~Lane();
    new (&lane) Lane;
    std::vector<std::string> words{program_,     plan_.scheme,
                                   "--lane",     std::to_string(number),
                                   "--priority", std::to_string(plan_.priority)};
    words.insert(words.end(), plan_.arguments.begin(), plan_.arguments.end());
    const std::string serial(description_.serial.data());  // after the first one: this very device
    if (!serial.empty()) words.insert(words.end(), {"--serial", serial});
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    SpawnSettings with;
    posix_spawn_file_actions_addopen(&with.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&with.actions, STDERR_FILENO,
                                     STDOUT_FILENO);  // a maker's library may print
    posix_spawn_file_actions_adddup2(&with.actions, mapping_.number, mapping_fd);
    posix_spawn_file_actions_adddup2(&with.actions, servo_.number, servo_fd);
    const sched_param none{};
    sigset_t unblocked;
    sigemptyset(&unblocked);
    posix_spawnattr_setschedparam(&with.attributes, &none);
    posix_spawnattr_setschedpolicy(&with.attributes, SCHED_OTHER);
    posix_spawnattr_setsigmask(&with.attributes, &unblocked);
    posix_spawnattr_setpgroup(&with.attributes, 0);  // ^C is the servo's: it says goodbye to the device
    posix_spawnattr_setflags(&with.attributes,
                             POSIX_SPAWN_SETSCHEDULER | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    pid_t pid = -1;
    const int error =
        posix_spawn(&pid, program_.c_str(), &with.actions, &with.attributes, argv.data(), environ);
    if (error != 0)
        throw std::runtime_error(program_ + " does not start: " + std::strerror(error) +
                                 "; it belongs to the package knurl-server");
    child_.reset(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
    pid_.store(pid, std::memory_order_relaxed);
    hung_ = false;
}

/// Empty: it is. Else why not; the process has ended then.
std::string Keeper::wait_until_ready(Lane& lane) {
    for (int waited = 0;; waited += 5) {
        const auto state = static_cast<LaneState>(lane.state.load(std::memory_order_acquire));
        if (state == LaneState::ready) return "";
        std::array<pollfd, 2> waits{pollfd{.fd = child_.number, .events = POLLIN, .revents = 0},
                                    pollfd{.fd = stop_.number, .events = POLLIN, .revents = 0}};
        poll(waits.data(), waits.size(), 5);
        const bool gone = waits[0].revents != 0;
        if (gone && static_cast<LaneState>(lane.state.load(std::memory_order_acquire)) == LaneState::ready)
            return "";
        if (gone) {
            const std::string end = ended(), said = message_of(lane.message);
            return said.empty()
                       ? "knurl-device was " + end + " while it opened the device; knurl-device --try " +
                             plan_.scheme + " shows where"
                       : said;
        }
        if (waits[1].revents != 0) return "stopped";
        if (waited < plan_.patience_ms) continue;
        kill(pid(), SIGKILL);
        ended();
        return "the maker's library has not opened the device within " +
               std::to_string(plan_.patience_ms / 1000) +
               " s; plug it out and in, and end other programs that use it";
    }
}

/// Waits for the process's end. How it ended.
std::string Keeper::ended() {
    int status = 0;
    pid_t waited = -1;
    do waited = waitpid(pid(), &status, 0);
    while (waited < 0 && errno == EINTR);
    child_.reset();
    pid_.store(-1, std::memory_order_relaxed);
    return waited < 0 ? "gone" : how(status);
}

/// True: the keeper is to stop.
bool Keeper::pause(int ms) noexcept {
    pollfd stop{.fd = stop_.number, .events = POLLIN, .revents = 0};
    return poll(&stop, 1, ms) > 0;
}

/// Zero, close, end; by force if it takes too long.
void Keeper::end() noexcept {
    if (pid() < 0) return;
    shared_->leave.store(1, std::memory_order_release);
    ring(*shared_);
    pollfd gone{.fd = child_.number, .events = POLLIN, .revents = 0};
    if (poll(&gone, 1, farewell_ms) <= 0) kill(pid(), SIGKILL);
    waitpid(pid(), nullptr, 0);
    child_.reset();
    pid_.store(-1, std::memory_order_relaxed);
}

void Keeper::live() noexcept {
    try {
        once();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurld: %s:%s is lost: %s\n", plan_.scheme.c_str(), plan_.what.c_str(),
                     error.what());
        session_.store((session() | 1U) + 1, std::memory_order_release);
    }
}

void Keeper::once() {
    Looks looks;
    for (;;) {
        std::array<pollfd, 2> waits{pollfd{.fd = child_.number, .events = POLLIN, .revents = 0},
                                    pollfd{.fd = stop_.number, .events = POLLIN, .revents = 0}};
        poll(waits.data(), waits.size(), look_ms);
        if (waits[1].revents != 0) return;
        if (waits[0].revents == 0) {
            look(looks);
            continue;
        }
        say_why_it_ended();
        if (!start_again(looks.pause_ms)) return;
        looks.still = looks.lives = 0;
    }
}

/// Only looks count: while the whole machine stands still, nobody looks.
void Keeper::look(Looks& looks) {
    const std::uint64_t beat = lane(session()).beat.load(std::memory_order_relaxed);
    looks.still = std::exchange(looks.beat, beat) == beat ? looks.still + 1 : 0;
    if (looks.still == 0 && session() % 2 == 1 && ++looks.lives > calm_looks) looks.pause_ms = 0;
    if (looks.still < plan_.hang_ms / look_ms || hung_) return;
    hung_ = true;
    session_.store(session() + 1, std::memory_order_release);
    kill(pid(), SIGKILL);  // its end comes when the kernel lets go of the call that hangs
}

void Keeper::say_why_it_ended() {
    std::string why = hung_ ? "a call of the maker's library did not return" : "";
    const std::string end = ended(), said = message_of(lane(session()).message);
    if (why.empty()) why = said.empty() ? "knurl-device was " + end : said;
    if (session() % 2 == 1) session_.store(session() + 1, std::memory_order_release);
    std::fprintf(stderr, "knurld: %s:%s: %s; it is looked for again\n", plan_.scheme.c_str(),
                 plan_.what.c_str(), why.c_str());
}

/// False: it is to stop.
bool Keeper::start_again(int& pause_ms) {
    for (;;) {
        if (pause(pause_ms)) return false;
        pause_ms = std::clamp(2 * pause_ms, first_pause_ms, longest_pause_ms);
        const std::uint64_t next = session() + 1;
        start(lane(next), static_cast<unsigned>((next / 2) % lanes));
        if (!wait_until_ready(lane(next)).empty()) continue;
        session_.store(next, std::memory_order_release);
        return true;
    }
}

}  // namespace knurl::drivers::process
