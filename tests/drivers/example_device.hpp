#pragma once
// A whole driver in sixty lines, for drivers/README.md: a slider with one motor on a circuit board.

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>

#include <knurl/drivers/device.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/serial_chain.hpp>

namespace knurl::drivers::example {

/// What the hardware is: here two registers; elsewhere a USB node, whose I/O thread fills and empties such
/// words.
struct Board {
    std::atomic<int> encoder = 0;    // counts of 10 um
    std::atomic<int> milliamps = 0;  // 2 N per ampere
    std::atomic<bool> plugged = true;
};

class Slider final : public Device {
  public:
    explicit Slider(Board& board) : board_(board), mechanism_({.rows = {{.prismatic = true}}}) {
        link_.name = "slider";
        link_.description = "an example: one sliding axis along z";
        link_.sensed_joints = link_.actuated_joints = 1;
        link_.radians_per_count = {1e-5};  // m
        link_.effort_limit = {3};          // N
        link_.workspace_radius = 0.05;     // m
        link_.peak_force = link_.continuous_force = 3;
        link_.damping = 0.5;  // N s/m, measured
        link_.lag = 1e-3;     // s
    }
    ~Slider() override { make_safe(); }

    const LinkConfig& link() const noexcept override { return link_; }
    const Mechanism& mechanism() const noexcept override { return mechanism_; }

    ReadStatus read(Nanoseconds, JointSample& sample) noexcept override {
        sample.position[0] = 1e-5 * board_.encoder.load(std::memory_order_relaxed);
        return board_.plugged.load(std::memory_order_relaxed) ? ReadStatus::ok : ReadStatus::unplugged;
    }
    bool write(Nanoseconds, const JointEfforts& efforts) noexcept override {
        const double newtons = std::isfinite(efforts[0]) ? std::clamp(efforts[0], -3.0, 3.0) : 0;
        board_.milliamps.store(static_cast<int>(std::lround(newtons / 2 * 1000)), std::memory_order_relaxed);
        return board_.plugged.load(std::memory_order_relaxed);
    }
    void make_safe() noexcept override { board_.milliamps.store(0, std::memory_order_relaxed); }

  private:
    Board& board_;
    SerialChain mechanism_;
    LinkConfig link_;
};

/// The one line of registration: drivers().push_back(slider_driver(board)), or the list in registry.cpp.
inline Driver slider_driver(Board& board) {
    return {.scheme = "slider", .help = "bench", .open = [&board](std::string_view what, const OpenOptions&) {
                if (what != "bench") {
                    throw std::runtime_error("no slider \"" + std::string(what) + "\"; there is bench");
                }
                return std::make_unique<Slider>(board);
            }};
}

}  // namespace knurl::drivers::example
