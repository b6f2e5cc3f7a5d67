#pragma once
// A fake simulation that speaks IMD, version 2, with the faults that a test needs: a few atoms in a viscous
// liquid, without restoring forces. Like GROMACS, it reads its input when it sends a frame, and keeps forces
// until they are replaced.

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include <knurl/shm/fd.hpp>

namespace knurl::test {

struct FakeImdOptions {
    int atoms = 9;
    bool swapped = false;  // uses the byte order that is not this machine's
    int version = 2;
    bool greets = true;       // otherwise it accepts the connection and sends nothing
    int handshake_bytes = 8;  // with fewer it closes after them
    double steps_per_second = 2000;
    double mobility = 2e-3;   // A a step for 1 kcal/mol/A
    float temperature = 300;  // K
    // Numbers of frames; -1: never. Frames are counted from the first, or from the first that a force moved.
    bool once_pulled = false;
    int cut_at = -1;         // half of that frame, then it closes
    int close_at = -1;       // closes after that frame
    int goodbye_at = -1;     // sends IMD's disconnect message
    int pause_at = -1;       // sends nothing for a while
    double pause = 1.2;      // s
    int more_atoms_at = -1;  // one atom more in that frame
    int nan_at = -1;
    int nonsense_at = -1;  // a message of type 77
    int hot_at = -1;       // from then on 1000 K
};

class FakeImd {
  public:
    explicit FakeImd(FakeImdOptions options = {});
    ~FakeImd();
    FakeImd(const FakeImd&) = delete;
    FakeImd& operator=(const FakeImd&) = delete;

    std::string address() const;
    /// Waits until the present forces on the atoms satisfy `so`, and until frames follow. False: timeout.
    template <class So>
    bool eventually_pulled(So so, std::chrono::seconds patience = std::chrono::seconds(30)) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, patience, [&] { return so(forces_); });
    }
    bool eventually_gone();                          // the other end has closed
    bool was_pulled() const { return was_pulled_; }  // ever
    int forces_read() const { return forces_read_; }
    int rate() const { return rate_; }
    bool said_goodbye() const { return said_goodbye_; }
    bool was_killed() const { return killed_; }

    using Forces = std::map<int, std::array<float, 3>>;

  private:
    void serve(int fd);
    bool read_orders(int fd);
    bool send_frame(int fd);
    std::uint32_t word(std::uint32_t value) const;

    const FakeImdOptions options_;
    shm::UniqueFd listening_, stop_;
    int port_ = 0;
    std::mutex mutex_;
    std::condition_variable changed_;
    Forces forces_;
    bool gone_ = false, unheard_ = false;
    std::vector<std::array<double, 3>> places_;  // A
    std::string unread_;
    std::atomic<bool> was_pulled_{false}, said_goodbye_{false}, killed_{false};
    std::atomic<int> rate_{100}, forces_read_{0};
    int frame_ = 0, step_ = 0;
    std::thread thread_;
};

}  // namespace knurl::test
