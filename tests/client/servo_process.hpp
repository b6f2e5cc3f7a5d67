#pragma once
// A real knurld with a simulated device, in a folder that is removed at the end. KNURL_TEST_TRANSPORT=bridge
// puts a real knurl-bridge before it, which connect() uses; with bridge-with-key that bridge requires a key.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/reps/constant_force.hpp>

#include "../eventually.hpp"
#include "../temp_folder.hpp"
#include "bridge_process.hpp"

namespace client_test {

using namespace std::chrono_literals;
using knurl::test::eventually;

class ServoProcess {
  public:
    explicit ServoProcess(std::vector<std::string> arguments = {"--device", "sim:cartesian3"},
                          std::string program = KNURLD)
        : program_(std::move(program)), arguments_(std::move(arguments)) {
        ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // only a parent can wait for a dead servo's guardian
        std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_all |
                                                         std::filesystem::perms::others_exec |
                                                         std::filesystem::perms::group_exec);
        ::setenv("KNURL_RUNTIME_DIR", folder_.path().c_str(), 1);
        ::setenv("KNURL_STATE_DIR", (folder_ / "state").c_str(), 1);
        start();
        if (!through_bridge()) return;
        bridge_.emplace(keys());
        ::setenv("KNURL_TEST_ADDRESS", bridge_->address().c_str(), 1);
    }
    ~ServoProcess() {
        bridge_.reset();
        if (pid_ > 0) end(SIGKILL);
        // They save the flight record, and would create a folder anew that is gone already.
        for (const pid_t guardian : guardians_) ::waitpid(guardian, nullptr, 0);
    }
    ServoProcess(const ServoProcess&) = delete;
    ServoProcess& operator=(const ServoProcess&) = delete;

    static bool through_bridge() {
        const char* transport = std::getenv("KNURL_TEST_TRANSPORT");
        return transport != nullptr && std::string(transport).starts_with("bridge");
    }
    /// The owner of this process's claims, as the servo sees it.
    pid_t claimant() const { return bridge_ ? bridge_->pid() : ::getpid(); }

    void start() {
        pid_ = ::fork();
        if (pid_ != 0) return;
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // no servo outlives its test
        const int log = ::open((folder_ / "log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
        ::dup2(log, STDOUT_FILENO);
        ::dup2(log, STDERR_FILENO);
        std::vector<char*> words{program_.data()};
        for (std::string& word : arguments_) words.push_back(word.data());
        words.push_back(nullptr);
        ::execv(program_.c_str(), words.data());
        ::_exit(127);
    }
    /// Ends it with this signal; on return it is gone.
    void end(int signal) {
        std::ifstream children("/proc/" + std::to_string(pid_) + "/task/" + std::to_string(pid_) +
                               "/children");
        for (pid_t child = 0; children >> child;) guardians_.push_back(child);
        ::kill(pid_, signal);
        ::kill(pid_, SIGCONT);
        ::waitpid(pid_, nullptr, 0);
        pid_ = -1;
    }
    void stop() {
        ::kill(pid_, SIGSTOP);
        ::waitpid(pid_, nullptr, WUNTRACED);
    }
    void go_on() { ::kill(pid_, SIGCONT); }

    pid_t pid() const { return pid_; }
    std::filesystem::path socket() const { return folder_ / "default.sock"; }

  private:
    /// The bridge's arguments; connections from here have the key.
    std::vector<std::string> keys() const {
        if (std::string(std::getenv("KNURL_TEST_TRANSPORT")) != "bridge-with-key") return {"--anyone"};
        const std::string file = (folder_ / "keys").string();
        std::string make = KNURL_BRIDGE;
        make += " keygen --name test --role control --keys " + file + " >/dev/null";
        if (std::system(make.c_str()) != 0) throw std::runtime_error("no key for the test");
        ::setenv("KNURL_KEY", file.c_str(), 1);
        return {"--keys", file};
    }

    std::string program_;
    std::vector<std::string> arguments_;
    knurl::test::TempFolder folder_;
    pid_t pid_ = -1;
    std::vector<pid_t> guardians_;  // of the servos that have ended
    std::optional<BridgeProcess> bridge_;
};

/// Patient: a sanitizer build on a busy machine starts slowly.
inline knurl::Client connect(bool reattach = true) {
    const char* address =
        ServoProcess::through_bridge() ? std::getenv("KNURL_TEST_ADDRESS") : "knurl:default";
    return knurl::Client::connect(address, {.name = "test", .wait = 20s, .reattach = reattach});
}

/// To the servo itself, whatever connect() goes through.
inline knurl::Client connect_beside() {
    return knurl::Client::connect("knurl:default", {.name = "beside", .wait = 20s});
}

/// Reads until a report satisfies `wanted`, and keeps committing. Fails after a minute.
template <class Wanted>
knurl::HandReport read_until(knurl::Claim& hand, Wanted wanted) {
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    knurl::HandReport last;
    while (std::chrono::steady_clock::now() < deadline) {
        const auto report = hand.next_report(100ms);
        hand.commit();
        if (report && wanted(*report)) return *report;
        if (report) last = *report;
    }
    std::ostringstream seen;
    seen << "what the test waited for did not happen within a minute; the last report: cycle " << last.cycle
         << ", state " << static_cast<int>(last.state) << ", faults " << last.faults << ", force along x "
         << last.scene_force.x << " N, sent " << last.sent_force.x << " N";
    throw std::runtime_error(seen.str());
}

inline bool is_active(const knurl::HandReport& report) {
    return report.state == knurl::DeviceState::active;
}
/// Active, or ramping up: the half second of the ramp matters only where the whole force does.
inline bool is_on(const knurl::HandReport& report) {
    return is_active(report) || report.state == knurl::DeviceState::ramp_up;
}

/// In full effect with its first cycle.
inline knurl::ConstantForce at_once(const knurl::Vec3& force) {
    return {.force = force, .recovery = 0};
}

/// A device whose holder has gone is free when its force has faded. Throws if it never is.
inline knurl::Claim claim_when_free(knurl::Client& client) {
    std::optional<knurl::Claim> claim;
    const auto claimed = [&] {
        try {
            claim.emplace(client.claim());
        } catch (const knurl::Error& error) {
            if (error.kind != knurl::Error::Kind::device_held) throw;
        }
        return claim.has_value();
    };
    if (!eventually(claimed)) throw std::runtime_error("the device is never free");
    return std::move(*claim);
}

}  // namespace client_test
