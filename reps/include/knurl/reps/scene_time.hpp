#pragma once

namespace knurl {

/// The time that a scene has been felt for.
struct SceneTime {
    double all = 0;   // s
    double held = 0;  // s, without the silences, in which what is held stands still
    double of(bool holds) const noexcept { return holds ? held : all; }
};

}  // namespace knurl
