// knurl web: knurl-web beside a running servo, or beside a simulated one of its own.

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/commandline/program.hpp>
#include <knurl/measure/private_servo.hpp>
#include <knurl/shm/fd.hpp>

#include "verbs.hpp"

namespace knurl::cli {

namespace {

namespace fs = std::filesystem;

/// A program whose standard output is read here. Ends with this object, or with this process.
class Child {
  public:
    explicit Child(std::vector<std::string> words, bool read_output) {
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        std::array<int, 2> ends{-1, -1};
        if (read_output && ::pipe2(ends.data(), O_CLOEXEC) != 0)
            throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
        output_ = shm::UniqueFd(ends[0]);
        const shm::UniqueFd theirs(ends[1]);
        const pid_t parent = ::getpid();
        // Until the other program runs, a signal would meet this program's handlers in the child, and be lost.
        sigset_t all, before;
        ::sigfillset(&all);
        ::pthread_sigmask(SIG_BLOCK, &all, &before);
        pid_ = ::fork();
        if (pid_ == 0) {
            for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
            std::signal(SIGPIPE, SIG_DFL);
        }
        ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
        if (pid_ < 0) throw std::runtime_error(std::string("cannot fork: ") + std::strerror(errno));
        if (pid_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGTERM);
            if (::getppid() != parent) ::_exit(1);
            ::setpgid(0, 0);  // Ctrl-C reaches only this program, which ends both in their order
            if (read_output) ::dup2(theirs.get(), 1);
            ::execvp(argv[0], argv.data());
            ::dprintf(2, "%s: cannot be started: %s\n", argv[0], std::strerror(errno));
            ::_exit(127);
        }
    }
    ~Child() {
        if (pid_ <= 0) return;
        ::kill(pid_, SIGTERM);
        constexpr int patience_ms = 5000;
        for (int waited_ms = 0; waited_ms < patience_ms; waited_ms += 10) {
            if (ended()) return;
            ::usleep(10'000);
        }
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    int output() const { return output_.get(); }
    /// Its exit code, when it has ended.
    std::optional<int> ended() {
        int status = 0;
        if (pid_ <= 0 || ::waitpid(pid_, &status, WNOHANG) != pid_) return {};
        pid_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : commandline::could_not;
    }

  private:
    pid_t pid_ = -1;
    shm::UniqueFd output_;
};

struct WebWish {
    std::string servo = "default", device = "right=sim:premium15", listen;
    std::vector<std::string> more;
    bool browser = false;
};

/// A browser that cannot be started is no reason to stop: the address is on the terminal.
void open_browser(const std::string& address) {
    const pid_t pid = ::fork();
    if (pid != 0) {
        if (pid > 0) ::waitpid(pid, nullptr, 0);
        return;
    }
    if (::fork() != 0) ::_exit(0);  // its own life: a browser outlives this program
    ::setsid();
    const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int fd : {0, 1, 2}) ::dup2(nowhere, fd);
    ::execlp("xdg-open", "xdg-open", address.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
}

/// Prints what knurl-web says, line by line, and opens the first address that has a token.
class Lines {
  public:
    explicit Lines(bool browser) : opened_(!browser) {}
    void take(std::string_view bytes) {
        for (const char c : bytes) {
            line_ += c;
            if (c == '\n') give();
        }
    }

  private:
    void give() {
        commandline::print(line_);
        commandline::flush_output();
        const std::size_t begin = line_.find("http://");
        if (!opened_ && begin != std::string::npos && line_.find("?token=") != std::string::npos) {
            open_browser(line_.substr(begin, line_.find_first_of(" \n", begin) - begin));
            opened_ = true;
        }
        line_.clear();
    }
    std::string line_;
    bool opened_;
};

/// A pipe through which the page pulls the hand of a simulated device (its option live=).
class HandFifo {
  public:
    HandFifo() {
        std::string pattern = (fs::temp_directory_path() / "knurl-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr)
            throw std::runtime_error(pattern + ": cannot be made: " + std::strerror(errno));
        folder_ = pattern;
        if (::mkfifo(path().c_str(), 0600) != 0)
            throw std::runtime_error(path() + ": cannot be made: " + std::strerror(errno));
    }
    ~HandFifo() {
        std::error_code none;
        fs::remove_all(folder_, none);
    }
    HandFifo(const HandFifo&) = delete;
    HandFifo& operator=(const HandFifo&) = delete;

    std::string path() const { return folder_ / "hand"; }

  private:
    fs::path folder_;
};

/// A simulated device whose hand nobody moves is given a pipe.
bool has_free_hand(const std::string& device) {
    const std::size_t name = device.find('=');
    const std::size_t colon = device.find(':');
    const std::size_t begin = name < colon ? name + 1 : 0;
    return device.compare(begin, 4, "sim:") == 0 && device.find("live=") == std::string::npos;
}

/// A servo of that name, or at that path, is there.
bool runs(const protocol::ServoAddress& servo, bool path) {
    const std::vector<std::string> running = protocol::running_servos();
    return fs::exists(servo.socket) &&
           (path || std::find(running.begin(), running.end(), servo.name) != running.end());
}

int web(const WebWish& wish) {
    const protocol::ServoAddress said = servo_said(wish.servo);
    commandline::stop_on_signals();
    std::optional<HandFifo> hand;
    std::optional<measure::PrivateServo> own;
    std::vector<std::string> words{commandline::program_beside("knurl-web"), "--servo", wish.servo};
    if (!runs(said, wish.servo.find('/') != std::string::npos)) {
        std::string device = wish.device;
        if (has_free_hand(device)) device += ",live=" + hand.emplace().path();
        own.emplace(std::vector<std::string>{"--device", device});
        words.back() = own->address();
        commandline::print("knurl web: no servo '" + said.name + "' runs: this one is simulated (" +
                           wish.device + ")\n");
    }
    if (!wish.listen.empty()) words.insert(words.end(), {"--listen", wish.listen});
    words.insert(words.end(), wish.more.begin(), wish.more.end());
    commandline::flush_output();

    Child server(words, true);
    Lines lines(wish.browser);
    pollfd from{.fd = server.output(), .events = POLLIN, .revents = 0};
    while (!commandline::stop) {
        if (own) own->require_running();
        constexpr int look_ms = 200;  // whether one of them has ended, or Ctrl-C came
        if (::poll(&from, 1, look_ms) > 0) {
            std::array<char, 4096> bytes;
            const ssize_t got = ::read(server.output(), bytes.data(), bytes.size());
            if (got > 0) lines.take({bytes.data(), static_cast<std::size_t>(got)});
            if (got == 0) from.fd = -1;
        }
        if (const auto code = server.ended()) return *code == 0 ? commandline::could_not : *code;
    }
    return 0;
}

}  // namespace

void add_web(commandline::Command& program) {
    auto wish = std::make_shared<WebWish>();
    auto& verb = program.verb("web",
                              "Shows a servo in a browser (knurl-web); without a servo it starts a simulated "
                              "one. Ctrl-C ends both");
    verb.option("--servo", wish->servo, "The servo's name").shows_default();
    verb.option("--device", wish->device, "Of the simulated servo")
        .type_name("[NAME=]ADDRESS")
        .shows_default();
    verb.option("--listen", wish->listen, "Where the page is: knurl-web's --listen").type_name("HOST:PORT");
    verb.flag("--browser", wish->browser, "Opens the page with xdg-open");
    verb.option("--web-option", wish->more, "Another option of knurl-web: --web-option=--open")
        .type_name("OPTION");
    verb.footer("More options, for a servo that runs: knurl-web --help");
    verb.action([wish] { return web(*wish); });
}

}  // namespace knurl::cli
