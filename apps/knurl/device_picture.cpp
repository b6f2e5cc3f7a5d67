// The arm and its reach, from the side and from above.

#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <stdexcept>

#include <cairo.h>
#include <fmt/format.h>

#include "device_check.hpp"

namespace knurl::cli {

namespace {

using Eigen::Vector3d;

constexpr int panel = 420, head = 46, foot = 40;  // pixels
constexpr double title_size = 15, text_size = 13;
constexpr int rays = 240;

struct Colour {
    double red, green, blue;  // 0 to 1
};
constexpr Colour ink{0.13, 0.13, 0.14}, faint{0.37, 0.39, 0.41}, paper{1, 1, 1};

/// Teal where the tip moves alike in all directions, red where it hardly moves in one.
Colour colour_of(double conditioning) {
    const double good = std::clamp(conditioning / 0.6, 0.0, 1.0);
    return {0.86 - 0.55 * good, 0.30 + 0.42 * good, 0.25 + 0.43 * good};
}

/// Cairo with the elements of this picture. Pixels from the left and from the top.
class Canvas {
  public:
    Canvas(int width, int height)
        : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy),
          pen_(cairo_create(surface_.get()), cairo_destroy) {
        cairo_set_line_cap(pen_.get(), CAIRO_LINE_CAP_ROUND);
        cairo_select_font_face(pen_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
        use(paper);
        cairo_paint(pen_.get());
    }
    void dot(double x, double y, double radius, Colour colour) {
        use(colour);
        cairo_arc(pen_.get(), x, y, radius, 0, 2 * std::numbers::pi);
        cairo_fill(pen_.get());
    }
    void line(double x0, double y0, double x1, double y1, double width, Colour colour) {
        use(colour);
        cairo_move_to(pen_.get(), x0, y0);
        cairo_line_to(pen_.get(), x1, y1);
        stroke(width);
    }
    void circle(double x, double y, double radius, double width, Colour colour) {
        use(colour);
        cairo_arc(pen_.get(), x, y, radius, 0, 2 * std::numbers::pi);
        stroke(width);
    }
    /// From the left end of its base line.
    void words(double x, double y, const std::string& text, double size, Colour colour) {
        use(colour);
        cairo_set_font_size(pen_.get(), size);
        cairo_move_to(pen_.get(), x, y);
        cairo_show_text(pen_.get(), text.c_str());
    }
    void write(const std::string& path) {
        errno = 0;
        const cairo_status_t status = cairo_surface_write_to_png(surface_.get(), path.c_str());
        if (status != CAIRO_STATUS_SUCCESS)
            throw std::runtime_error(
                fmt::format("{}: cannot be written: {}", path,
                            errno != 0 ? std::strerror(errno) : cairo_status_to_string(status)));
    }

  private:
    void use(Colour colour) { cairo_set_source_rgb(pen_.get(), colour.red, colour.green, colour.blue); }
    void stroke(double width) {
        cairo_set_line_width(pen_.get(), width);
        cairo_stroke(pen_.get());
    }
    std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
    std::unique_ptr<cairo_t, void (*)(cairo_t*)> pen_;
};

struct View {
    double left, top;        // of its panel
    double scale;            // pixels a metre
    Vector3d middle;         // m
    Eigen::Index right, up;  // axes
    double x(const Vector3d& p) const { return left + panel / 2.0 + scale * (p[right] - middle[right]); }
    double y(const Vector3d& p) const { return top + panel / 2.0 - scale * (p[up] - middle[up]); }
};

void draw_view(Canvas& canvas, const View& view, const std::vector<Ray>& slice, const Lines& lines,
               double radius, const std::string& title) {
    const double wide = std::max(2.0, view.scale * 0.004);
    for (const Ray& along : slice) {
        for (const Reached& reached : along.steps) {
            // Rays diverge, so dots grow with the distance.
            const double gap = 2 * std::numbers::pi / rays * reached.position.norm() * view.scale;
            canvas.dot(view.x(reached.position), view.y(reached.position), 0.6 * std::max(wide, gap),
                       colour_of(reached.conditioning));
        }
    }
    canvas.circle(view.x(Vector3d::Zero()), view.y(Vector3d::Zero()), radius * view.scale, 2, ink);
    for (const auto& points : lines) {
        for (std::size_t i = 1; i < points.size(); ++i) {
            canvas.line(view.x(points[i - 1]), view.y(points[i - 1]), view.x(points[i]), view.y(points[i]), 7,
                        paper);
            canvas.line(view.x(points[i - 1]), view.y(points[i - 1]), view.x(points[i]), view.y(points[i]), 4,
                        ink);
        }
        for (const Vector3d& point : points) {
            canvas.dot(view.x(point), view.y(point), 5, ink);
            canvas.dot(view.x(point), view.y(point), 2.5, paper);
        }
    }
    canvas.words(view.left + 14, view.top - 4, title, text_size, faint);
}

}  // namespace

void draw(const CheckedArm& arm, const ArmCheck& checked, const std::string& path) {
    const Lines lines = skeleton(arm, arm.profile.centre);
    Vector3d low = checked.low, high = checked.high;
    for (const auto& points : lines) {
        for (const Vector3d& point : points) {
            low = low.cwiseMin(point);
            high = high.cwiseMax(point);
        }
    }
    const double scale = 0.88 * panel / std::max(0.01, (high - low).maxCoeff());
    Canvas canvas(2 * panel, head + panel + foot);
    for (const Eigen::Index up : {2, 1}) {
        std::vector<Ray> slice;
        for (int i = 0; i < rays; ++i) {
            const double turn = 2 * std::numbers::pi * i / rays;
            slice.push_back(
                ray(arm, std::cos(turn) * Vector3d::UnitX() + std::sin(turn) * Vector3d::Unit(up)));
        }
        draw_view(canvas,
                  {.left = up == 2 ? 0.0 : panel,
                   .top = head,
                   .scale = scale,
                   .middle = 0.5 * (low + high),
                   .right = 0,
                   .up = up},
                  slice, lines, arm.profile.workspace_radius,
                  up == 2 ? "side: x right, z up" : "above: x right, y up");
    }
    canvas.words(
        14, 22,
        fmt::format("{}: circle = stated workspace {:g} m", arm.profile.name, arm.profile.workspace_radius),
        title_size, ink);
    double bar = 0.001;  // m: 1, 10, 100 mm, as wide as fits
    while (bar * 10 * scale < 0.5 * panel) bar *= 10;
    const double y = head + panel + 14;
    canvas.line(14, y, 14 + bar * scale, y, 3, ink);
    canvas.words(24 + bar * scale, y + 5, fmt::format("{:g} m", bar), text_size, ink);
    const double key = panel + 14;
    for (int i = 0; i <= 120; ++i) canvas.dot(key + i, y, 5, colour_of(0.6 * i / 120));
    canvas.words(key + 136, y + 5, "conditioning: 0 (singular) to 0.6", text_size, faint);
    canvas.write(path);
}

}  // namespace knurl::cli
