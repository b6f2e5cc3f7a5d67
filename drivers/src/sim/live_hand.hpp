#pragma once
// A person moves the simulated hand with mouse and keyboard: events of the kernel's input layer (evdev), read
// on a separate thread.
//
//   mouse         x, y of the device frame, 0.2 mm a count; wheel: z, 2 mm a notch; buttons: the report's
//   absolute      ABS_X, ABS_Y, ABS_Z: places in the device frame, 10 um a unit, from a program (through a FIFO)
//   keyboard      arrows x, y, page up and down z, 50 mm/s while held; space is button 0 too

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Core>

#include <knurl/drivers/motion.hpp>

struct input_event;

namespace knurl::drivers {

class LiveHand {
  public:
    /// `paths`: "/dev/input/event3" or several, separated by colons. `reach`: m, radius of the ball about the
    /// origin in which the hand stays. Throws std::runtime_error: a path cannot be opened, with the command
    /// that grants the right; or it is no event node (a FIFO may replace one).
    LiveHand(const std::string& paths, double reach);
    ~LiveHand();
    LiveHand(const LiveHand&) = delete;
    LiveHand& operator=(const LiveHand&) = delete;

    /// The wanted place h (s) after the last call: it follows the events with some 30 ms delay.
    MotionSample wanted(double h) noexcept;
    std::uint32_t buttons() const noexcept { return buttons_.load(std::memory_order_relaxed); }

  private:
    void listen() noexcept;
    void take(const input_event& event) noexcept;

    double reach_;
    std::vector<int> nodes_;
    int stop_ = -1;  // eventfd
    // Written by the listener, read by the cycle; the values are independent, so no order is needed.
    std::array<std::atomic<std::int64_t>, 3> counts_ = {};   // since the start, along x, y, z
    std::array<std::atomic<std::uint64_t>, 3> places_ = {};  // number of the event << 32 | its value
    std::atomic<std::uint32_t> held_ = 0;                    // bit per key that moves: -x +x -y +y -z +z
    std::atomic<std::uint32_t> buttons_ = 0;
    // Used by the cycle alone, so they are not atomic.
    std::array<std::int64_t, 3> taken_ = {};
    std::array<std::uint64_t, 3> placed_ = {};
    Eigen::Vector3d target_ = Eigen::Vector3d::Zero(), place_ = Eigen::Vector3d::Zero();  // m
    std::thread listener_;
};

}  // namespace knurl::drivers
