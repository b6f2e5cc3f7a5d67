#pragma once
// visualization_msgs/MarkerArray: what is drawn, changed and deleted by namespace and number.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/messages/messages.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl::messages {

struct Colour {
    float r = 1, g = 1, b = 1, a = 1;
    friend bool operator==(const Colour&, const Colour&) = default;
};

struct Marker {
    enum Type : std::int32_t {
        arrow = 0,
        cube = 1,
        sphere = 2,
        cylinder = 3,
        line_strip = 4,
        line_list = 5,
        text_view_facing = 9,
        triangle_list = 11
    };
    enum Action : std::int32_t { add = 0, erase = 2, erase_all = 3 };

    std::string ns;
    std::int32_t id = 0;
    Type type = cube;
    Action action = add;
    Vec3 position;
    Quat orientation;
    Vec3 scale = {1, 1, 1};
    Colour colour;
    std::vector<Vec3> points;
    std::string text;
};

Bytes markers_message(std::string_view frame, std::int64_t stamp_ns, std::span<const Marker> markers);

}  // namespace knurl::messages
