#include "picture.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <cairo.h>
#include <fmt/format.h>

namespace dock {

namespace {

constexpr int width = 1200, height = 900;
constexpr double left = 80, right = width - 30, top = 50, bottom = height - 50, gap = 44;

struct Color {
    double r, g, b;
};
constexpr Color ink{0.1, 0.1, 0.12}, hand_color{0.82, 0.33, 0.0}, atom_color{0.0, 0.35, 0.7},
    grey{0.6, 0.6, 0.6}, third{0.2, 0.5, 0.2};

struct Point {
    double t, value;
};
struct Curve {
    std::string name;
    Color color;
    std::vector<Point> points;
};

class Sheet {
  public:
    Sheet(double begin, double end) : begin_(begin), end_(std::max(end, begin + 1e-3)) {
        cairo_t* cr = cr_.get();
        cairo_set_source_rgb(cr, 1, 1, 1);
        cairo_paint(cr);
        cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
        cairo_set_font_size(cr, 12);
        cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    }

    double text(double x, double y, const std::string& what, const Color& color = ink) {
        cairo_t* cr = cr_.get();
        cairo_set_source_rgb(cr, color.r, color.g, color.b);
        cairo_move_to(cr, x, y);
        cairo_show_text(cr, what.c_str());
        cairo_new_path(cr);
        cairo_text_extents_t size;
        cairo_text_extents(cr, what.c_str(), &size);
        return x + size.x_advance;
    }

    void panel(int place, int of, const std::string& name, const std::vector<Curve>& curves) {
        const double tall = (bottom - top - gap * (of - 1)) / of, high = top + place * (tall + gap),
                     low = high + tall;
        double least = 0, most = 1e-6;
        for (const Curve& curve : curves)
            for (const Point& point : curve.points)
                least = std::min(least, point.value), most = std::max(most, point.value);
        const auto x = [&](double t) { return left + (t - begin_) / (end_ - begin_) * (right - left); };
        const auto y = [&](double value) { return low - (value - least) / (most - least) * tall; };
        cairo_t* cr = cr_.get();
        cairo_set_source_rgb(cr, grey.r, grey.g, grey.b);
        cairo_set_line_width(cr, 1);
        cairo_rectangle(cr, left, high, right - left, tall);
        cairo_stroke(cr);
        for (int i = 0; i <= 4; ++i) {
            const double value = least + (most - least) * i / 4, t = begin_ + (end_ - begin_) * i / 4;
            text(18, y(value) + 4, fmt::format("{:.3g}", value));
            text(x(t) - 8, low + 16, fmt::format("{:.3g}", t));
        }
        double at = text(left, high - 8, name + "  ");
        for (const Curve& curve : curves) {
            at = text(at, high - 8, curve.name + "  ", curve.color);
            cairo_set_source_rgba(cr, curve.color.r, curve.color.g, curve.color.b, 0.85);
            cairo_set_line_width(cr, 1.2);
            // A column of pixels has many cycles: their minimum and maximum are drawn.
            double column = -1, low_value = 0, high_value = 0;
            const auto flush = [&] {
                if (column < 0) return;
                cairo_line_to(cr, column, y(low_value));
                cairo_line_to(cr, column, y(high_value));
            };
            for (const Point& point : curve.points) {
                const double here = std::floor(x(point.t));
                if (here != column) {
                    flush();
                    column = here;
                    low_value = high_value = point.value;
                }
                low_value = std::min(low_value, point.value);
                high_value = std::max(high_value, point.value);
            }
            flush();
            cairo_stroke(cr);
        }
    }

    void save(const std::string& path) {
        if (cairo_surface_write_to_png(surface_.get(), path.c_str()) != CAIRO_STATUS_SUCCESS)
            throw std::runtime_error(path + ": cannot be written; is its folder there?");
    }

  private:
    std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_{
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy};
    std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cr_{cairo_create(surface_.get()), cairo_destroy};
    double begin_, end_;
};

}  // namespace

void draw(const std::string& path, const Docked& docked, const DockOptions& options, const std::string& title,
          const std::string& machine) {
    Sheet sheet(docked.cycles.empty() ? 0 : docked.cycles.front().t,
                docked.cycles.empty() ? 1 : docked.cycles.back().t);
    const double nm = 1e3 / options.scale;  // of a metre in the hand
    const double kj = docked.energy_scale * 4.184;
    Curve force{"on the hand", hand_color, {}}, push{"on the atom, by the scale", atom_color, {}};
    Curve law{"hand to atom", hand_color, {}}, spring{"of the spring", third, {}};
    Curve hand{"the hand's", hand_color, {}}, atom{"the atom's", atom_color, {}};
    const Cycle* first = nullptr;
    const double to_newton = scale_of(options).force;
    for (const Cycle& c : docked.cycles) {
        force.points.push_back({c.t, c.force.norm()});
        push.points.push_back({c.t, c.atom_force.norm() * to_newton});
        if (c.frame == 0) continue;
        if (first == nullptr) first = &c;
        law.points.push_back({c.t, (c.atom - c.hand).norm() * 1e3});
        spring.points.push_back({c.t, c.force.norm() / options.stiffness * 1e3});
        hand.points.push_back({c.t, (c.hand - first->atom).x() * nm});
        atom.points.push_back({c.t, (c.atom - first->atom).x() * nm});
    }
    Curve in{"put in by the hand", hand_color, {}}, body{"given to the atom", atom_color, {}},
        total{"total energy, as the simulation says (kJ/mol from GROMACS)", third, {}};
    for (const FrameSeen& f : docked.frames) {
        in.points.push_back({f.t, f.account.hand * kj});
        body.points.push_back({f.t, f.account.body * kj});
        if (f.step >= 0) total.points.push_back({f.t, f.total_energy - docked.frames.front().total_energy});
    }
    sheet.text(left, 22, title);
    sheet.panel(0, 4, "force (N):", {push, force});
    sheet.panel(1, 4, "length (mm):", {law, spring});
    sheet.panel(2, 4, "displacement along x (nm):", {hand, atom});
    sheet.panel(3, 4, "energy (kJ/mol):", {total, in, body});
    sheet.text(left, height - 12, machine + "; time in s", grey);
    sheet.save(path);
}

}  // namespace dock
