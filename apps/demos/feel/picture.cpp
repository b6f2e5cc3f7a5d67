#include "picture.hpp"

#include <cmath>
#include <memory>
#include <stdexcept>

#include <Eigen/Geometry>
#include <cairo.h>
#include <fmt/format.h>

namespace feel {

namespace {

using Eigen::Vector3d;

constexpr int width = 1280, height = 560;
constexpr double margin = 40, mesh_width = 560;
constexpr double text_size = 12;

struct Color {
    double r, g, b;
};
constexpr Color ink{0.1, 0.1, 0.12}, path_color{0.82, 0.33, 0.0}, proxy_color{0.0, 0.35, 0.7},
    grey{0.6, 0.6, 0.6};

struct Canvas {
    std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface{
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy};
    std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cr{cairo_create(surface.get()), cairo_destroy};

    void color(const Color& c, double alpha = 1) { cairo_set_source_rgba(cr.get(), c.r, c.g, c.b, alpha); }
    void text(double x, double y, const std::string& what, const Color& c = ink) {
        color(c);
        cairo_move_to(cr.get(), x, y);
        cairo_show_text(cr.get(), what.c_str());
        cairo_new_path(cr.get());  // a text leaves a current point behind
    }
};

/// The view from above, from the front and slightly from the left; a larger z is nearer.
class Eye {
  public:
    explicit Eye(const Eigen::AlignedBox3d& box) : middle_(box.center()) {
        turn_ = Eigen::AngleAxisd(-M_PI / 2 + 0.45, Vector3d::UnitX()) *
                Eigen::AngleAxisd(0.6, Vector3d::UnitZ());
        scale_ = std::min(mesh_width - 2 * margin, height - 3 * margin) / box.diagonal().norm();
    }
    Vector3d operator()(const Vector3d& p) const {
        const Vector3d q = turn_ * (p - middle_);
        return {mesh_width / 2 + scale_ * q.x(), height / 2 - scale_ * q.y(), q.z()};
    }
    Vector3d direction(const Vector3d& v) const { return turn_ * v; }

  private:
    Vector3d middle_;
    Eigen::Matrix3d turn_;
    double scale_;
};

Vector3d vertex(const knurl::meshfile::MeshFile& file, std::uint32_t i, double metres) {
    return i < file.vertices.size() ? Vector3d(metres * Vector3d(file.vertices[i].data()))
                                    : Vector3d::Constant(NAN);
}

/// The farthest faces first, so that nearer ones are drawn over them.
void draw_mesh(Canvas& canvas, const knurl::meshfile::MeshFile& file, double metres, const Eye& eye) {
    struct Seen {
        Vector3d corner[3];
        double depth, light;
    };
    const Vector3d light = Vector3d(0.3, 0.5, 0.8).normalized();
    std::vector<Seen> seen;
    for (const knurl::Triangle& triangle : file.triangles) {
        Vector3d p[3];
        for (int i = 0; i < 3; ++i) p[i] = vertex(file, triangle[static_cast<std::size_t>(i)], metres);
        const Vector3d normal = eye.direction((p[1] - p[0]).cross(p[2] - p[0]));
        if (!(normal.norm() > 0) || !normal.allFinite()) continue;
        Seen one;
        for (int i = 0; i < 3; ++i) one.corner[i] = eye(p[i]);
        one.depth = one.corner[0].z() + one.corner[1].z() + one.corner[2].z();
        one.light = 0.45 + 0.5 * std::abs(normal.normalized().dot(light));
        seen.push_back(one);
    }
    std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.depth < b.depth; });
    cairo_t* cr = canvas.cr.get();
    cairo_set_line_width(cr, 0.4);
    for (const Seen& one : seen) {
        cairo_move_to(cr, one.corner[0].x(), one.corner[0].y());
        cairo_line_to(cr, one.corner[1].x(), one.corner[1].y());
        cairo_line_to(cr, one.corner[2].x(), one.corner[2].y());
        cairo_close_path(cr);
        canvas.color({0.93 * one.light, 0.92 * one.light, 0.88 * one.light});
        cairo_fill_preserve(cr);
        cairo_stroke(cr);  // closes gaps between neighbours
    }
}

