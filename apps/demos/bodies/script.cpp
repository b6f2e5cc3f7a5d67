#include "script.hpp"

#include <cmath>

#include <fmt/format.h>

#include <knurl/measure/output_file.hpp>

namespace bodies {

Script::Script(const Vector3d& start) {
    rows_.push_back({.t = 0, .position = start});
}

Script& Script::to(const Vector3d& where, double speed) {
    constexpr double peak = 1.875;  // maximum speed over mean speed
    constexpr double row = 5e-3;    // s
    const knurl::drivers::MotionRow from = rows_.back();
    const double seconds = std::max(0.05, peak * (where - from.position).norm() / speed);
    const int n = static_cast<int>(std::ceil(seconds / row));
    for (int i = 1; i <= n; ++i) {
        const double x = static_cast<double>(i) / n;
        const double share = x * x * x * (10 - x * (15 - 6 * x));
        rows_.push_back(
            {.t = from.t + x * seconds, .position = from.position + share * (where - from.position)});
    }
    return *this;
}

Script& Script::rest(double seconds) {
    rows_.push_back({.t = end() + seconds, .position = rows_.back().position});
    return *this;
}

Script& Script::take() {
    events_.push_back({.t = end(), .take = true});
    return *this;
}

Script& Script::let_go() {
    events_.push_back({.t = end(), .take = false});
    return *this;
}

void Script::write(const std::string& path) const {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "t,x,y,z\n");
    for (const auto& row : rows_)
        fmt::format_to(out, "{:.6f},{:.9g},{:.9g},{:.9g}\n", row.t, row.position.x(), row.position.y(),
                       row.position.z());
    knurl::measure::write_file(path, fmt::to_string(text));
}

Script push_take_and_stack() {
    Script script({-0.06, 0, 0});
    script.rest(0.3).to({-0.06, 0, -0.035}, 0.1);
    script.to({-0.015, 0, -0.035}, 0.06).rest(0.3).to({-0.05, 0, -0.035}, 0.06);  // along the floor
    script.to({-0.05, 0, 0.0}, 0.1).to({-0.008, 0, 0.0}, 0.1).to({-0.008, 0, -0.022}, 0.05).rest(0.2);
    script.take().rest(0.2).to({-0.008, 0, 0.03}, 0.08).to({0.045, 0, 0.03}, 0.1);
    script.to({0.045, 0, 0.003}, 0.05).rest(0.4).let_go().rest(0.6).to({0.045, 0, 0.04}, 0.1).rest(0.3);
    return script;
}

}  // namespace bodies
