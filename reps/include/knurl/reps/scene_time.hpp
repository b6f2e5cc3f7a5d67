#pragma once

namespace knurl {

/// The time for which a scene has been evaluated.
struct SceneTime {
    /// All of it (s).
    double all = 0;
    /// Without the silences, in which what holds stands still (s).
    double held = 0;
    /// The one or the other (s).
    double of(bool holds) const noexcept { return holds ? held : all; }
};

}  // namespace knurl
