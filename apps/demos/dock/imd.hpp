#pragma once
// A connection to a running simulation: its frames, and a force on one of its atoms.
//
//     dock::Imd simulation("localhost:8889", 5s);
//     simulation.set_rate(10);                                // a frame each ten steps
//     while (!simulation.ended())
//         while (auto frame = simulation.next()) simulation.pull(17, force);
//
// A force stays until it is replaced, so the atom would stay pulled if this program died. Its end therefore
// releases the atom, and a second process, which does nothing else, releases it if the first one is killed or
// stopped.

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <sys/types.h>

#include <knurl/shm/fd.hpp>

#include "imd_reader.hpp"

namespace dock {

/// Sends a message to a socket when this process dies, for any reason, and another one when it is stopped
/// (SIGSTOP, a debugger), unless that happens within a message.
class LastWord {
  public:
    LastWord(int socket, const std::string& when_dead, const std::string& when_stopped);
    ~LastWord();  // normal end: sends nothing
    LastWord(const LastWord&) = delete;
    LastWord& operator=(const LastWord&) = delete;

    /// A message has been sent in part, so no other can follow it.
    void within_message(bool so) { shared_->within_message = so; }
    /// The stop message was sent since the last call.
    bool was_stopped() { return shared_->was_stopped.exchange(false); }

  private:
    struct Shared {
        std::atomic<bool> within_message{false}, was_stopped{false};
    };
    struct Unmap {
        void operator()(Shared* shared) const;
    };
    std::unique_ptr<Shared, Unmap> shared_;  // with the second process
    knurl::shm::UniqueFd alive_;             // this end of a pipe; the kernel closes it at the latest
    pid_t pid_ = -1;
};

class Imd {
  public:
    /// Connects to "HOST:PORT" (also "[::1]:8889"), shakes hands and starts the simulation. Throws ImdError.
    /// Forks, so call it before any thread is started.
    Imd(const std::string& address, std::chrono::milliseconds patience);
    ~Imd();  // lets go and says goodbye
    Imd(const Imd&) = delete;
    Imd& operator=(const Imd&) = delete;

    /// The next frame that has arrived, in order; does not wait. Throws ImdError for malformed data.
    std::optional<ImdFrame> next();
    /// Waits until data arrives.
    bool wait(std::chrono::milliseconds timeout) const;
    bool ended() const { return ended_ || broken_ || reader_.ended(); }
    bool paused() const { return reader_.paused(); }
    bool swapped() const { return reader_.swapped(); }

    /// Force on one atom of the group, in kcal/mol/A; none on all others. A server that reads slowly gets the
    /// newest.
    void pull(std::int32_t atom, const Eigen::Vector3d& force);
    void let_go() { pull(0, Eigen::Vector3d::Zero()); }
    /// This process was stopped since the last call, and the atom was released meanwhile.
    bool let_go_meanwhile() { return last_word_ && last_word_->was_stopped(); }
    void set_rate(int steps);  // between frames
    void kill();               // ends the simulation

  private:
    [[noreturn]] void fail(const std::string& what) const;
    void shake_hands(std::chrono::milliseconds patience);
    void receive();
    void say(const std::string& message);
    void flush();

    std::string address_;
    knurl::shm::UniqueFd socket_;
    ImdReader reader_;
    bool ended_ = false;                 // no more data
    bool broken_ = false;                // the data were not IMD
    std::string unsent_, newest_force_;  // a force waits here until the message under way is complete
    std::optional<LastWord> last_word_;
};

}  // namespace dock
