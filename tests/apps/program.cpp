#include "program.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace knurl::test {

namespace fs = std::filesystem;

Folder::Folder() : path_((fs::temp_directory_path() / "knurl-test-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) throw std::runtime_error(path_ + ": cannot be made");
}

Folder::~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

Home::Home() {
    ::setenv("KNURL_RUNTIME_DIR", path("").c_str(), 1);
    ::setenv("KNURL_STATE_DIR", path("").c_str(), 1);
}

std::string Folder::file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
}

std::string text_of_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

Outcome run(const std::vector<std::string>& words) {
    const Folder folder;
    const std::string out = folder.path("out"), err = folder.path("err");
    std::vector<char*> argv;
    for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(::open(out.c_str(), O_CREAT | O_WRONLY, 0600), 1);
        ::dup2(::open(err.c_str(), O_CREAT | O_WRONLY, 0600), 2);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return {.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            .out = text_of_file(out),
            .err = text_of_file(err)};
}

void eventually(const std::function<bool()>& condition, const char* what) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            ADD_FAILURE() << "never: " << what;
            return;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

Servo::Servo(const std::vector<std::string>& words) {
    std::vector<std::string> all = words;
    all.insert(all.begin(), KNURLD_PROGRAM);
    std::vector<char*> argv;
    for (const auto& word : all) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        const int nowhere = ::open("/dev/null", O_WRONLY);
        ::dup2(nowhere, 1);
        ::dup2(nowhere, 2);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    eventually([&] { return knurl({"ls"}).out.find("pid " + std::to_string(pid_)) != std::string::npos; },
               "the servo listens");
}

void Servo::kill() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
}

Servo::~Servo() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
}

std::string knurl_program() {
    return KNURL_PROGRAM;
}

Outcome knurl(std::vector<std::string> words) {
    words.insert(words.begin(), KNURL_PROGRAM);
    return run(words);
}

}  // namespace knurl::test
