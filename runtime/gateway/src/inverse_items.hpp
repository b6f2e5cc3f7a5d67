#pragma once
// Representations as JSON, in the axes of a client: what stands behind `knurl` in a device's commands. Private to this
// module.

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include <knurl/gateway/frames.hpp>
#include <knurl/json/json.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/reps/scene.hpp>

namespace knurl::gateway {

/// A representation as a client stated it.
struct InverseItem {
    std::string id;
    Kind kind = 0;
    AddOptions options;
    std::vector<std::byte> params;  // in the client's axes
};

/// What is wrong with a message: one line.
struct InverseMistake : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// {"id": "floor", "kind": "plane", ...fields}. Throws InverseMistake.
InverseItem read_item(const Json& stated);
/// The same without `kind`, which stays as it was; what is not stated stays, too. Throws InverseMistake.
InverseItem read_change(const Json& stated, const InverseItem& before);
/// The id of either. Throws InverseMistake.
std::string read_item_id(const Json& stated);

/// The parameters of a kind seen from other axes. What lies in the probe's or a box's own axes has those renamed as well,
/// as orientations do (Axes::orientation).
std::vector<std::byte> in_axes(const Axes& axes, Kind kind, const std::vector<std::byte>& params);

}  // namespace knurl::gateway
