#include "stroke.hpp"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include <knurl/measure/output_file.hpp>

namespace surface {
namespace {

/// The serpentine by the travelled distance, about the origin.
struct Serpentine {
    double half_width, half_length;
    int rows;

    double spacing() const { return 2 * half_length / (rows - 1); }
    double turn() const { return M_PI * spacing() / 2; }
    double length() const { return rows * 2 * half_width + (rows - 1) * turn(); }

    Eigen::Vector2d at(double way) const {
        const double per_row = 2 * half_width + turn();
        const int row = std::min(rows - 1, static_cast<int>(way / per_row));
        const double in_row = way - row * per_row;
        const double eastwards = row % 2 == 0 ? 1 : -1;
        const double y = half_length - row * spacing();
        if (in_row <= 2 * half_width) return {eastwards * (in_row - half_width), y};
        const double radius = spacing() / 2, angle = (in_row - 2 * half_width) / radius;
        return {eastwards * (half_width + radius * std::sin(angle)), y - radius * (1 - std::cos(angle))};
    }
};

/// 0 to 1 over u in [0, 1], with continuous velocity.
double smoothstep(double u) {
    return u * u * (3 - 2 * u);
}

}  // namespace

Stroke make_stroke(const Terrain& terrain, const StrokeOptions& options) {
    // A relief much smaller than the hand's path is stroked as a whole, with some level ground around it.
    const Serpentine way{
        .half_width = std::clamp(0.8 * terrain.half_width(), 0.2 * options.half_width, options.half_width),
        .half_length =
            std::clamp(0.8 * terrain.half_length(), 0.2 * options.half_length, options.half_length),
        .rows = options.rows};
    const Terrain broad(smoothed(terrain.grid(), options.breadth / terrain.grid().cell));

    const double cruise = way.length() / options.speed - options.speed_up;  // s at full speed
    const auto travelled = [&](double t) {                                  // trapezoid of speed
        if (t <= 0) return 0.0;
        if (t < options.speed_up) return 0.5 * options.speed * t * t / options.speed_up;
        if (t < options.speed_up + cruise) return options.speed * (t - 0.5 * options.speed_up);
        const double left = std::max(0.0, 2 * options.speed_up + cruise - t);
        return way.length() - 0.5 * options.speed * left * left / options.speed_up;
    };

    Stroke stroke;
    stroke.begin = options.approach;
    stroke.rest_at = options.approach + 2 * options.speed_up + cruise;
    stroke.end = stroke.rest_at + options.rest;
    const int steps = static_cast<int>(std::ceil(stroke.end / options.step));
    for (int i = 0; i <= steps; ++i) {
        const double t = i * options.step;
        const Eigen::Vector2d at = way.at(travelled(t - options.approach));
        const double pressed = broad.height(at.x(), at.y()) - options.press;
        const double above =
            std::max(broad.height(at.x(), at.y()), terrain.height(at.x(), at.y())) + options.clearance;
        const double down = smoothstep(std::min(1.0, t / options.approach));
        stroke.rows.push_back({t, {at.x(), at.y(), above + down * (pressed - above)}});
    }
    return stroke;
}

void write_stroke(const Stroke& stroke, const std::filesystem::path& file) {
    std::string out = "t,x,y,z\n";
    for (const auto& row : stroke.rows)
        fmt::format_to(std::back_inserter(out), "{:.6g},{:.9g},{:.9g},{:.9g}\n", row.t, row.position.x(),
                       row.position.y(), row.position.z());
    knurl::measure::write_file(file, out);
}

}  // namespace surface
