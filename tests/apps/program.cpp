#include "program.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace knurl::test {

namespace fs = std::filesystem;

Home::Home() {
    ::setenv("KNURL_RUNTIME_DIR", path("").c_str(), 1);
    ::setenv("KNURL_STATE_DIR", path("").c_str(), 1);
}

std::string text_of_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

int number_before(const std::string& text, const std::string& what) {
    const std::size_t end = text.find(what);
    if (end == std::string::npos) return -1;
    std::size_t begin = end;
    while (begin > 0 && std::isdigit(static_cast<unsigned char>(text[begin - 1])) != 0) --begin;
    return std::atoi(text.c_str() + begin);
}

namespace {

/// A child with these descriptors as its streams; it does not outlive the test.
pid_t start(const std::vector<std::string>& words, int out, int err) {
    std::vector<char*> argv;
    for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::dup2(out, STDOUT_FILENO);
        ::dup2(err, STDERR_FILENO);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    return child;
}

int wait_for(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

shm::UniqueFd new_file(const std::string& path) {
    return shm::UniqueFd(::open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600));
}

}  // namespace

Outcome run(const std::vector<std::string>& words) {
    const Folder folder;
    const std::string out = folder.path("out"), err = folder.path("err");
    const int code = wait_for(start(words, new_file(out).get(), new_file(err).get()));
    return {.code = code, .out = text_of_file(out), .err = text_of_file(err)};
}

Background::Background(const std::vector<std::string>& words) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe for the test");
    output_ = shm::UniqueFd(ends[0]);
    const shm::UniqueFd its_end(ends[1]);
    pid_ = start(words, its_end.get(), its_end.get());
}

bool Background::read_some(int timeout_ms) {
    pollfd one{.fd = output_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&one, 1, timeout_ms) != 1) return false;
    char text[4096];
    const ssize_t n = ::read(output_.get(), text, sizeof text);
    if (n <= 0) return false;
    said_.append(text, static_cast<std::size_t>(n));
    return true;
}

bool Background::says(const std::string& text) {
    constexpr int patience_ms = static_cast<int>(std::chrono::milliseconds(patience).count());
    while (said_.find(text) == std::string::npos)
        if (!read_some(patience_ms)) return false;
    return true;
}

int Background::end(int signal) {
    if (pid_ <= 0) return -1;
    ::kill(pid_, signal);
    const int code = wait_for(pid_);
    pid_ = -1;
    while (read_some(0)) {
    }
    return code;
}

OnTerminal::OnTerminal(const std::vector<std::string>& words, unsigned short columns, unsigned short rows) {
    winsize size{.ws_row = rows, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    std::vector<char*> argv;
    for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    int terminal = -1;
    pid_ = ::forkpty(&terminal, nullptr, nullptr, &size);
    if (pid_ == 0) {
        ::setenv("TERM", "xterm", 1);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    terminal_ = shm::UniqueFd(terminal);
}

OnTerminal::~OnTerminal() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    wait_for(pid_);
}

void OnTerminal::type(char key) {
    ASSERT_EQ(::write(terminal_.get(), &key, 1), 1);
}

bool OnTerminal::shows(const std::string& text) {
    return shows_one_of({text});
}

bool OnTerminal::shows_one_of(const std::vector<std::string>& texts) {
    while (std::none_of(texts.begin(), texts.end(),
                        [&](const std::string& text) { return shown.find(text) != std::string::npos; }))
        if (!read()) return false;
    return true;
}

int OnTerminal::end() {
    while (read()) {
    }
    const int code = wait_for(pid_);
    pid_ = -1;
    return code;
}

bool OnTerminal::read() {
    constexpr int patience_ms = static_cast<int>(std::chrono::milliseconds(patience).count());
    pollfd one{.fd = terminal_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&one, 1, patience_ms) != 1) return false;
    char text[4096];
    const ssize_t n = ::read(terminal_.get(), text, sizeof text);
    if (n > 0) shown.append(text, static_cast<std::size_t>(n));
    return n > 0;
}

Servo::Servo(const std::vector<std::string>& words)
    : Background([&] {
          std::vector<std::string> all = words;
          all.insert(all.begin(), KNURLD_PROGRAM);
          return all;
      }()) {
    EXPECT_TRUE(says("knurld: ready")) << said();
}

std::string knurl_program() {
    return KNURL_PROGRAM;
}

std::string knurld_program() {
    return KNURLD_PROGRAM;
}

Outcome knurl(std::vector<std::string> words) {
    words.insert(words.begin(), KNURL_PROGRAM);
    return run(words);
}

namespace {

/// The words in front of a command that take its rights away.
std::vector<std::string> without_rights() {
    std::vector<std::string> words;
    if (missing_other_user().empty())
        words = {"/usr/bin/setpriv", "--reuid=65534", "--regid=65534", "--clear-groups",
                 "--bounding-set=-all"};
    words.insert(words.end(), {"/usr/bin/prlimit", "--rtprio=0", "--memlock=65536"});
    return words;
}

}  // namespace

Outcome knurl_without_rights(const Folder& folder, std::vector<std::string> words) {
    fs::permissions(folder.path(""), fs::perms(0755));
    // The user nobody may have no access to the build folder.
    for (const auto& [from, name] :
         {std::pair{knurl_program(), "knurl"}, std::pair{knurld_program(), "knurld"}})
        fs::copy_file(from, folder.path(name), fs::copy_options::skip_existing);
    words.insert(words.begin(), folder.path("knurl"));
    const std::vector<std::string> without = without_rights();
    words.insert(words.begin(), without.begin(), without.end());
    return run(words);
}

Missing missing_loss_of_rights() {
    std::vector<std::string> words = without_rights();
    for (const char* word : {"/usr/bin/chrt", "--fifo", "1", "/bin/true"}) words.emplace_back(word);
    if (run(words).code != 0) return {};
    return missing("to give up rights", "real-time priority is not to be got rid of",
                   "an ordinary user has none, root needs CAP_SETUID");
}

}  // namespace knurl::test
