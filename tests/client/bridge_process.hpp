#pragma once
// A real knurl-bridge for the servo of KNURL_RUNTIME_DIR.

#include <csignal>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace client_test {

class BridgeProcess {
  public:
    /// `arguments` follow --listen, which takes any free port: the bridge's first line has it.
    explicit BridgeProcess(std::vector<std::string> arguments = {"--anyone"},
                           const std::string& listen = "127.0.0.1:0") {
        arguments.insert(arguments.begin(), {KNURL_BRIDGE, "--listen", listen});
        std::vector<char*> words;
        for (std::string& word : arguments) words.push_back(word.data());
        words.push_back(nullptr);
        int output[2];
        if (::pipe2(output, O_CLOEXEC) != 0) throw std::runtime_error("no pipe for the test");
        pid_ = ::fork();
        if (pid_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // no bridge outlives its test
            ::dup2(output[1], STDOUT_FILENO);
            ::dup2(output[1], STDERR_FILENO);
            ::execv(KNURL_BRIDGE, words.data());
            ::_exit(127);
        }
        ::close(output[1]);
        output_ = output[0];
        first_line_ = line();
        const std::size_t at = first_line_.find("knurl://");
        if (at != std::string::npos) address_ = first_line_.substr(at, first_line_.find(',') - at);
    }
    ~BridgeProcess() {
        ::kill(pid_, SIGKILL);
        ::kill(pid_, SIGCONT);
        if (!ended_) ::waitpid(pid_, nullptr, 0);
        ::close(output_);
    }
    BridgeProcess(const BridgeProcess&) = delete;
    BridgeProcess& operator=(const BridgeProcess&) = delete;

    pid_t pid() const { return pid_; }
    const std::string& first_line() const { return first_line_; }
    /// "knurl://127.0.0.1:40123"; empty: it does not listen.
    const std::string& address() const { return address_; }
    std::string host_and_port() const { return address_.substr(sizeof "knurl://" - 1); }
    std::uint16_t port() const {
        return static_cast<std::uint16_t>(std::stoi(address_.substr(address_.rfind(':') + 1)));
    }

    /// The next line of its output.
    std::string line() {
        std::string text;
        for (char c = 0; ::read(output_, &c, 1) == 1 && c != '\n';) text += c;
        return text;
    }
    /// Reads up to the next line with these words. Empty: it has ended without one.
    std::string line_with(const std::string& words) {
        for (;;) {
            std::string text = line();
            if (text.empty() || text.find(words) != std::string::npos) return text;
        }
    }
    /// There is unread output.
    bool has_line() const {
        pollfd one{.fd = output_, .events = POLLIN, .revents = 0};
        return ::poll(&one, 1, 0) == 1;
    }
    /// Its exit status; waits for its end.
    int status() {
        int status = 0;
        ::waitpid(pid_, &status, 0);
        ended_ = true;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    void stop() {
        ::kill(pid_, SIGSTOP);
        ::waitpid(pid_, nullptr, WUNTRACED);
    }
    void go_on() { ::kill(pid_, SIGCONT); }

  private:
    pid_t pid_ = -1;
    int output_ = -1;
    bool ended_ = false;
    std::string first_line_, address_;
};

}  // namespace client_test
