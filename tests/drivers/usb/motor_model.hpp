#pragma once
// Any device with three motors: what has reached it, and the faults that any of them may have. So each test
// of cable, servo or guardian is written once.

#include <array>
#include <vector>

#include "model.hpp"

namespace knurl::drivers::usb_emulator {

struct MotorFaults {
    int garbage_replies = 0;  // so many replies are noise
    int short_packets = 0;    // so many packets are cut short
    bool silent = false;      // it receives and sends nothing
    bool stuck = false;       // it accepts no packet
};

/// A packet of efforts that reached it.
struct MotorRequest {
    std::uint64_t frame = 0;
    std::array<int, 3> motors = {};  // in the device's own unit
    int info = 0;                    // the protocol's flags
    bool is_zero() const { return motors == std::array<int, 3>{}; }
};

class MotorModel : public Model {
  public:
    MotorFaults faults;

    /// What the motors exert now.
    std::array<int, 3> motors() const { return motors_; }
    /// Since it was made, over all its powers.
    const std::vector<MotorRequest>& requests() const { return requests_; }
    /// Adds to one encoder, once.
    virtual void slip(std::size_t axis, int counts) = 0;

  protected:
    void obey(const MotorRequest& request) {
        motors_ = request.motors;
        requests_.push_back(request);
    }
    std::array<int, 3> motors_ = {};

  private:
    std::vector<MotorRequest> requests_;
};

}  // namespace knurl::drivers::usb_emulator
