#pragma once
// Pulls the hand of a simulated device that was given a pipe (sim:premium15,live=PIPE): records of the kernel's input
// layer, as drivers/src/sim/live_hand.hpp reads them.

#include <string>

#include <knurl/reps/vec.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::gateway {

class HandPipe {
  public:
    /// The pipe in a device's address; not there: can_pull() is false.
    explicit HandPipe(const std::string& address);
    bool can_pull() const { return pipe_.get() >= 0; }
    /// The hand wants to be there (m, device frame). Waits for nothing: what a full pipe does not take is lost.
    void pull(const Vec3& target) const noexcept;

  private:
    shm::UniqueFd pipe_;
};

}  // namespace knurl::gateway
