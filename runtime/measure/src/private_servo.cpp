#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/commandline/program.hpp>
#include <knurl/measure/private_servo.hpp>

namespace knurl::measure {

namespace {

namespace fs = std::filesystem;

std::string fresh_directory() {
    std::string pattern = (fs::temp_directory_path() / "knurl-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
        throw std::runtime_error(pattern + ": cannot be made: " + std::strerror(errno));
    }
    return pattern;
}

}  // namespace

PrivateServo::PrivateServo(const std::vector<std::string>& arguments)
    : directory_(fresh_directory()), address_("knurl:private") {
    ::setenv("KNURL_RUNTIME_DIR", directory_.c_str(), 1);
    ::setenv("KNURL_STATE_DIR", directory_.c_str(), 1);

    // All allocations precede the fork.
    std::vector<std::string> words{commandline::program_beside("knurld"), "--name", "private"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string log = directory_ + "/said";
    const pid_t parent = ::getpid();

    pid_ = ::fork();
    if (pid_ < 0) throw std::runtime_error(std::string("cannot fork: ") + std::strerror(errno));
    if (pid_ == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (::getppid() != parent) ::_exit(1);
        ::setpgid(0, 0);  // Ctrl-C must reach only the measuring program, which ends the servo when it is
                          // done
        const int file = ::open(log.c_str(), O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC, 0600);
        ::dup2(file, 1);
        ::dup2(file, 2);
        ::execvp(argv[0], argv.data());
        ::dprintf(2, "%s: cannot be started: %s\n", argv[0], std::strerror(errno));
        ::_exit(127);
    }
}

PrivateServo::~PrivateServo() {
    if (pid_ > 0) {
        ::kill(pid_, SIGTERM);
        constexpr int patience_ms = 5000;  // it ramps down its device first
        int waited_ms = 0;
        while (::waitpid(pid_, nullptr, WNOHANG) == 0 && waited_ms < patience_ms) {
            ::usleep(10'000);
            waited_ms += 10;
        }
        if (waited_ms >= patience_ms) {
            ::kill(pid_, SIGKILL);
            ::waitpid(pid_, nullptr, 0);
        }
    }
    std::error_code ignored;
    fs::remove_all(directory_, ignored);
}

std::string PrivateServo::said() const {
    std::ifstream file(directory_ + "/said");
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

void PrivateServo::require_running() {
    int status = 0;
    if (pid_ > 0 && ::waitpid(pid_, &status, WNOHANG) == pid_) {
        pid_ = -1;
        throw std::runtime_error("the servo started for this measurement ended: " + said());
    }
}

}  // namespace knurl::measure
