#pragma once
// What a way has sent, felt by itself: at the recorded places, with the device's limits, without fades or
// recovery. Beside it stands what was felt; what differs the servo has added (or the way did, by its
// updates).

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

    /// These and no others, by a commit that lasted from `begin` to `end` (ns). A shape is one of asset 1.
    void say(std::int64_t begin, std::int64_t end, std::vector<Piece> pieces);
    /// N, of each recorded cycle. Not a number where the update may have come before the cycle took its
    /// updates or after: which of two was in force nobody knows. Empty: nothing was said.
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
