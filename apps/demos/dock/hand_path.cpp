#include "hand_path.hpp"

#include <random>

#include <Eigen/Core>
#include <fmt/format.h>

#include <knurl/measure/output_file.hpp>

namespace dock {

namespace {

using Eigen::Vector3d;

/// 0 to 1; the distributions of <random> differ between libraries.
double uniform(std::mt19937& random) {
    return static_cast<double>(random()) / 0x1p32;
}

}  // namespace

void write_path(const std::string& file, const HandPath& path) {
    constexpr double row = 0.01;  // s
    std::mt19937 random(path.seed);
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "t,x,y,z\n");
    Vector3d from = Vector3d::Zero(), to = from;
    double begin = 0, time = 0;
    const auto rows = static_cast<long>(path.seconds / row);
    for (long i = 0; i <= rows; ++i) {
        const double t = static_cast<double>(i) * row;
        if (t >= begin + time) {
            from = to;
            begin = t;
            time = path.rough ? 0.2 + 0.4 * uniform(random) : 0.5 + 0.8 * uniform(random);
            do {
                for (double& x : to) x = path.reach * (2 * uniform(random) - 1);
            } while (to.norm() > path.reach);
            if (t + 2 * time > path.seconds) to.setZero();
        }
        const double s = std::min(1.0, (t - begin) / time);  // minimum jerk
        const Vector3d at = from + s * s * s * (10 - 15 * s + 6 * s * s) * (to - from);
        fmt::format_to(out, "{:.3f},{:.9g},{:.9g},{:.9g}\n", t, at.x(), at.y(), at.z());
    }
    knurl::measure::write_file(file, fmt::to_string(text));
}

bool Restless::changes_its_mind(double now) {
    const auto hold = [this] { return 1 + 5 * uniform(random_); };
    if (next_ == 0) next_ = now + hold();
    if (now < next_) return false;
    holds_ = !holds_;
    next_ = now + (holds_ ? hold() : 0.2 + 0.8 * uniform(random_));
    return true;
}

}  // namespace dock
