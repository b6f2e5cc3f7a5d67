#pragma once
// /diagnostics: a status of each device, once a second while somebody reads.

#include <chrono>

#include <knurl/dds/domain.hpp>
#include <knurl/dds/registry.hpp>
#include <knurl/dds/robot_side.hpp>

namespace knurl::dds {

class Diagnostics {
  public:
    Diagnostics(Domain& domain, const RobotOptions& options);
    void write(const ServoEntry& servo);

  private:
    Entity writer_;
    std::chrono::nanoseconds interval_{};
    std::chrono::steady_clock::time_point due_{};
};

}  // namespace knurl::dds
