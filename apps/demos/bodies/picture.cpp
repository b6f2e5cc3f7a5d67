#include "picture.hpp"

#include <memory>
#include <stdexcept>

#include <cairo.h>
#include <fmt/format.h>

#include <knurl/measure/output_file.hpp>

namespace bodies {

namespace {

constexpr int width = 1280, height = 760;
constexpr double margin = 50, scene_bottom = 430, plot_top = 490;

struct Color {
    double r, g, b;
};
constexpr Color ink{0.1, 0.1, 0.12}, grey{0.6, 0.6, 0.6}, hand_color{0.82, 0.33, 0.0};
constexpr Color colors[] = {{0.0, 0.35, 0.7}, {0.1, 0.55, 0.2}, {0.55, 0.2, 0.6}, {0.7, 0.6, 0.0}};

struct Canvas {
    std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface{
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy};
    std::unique_ptr<cairo_t, decltype(&cairo_destroy)> owner{cairo_create(surface.get()), cairo_destroy};
    cairo_t* cr = owner.get();

    void color(const Color& c, double alpha = 1) { cairo_set_source_rgba(cr, c.r, c.g, c.b, alpha); }
    void text(double x, double y, const std::string& what, const Color& c = ink) {
        color(c);
        cairo_move_to(cr, x, y);
        cairo_show_text(cr, what.c_str());
        cairo_new_path(cr);
    }
};

void draw_scene(Canvas& canvas, const World& world, const Played& played) {
    cairo_t* cr = canvas.cr;
    const double scale = (width - 2 * margin) / (2 * world.tray().reach);
    const auto at = [&](double x, double z) {
        return std::pair(width / 2.0 + scale * x, scene_bottom - scale * (z - world.tray().floor));
    };
    canvas.color(grey);
    cairo_move_to(cr, margin, scene_bottom);
    cairo_line_to(cr, width - margin, scene_bottom);
    cairo_stroke(cr);
    const auto body = [&](std::size_t i, const Pose& pose, double alpha) {
        const Body& of = world.bodies()[i];
        canvas.color(colors[i % std::size(colors)], alpha);
        const auto [x, z] = at(pose.position.x(), pose.position.z());
        if (of.form == Body::Form::ball) {
            cairo_arc(cr, x, z, scale * of.half.x(), 0, 2 * M_PI);
        } else {  // upright as at the start, or as the outline of its box
            const Vector3d half = pose.orientation.toRotationMatrix().cwiseAbs() * of.half;
            cairo_rectangle(cr, x - scale * half.x(), z - scale * half.z(), 2 * scale * half.x(),
                            2 * scale * half.z());
        }
        cairo_fill(cr);
    };
    for (std::size_t i = 0; i < world.bodies().size(); ++i) {
        body(i, {.position = world.bodies()[i].position}, 0.12);
        body(i, world.after(i), 0.45);
        canvas.color(colors[i % std::size(colors)]);
        for (const Played::Frame& frame : played.frames) {
            const auto [x, z] = at(frame.bodies[i].x(), frame.bodies[i].z());
            cairo_line_to(cr, x, z);
        }
        cairo_stroke(cr);
        canvas.text(margin + 70 * static_cast<double>(i + 1), 44, world.bodies()[i].name,
                    colors[i % std::size(colors)]);
    }
    canvas.color(hand_color, 0.7);
    for (const Played::Cycle& cycle : played.cycles) {
        const auto [x, z] = at(cycle.hand.x(), cycle.hand.z());
        cairo_line_to(cr, x, z);
    }
    cairo_stroke(cr);
    canvas.text(margin, 44, "hand", hand_color);
}

void draw_force(Canvas& canvas, const Played& played) {
    cairo_t* cr = canvas.cr;
    double most = 0.1;
    for (const auto& cycle : played.cycles) most = std::max(most, cycle.force.norm());
    const double bottom = height - 60, span = std::max(1e-3, played.cycles.back().t);
    canvas.color(grey);
    cairo_rectangle(cr, margin, plot_top, width - 2 * margin, bottom - plot_top);
    cairo_stroke(cr);
    for (int i = 0; i <= 4; ++i) {
        canvas.text(12, bottom - (bottom - plot_top) * i / 4 + 4, fmt::format("{:.2f}", most * i / 4));
        canvas.text(margin + (width - 2 * margin) * i / 4 - 8, bottom + 18,
                    fmt::format("{:.1f}", span * i / 4));
    }
    canvas.text(margin, plot_top - 10, "force on the hand (N) over time (s)");
    canvas.color(hand_color);
    for (const auto& cycle : played.cycles)
        cairo_line_to(cr, margin + cycle.t / span * (width - 2 * margin),
                      bottom - cycle.force.norm() / most * (bottom - plot_top));
    cairo_stroke(cr);
}

}  // namespace

void draw(const std::string& path, const World& world, const Played& played, const std::string& title,
          const std::string& machine) {
    Canvas canvas;
    cairo_set_source_rgb(canvas.cr, 1, 1, 1);
    cairo_paint(canvas.cr);
    cairo_select_font_face(canvas.cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(canvas.cr, 12);
    cairo_set_line_width(canvas.cr, 1);
    canvas.text(margin, 24, title);
    draw_scene(canvas, world, played);
    if (!played.cycles.empty()) draw_force(canvas, played);
    canvas.text(margin, height - 16, machine, grey);
    if (cairo_surface_write_to_png(canvas.surface.get(), path.c_str()) != CAIRO_STATUS_SUCCESS)
        throw std::runtime_error(path + ": cannot be written; is its folder there?");
}

void write_csv(const std::string& path, const World& world, const Played& played) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "t,x,y,z,fx,fy,fz");
    for (const Body& body : world.bodies()) fmt::format_to(out, ",{0}_x,{0}_y,{0}_z", body.name);
    std::size_t frame = 0;
    for (const auto& cycle : played.cycles) {
        while (frame + 1 < played.frames.size() && played.frames[frame + 1].t <= cycle.t) ++frame;
        fmt::format_to(out, "\n{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", cycle.t, cycle.hand.x(),
                       cycle.hand.y(), cycle.hand.z(), cycle.force.x(), cycle.force.y(), cycle.force.z());
        if (!played.frames.empty())
            for (const Vector3d& at : played.frames[frame].bodies)
                fmt::format_to(out, ",{:.9g},{:.9g},{:.9g}", at.x(), at.y(), at.z());
    }
    text.push_back('\n');
    knurl::measure::write_file(path, fmt::to_string(text));
}

}  // namespace bodies
