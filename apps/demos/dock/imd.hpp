#pragma once
// A connection to a running simulation: its frames, and a force on one of its atoms.
//
//     dock::Imd simulation("localhost:8889", 5s);
//     simulation.set_rate(10);                                // a frame each ten steps
//     while (!simulation.ended())
//         while (auto frame = simulation.next()) simulation.pull(17, force);
//
// A force stays until it is replaced, so that a program that dies would leave the atom pulled. This one does
// not: its end lets go, and a second process, which does nothing else, does so if the first one is killed or
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

/// Says something to a socket when this process dies, whatever it dies of; and something else when it is
/// stopped (SIGSTOP, a debugger), unless that was in the middle of a message.
class LastWord {
  public:
    LastWord(int socket, const std::string& when_dead, const std::string& when_stopped);
    ~LastWord();  // not necessary any more: says nothing
    LastWord(const LastWord&) = delete;
    LastWord& operator=(const LastWord&) = delete;

    /// Whether a message has begun and has not gone out whole: then nothing can be said behind it.
    void within_message(bool so) { shared_->within_message = so; }
    /// Whether it was said since the last call that this process was stopped.
    bool was_stopped() { return shared_->was_stopped.exchange(false); }

  private:
    struct Shared {
        std::atomic<bool> within_message{false}, was_stopped{false};
    };
    struct Unmap {
        void operator()(Shared* shared) const;
    };
    std::unique_ptr<Shared, Unmap> shared_;  // with the second process
    knurl::shm::UniqueFd alive_;             // its end of a pipe; closed by the kernel if nobody else does
    pid_t pid_ = -1;
};

class Imd {
  public:
    /// Connects to "HOST:PORT" ("[::1]:8889" too), shakes hands and says go. Throws ImdError. Before any
    /// thread is started, since it forks.
    Imd(const std::string& address, std::chrono::milliseconds patience);
    ~Imd();  // lets go and says goodbye
    Imd(const Imd&) = delete;
    Imd& operator=(const Imd&) = delete;

    /// The next frame that has come, in order; does not wait. Throws ImdError with what is wrong with what
    /// came.
    std::optional<ImdFrame> next();
    /// Waits until something has come.
    bool wait(std::chrono::milliseconds timeout) const;
    bool ended() const { return ended_ || broken_ || reader_.ended(); }
    bool paused() const { return reader_.paused(); }
    bool swapped() const { return reader_.swapped(); }

    /// On one atom of the group, in kcal/mol/A; none on all others. A server that does not listen gets the
    /// newest.
    void pull(std::int32_t atom, const Eigen::Vector3d& force);
    void let_go() { pull(0, Eigen::Vector3d::Zero()); }
    /// This process was stopped since the last call, and the atom was let go meanwhile.
    bool let_go_meanwhile() { return last_word_ && last_word_->was_stopped(); }
    void set_rate(int steps);  // between frames
    void kill();               // the simulation shall end

  private:
    [[noreturn]] void fail(const std::string& what) const;
    void shake_hands(std::chrono::milliseconds patience);
    void receive();
    void say(const std::string& message);
    void flush();

    std::string address_;
    knurl::shm::UniqueFd socket_;
    ImdReader reader_;
    bool ended_ = false;                 // nothing comes any more
    bool broken_ = false;                // what came was no IMD
    std::string unsent_, newest_force_;  // a force waits here until what was begun is out
    std::optional<LastWord> last_word_;
};

}  // namespace dock
