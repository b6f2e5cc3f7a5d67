#pragma once
// Evaluates the surface that a way has sent: at the recorded places, with the device's limits, without fades
// or recovery. Its difference to the recorded force comes from the servo (or from the way's updates).

#include <cstdint>
#include <variant>
#include <vector>

#include <knurl/geometry/asset.hpp>
#include <knurl/reps/cap.hpp>
#include <knurl/reps/limits.hpp>
#include <knurl/reps/plane.hpp>
#include <knurl/reps/shape.hpp>

#include "recording.hpp"

namespace surface {

class Stated {
  public:
    using Piece = std::variant<knurl::Plane, knurl::Cap, knurl::Shape>;

    /// These pieces and no others, by a commit that lasted from `begin` to `end` (ns). A shape uses asset 1.
    void say(std::int64_t begin, std::int64_t end, std::vector<Piece> pieces);
    /// N, of each recorded cycle. NaN where the update may have come before or after the cycle took its
    /// updates, so that it is unknown which was in force. Empty: nothing was sent.
    std::vector<Eigen::Vector3d> force(const Recording& recording, const knurl::Limits& limits,
                                       const knurl::Asset* asset = nullptr) const;

  private:
    struct Update {
        std::int64_t begin = 0, end = 0;
        std::vector<Piece> pieces;
    };
    std::vector<Update> updates_;  // by time
};

}  // namespace surface
