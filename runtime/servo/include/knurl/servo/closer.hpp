#pragma once

/// @file
/// Closing of descriptors that a client can make slow. A socket holds whatever descriptors were sent to it and
/// not received, and the process that closes it last closes those as well. A client decides what they are: a
/// TCP socket with SO_LINGER sleeps for as long as the client says, a file of FUSE until the client's own
/// process answers. So the broker closes no connection itself: it hands it to a process that does nothing
/// else, with a thread for each.
///
///   broker:  shutdown (the client sees a hang-up) ─> message + descriptor ─> closes its own ─> "now"
///   closer:                                         keeps it                                   closes it
///
/// The closer waits for "now", so that its descriptor is the last one.

#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/shm/fd.hpp>

namespace knurl::servo {

/// The broker's side of that process, which it starts, and starts anew if it has died or does not keep up.
class Closer {
  public:
    /// `program` answers --close-descriptors with close_descriptors_main(). Throws std::runtime_error.
    explicit Closer(std::string program = "/proc/self/exe");
    /// The process ends once it sees this.
    ~Closer();
    Closer(const Closer&) = delete;
    Closer& operator=(const Closer&) = delete;

    /// Hangs up, if it is a socket, and has it closed. Never waits for it to be closed.
    void close(shm::UniqueFd fd) noexcept;

    /// Number of its process.
    pid_t pid() const noexcept { return pid_; }
    /// Its end of the connection to that process, for children that must not hold it.
    int socket() const noexcept { return socket_.get(); }

  private:
    void start();
    bool hand_over(shm::UniqueFd& fd) noexcept;
    bool hand_over_kept() noexcept;
    void reap() noexcept;

    std::string program_;
    shm::UniqueFd socket_;
    pid_t pid_ = 0;
    std::vector<pid_t> ending_;
    std::vector<shm::UniqueFd> kept_;  // that no process has taken yet
};

/// The closer's main function: it closes what comes through descriptor 0, until that hangs up. Returns its
/// exit code.
int close_descriptors_main();
/// The argument that asks for it.
inline constexpr const char* close_descriptors_option = "--close-descriptors";

}  // namespace knurl::servo