void draw_paths(Canvas& canvas, const std::vector<Cycle>& cycles, const Eye& eye) {
    cairo_t* cr = canvas.cr.get();
    const auto line = [&](const Color& c, double alpha, double wide, auto point, auto wanted) {
        canvas.color(c, alpha);
        cairo_set_line_width(cr, wide);
        bool on = false;
        for (const Cycle& cycle : cycles) {
            const Vector3d at = eye(point(cycle));
            if (!wanted(cycle)) {
                on = false;
                continue;
            }
            on ? cairo_line_to(cr, at.x(), at.y()) : cairo_move_to(cr, at.x(), at.y());
            on = true;
        }
        cairo_stroke(cr);
    };
    const auto always = [](const Cycle&) { return true; };
    const auto touching = [](const Cycle& c) { return c.touching; };
    line(
        path_color, 0.55, 1, [](const Cycle& c) { return c.position; }, always);
    line(
        proxy_color, 0.9, 1.6, [](const Cycle& c) { return c.proxy; }, touching);
    // The force on the hand in every hundredth cycle.
    double most = 0;
    for (const Cycle& c : cycles) most = std::max(most, c.force.norm());
    cairo_set_line_width(cr, 0.8);
    canvas.color(ink, 0.5);
    for (std::size_t i = 0; i < cycles.size() && most > 0; i += 100) {
        const Vector3d from = eye(cycles[i].proxy), to = eye(cycles[i].proxy + 0.03 / most * cycles[i].force);
        cairo_move_to(cr, from.x(), from.y());
        cairo_line_to(cr, to.x(), to.y());
    }
    cairo_stroke(cr);
}

void draw_force(Canvas& canvas, const std::vector<Cycle>& cycles) {
    cairo_t* cr = canvas.cr.get();
    const double left = mesh_width + 60, right = width - margin, top = 70, bottom = height - 70;
    double most = 0.1;
    for (const Cycle& c : cycles) most = std::max({most, c.force.norm(), c.expected.norm()});
    const double begin = cycles.front().t, span = std::max(1e-3, cycles.back().t - begin);
    const auto at = [&](double t, double f) {
        return Eigen::Vector2d(left + (t - begin) / span * (right - left),
                               bottom - f / most * (bottom - top));
    };
    canvas.color(grey);
    cairo_set_line_width(cr, 1);
    cairo_rectangle(cr, left, top, right - left, bottom - top);
    cairo_stroke(cr);
    for (int i = 0; i <= 4; ++i) {
        canvas.text(left - 42, at(begin, most * i / 4).y() + 4, fmt::format("{:.2f}", most * i / 4));
        canvas.text(at(begin + span * i / 4, 0).x() - 8, bottom + 18, fmt::format("{:.1f}", span * i / 4));
    }
    canvas.text(left, top - 12, "force (N) over time (s):");
    canvas.text(left + 150, top - 12, "felt", path_color);
    canvas.text(left + 185, top - 12, "the same mesh at the same place, computed here", proxy_color);
    const auto line = [&](const Color& c, double wide, double alpha, auto value) {
        canvas.color(c, alpha);
        cairo_set_line_width(cr, wide);
        for (const Cycle& cycle : cycles) {
            const Eigen::Vector2d p = at(cycle.t, value(cycle));
            cairo_line_to(cr, p.x(), p.y());
        }
        cairo_stroke(cr);
    };
    line(path_color, 2.4, 0.8, [](const Cycle& c) { return c.force.norm(); });
    line(proxy_color, 0.8, 1, [](const Cycle& c) { return c.expected.norm(); });
}

}  // namespace

void draw(const std::string& path, const knurl::meshfile::MeshFile& file, double metres,
          const std::vector<Cycle>& cycles, const std::string& title, const std::string& machine) {
    Eigen::AlignedBox3d box;
    for (std::uint32_t i = 0; i < file.vertices.size(); ++i)
        if (const Vector3d p = vertex(file, i, metres); p.allFinite()) box.extend(p);
    Canvas canvas;
    cairo_t* cr = canvas.cr.get();
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_paint(cr);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, text_size);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    if (!box.isEmpty()) {
        const Eye eye(box);
        draw_mesh(canvas, file, metres, eye);
        draw_paths(canvas, cycles, eye);
    }
    canvas.text(margin, 24, title);
    canvas.text(margin, 44, "hand", path_color);
    canvas.text(margin + 40, 44, "proxy", proxy_color);
    canvas.text(margin + 85, 44, "force on the hand");
    if (!cycles.empty()) draw_force(canvas, cycles);
    canvas.text(margin, height - 16, machine, grey);
    if (cairo_surface_write_to_png(canvas.surface.get(), path.c_str()) != CAIRO_STATUS_SUCCESS)
        throw std::runtime_error(path + ": cannot be written; is its folder there?");
}

}  // namespace feel
