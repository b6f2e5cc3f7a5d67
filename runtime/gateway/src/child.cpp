#include "child.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace knurl::gateway {

Child::Child(const std::vector<std::string>& words) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
        throw std::runtime_error(words.front() + ": no pipe for its output: " + std::strerror(errno));
    out_ = shm::UniqueFd(ends[0]);
    const shm::UniqueFd theirs(ends[1]);
    ::fcntl(out_.get(), F_SETFL, O_NONBLOCK);

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, theirs.get(), 1);
    posix_spawn_file_actions_adddup2(&files, theirs.get(), 2);
    posix_spawnattr_t how;
    posix_spawnattr_init(&how);
    // The caller may block signals for a descriptor; a program that inherited that could not be interrupted.
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) sigaddset(&usual, signal);
    posix_spawnattr_setsigmask(&how, &none);
    posix_spawnattr_setsigdefault(&how, &usual);
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

    std::vector<std::string> copies = words;
    std::vector<char*> argv;
    for (std::string& word : copies) argv.push_back(word.data());
    argv.push_back(nullptr);
    const int error = ::posix_spawnp(&pid_, argv[0], &files, &how, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&how);
    if (error != 0) throw std::runtime_error(words.front() + " cannot be started: " + std::strerror(error));
}

Child::~Child() {
    if (look()) return;
    interrupt();
    for (int i = 0; i < 50 && !look(); ++i) ::poll(nullptr, 0, 20);
    if (code_) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
}

std::optional<int> Child::look() {
    if (code_) return code_;
    constexpr std::size_t most = std::size_t{256} * 1024;
    std::array<char, 4096> buffer{};
    ssize_t got = 0;
    while ((got = ::read(out_.get(), buffer.data(), buffer.size())) > 0)
        if (said_.size() < most) said_.append(buffer.data(), static_cast<std::size_t>(got));
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
    while ((got = ::read(out_.get(), buffer.data(), buffer.size())) > 0)
        if (said_.size() < most) said_.append(buffer.data(), static_cast<std::size_t>(got));
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return code_;
}

void Child::interrupt() noexcept {
    if (!code_) ::kill(pid_, SIGINT);
}

}  // namespace knurl::gateway
