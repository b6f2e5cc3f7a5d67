// knurl-feel: a mesh from a file in the hand.

#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/client/address.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/measure/private_servo.hpp>
#include <knurl/measure/progress.hpp>
#include <knurl/measure/temporary_file.hpp>
#include <knurl/meshfile/mesh_file.hpp>
#include <knurl/meshfile/unit.hpp>

#include "feel.hpp"
#include "material.hpp"
#include "picture.hpp"
#include "stroke.hpp"

namespace {

using knurl::commandline::stop;

struct Options {
    std::vector<std::string> materials;
    std::string mesh, unit, connect = "knurl:default", picture, csv;
    bool demo = false, smooth = false, no_fit = false, inside = false;
    double scale = 1, wait = 2;
    double friction = 0;
    feel::FeelOptions feel;
    feel::StrokeOptions stroke;
};

void describe(knurl::commandline::Command& app, Options& w) {
    w.feel.shape.stiffness = 1000;
    app.option("MESH", w.mesh, "STL, OBJ, PLY, or what else Assimp reads").required();
    app.option("--unit", w.unit, "of the file: mm, cm, m, in, um; left out, it is guessed and said")
        .one_of({"mm", "cm", "m", "in", "um"});
    app.option("--scale", w.scale, "factor by which the mesh is scaled").shows_default().positive();
    app.option("--stiffness", w.feel.shape.stiffness, "N/m, or the device's k_max if that is less")
        .shows_default()
        .not_negative();
    app.option("--damping", w.feel.shape.damping, "N s/m").shows_default().not_negative();
    app.option("--friction", w.friction, "Coulomb coefficient").shows_default().within(0.0, 100.0);
    app.option("--material", w.materials,
               "a material of the file, with its shares of stiffness, damping and friction, 0 to 1 of the "
               "first; again for another")
        .type_name("NAME=SHARE[,SHARE[,SHARE]]");
    app.flag("--smooth", w.smooth, "the force along interpolated normals; contact stays the facets'");
    app.option("--radius", w.feel.radius, "m, of the finger").shows_default().within(0.0, 1.0);
    app.flag("--exact", w.feel.send.exact,
             "corners as double: half as much memory again, and exact to 1e-11 m");
    app.flag(
        "--inside", w.inside,
        "keeps a closed mesh that is wound inside out, so that it is felt from inside; else it is turned");
    app.flag("--no-fit", w.no_fit, "renders in true size, even beyond the device's workspace");
    app.option("--seconds", w.feel.seconds, "s to feel; 0: until Ctrl-C").shows_default().not_negative();
    app.servo(
           w.connect,
           "the servo that has the device; or knurl://HOST:PORT of a knurl-bridge (its key: KNURL_KEY=FILE)")
        .shows_default()
        .checked(knurl::check_address);
    app.option("--device", w.feel.device, "the servo's device; may be left out if it has one");
    app.option("--wait", w.wait, "s to wait for a servo that is still starting")
        .shows_default()
        .within(0.0, 3600.0);
    app.flag("--demo", w.demo,
             "a servo of its own with a simulated device, whose hand goes around the thing");
    app.option("--speed", w.stroke.speed, "m/s of that hand").shows_default().within(0.005, 1.0);
    app.option("--press", w.stroke.press, "m by which its path runs below the outline")
        .shows_default()
        .within(0.0, 0.05);
    app.option("--picture", w.picture, "PNG of mesh, path, proxy and force");
    app.option("--csv", w.csv, "FILE for every cycle");
    app.footer(
        "Examples:\n"
        "  knurl-feel part.stl --unit mm                    on the device of knurl:default\n"
        "  knurl-feel bunny.ply --demo --picture bunny.png  without a device\n");
}

std::vector<knurl::Point3> scaled(const knurl::meshfile::MeshFile& file, double scale) {
    std::vector<knurl::Point3> vertices = file.vertices;
    for (knurl::Point3& vertex : vertices)
        for (double& x : vertex) x *= scale;
    return vertices;
}

std::unique_ptr<knurl::Mesh> mesh_here(const knurl::meshfile::MeshFile& file,
                                       const knurl::SendOptions& send) {
    knurl::measure::Progress progress("knurl-feel");
    progress.show(fmt::format("builds the shape of {} triangles here", file.triangles.size()));
    const std::vector<knurl::Point3> vertices = scaled(file, send.scale);
    auto mesh = std::make_unique<knurl::Mesh>(
        knurl::Triangles{.vertices = vertices, .triangles = file.triangles, .materials = file.materials},
        knurl::MeshBuild{.exact = send.exact, .weld = send.weld});
    mesh->materials = send.materials;
    return mesh;
}

/// Notes what is rendered differently from the file, and says so.
void prepare(knurl::meshfile::MeshFile& file, const knurl::SendOptions& send, bool inside) {
    for (const std::string& line : file.notes) fmt::print("  {}\n", line);
    if (const auto middle = file.far_middle()) {
        for (knurl::Point3& vertex : file.vertices)
            for (std::size_t k = 0; k < 3; ++k) vertex[k] -= (*middle)[k];
        fmt::print(
            "  it lies far from its origin: places are counted from ({:.10g}, {:.10g}, {:.10g}) here\n",
            (*middle)[0], (*middle)[1], (*middle)[2]);
    }
    if (inside) return;
    std::vector<knurl::Point3> vertices = scaled(file, send.scale);
    const knurl::Mesh mesh({.vertices = vertices, .triangles = file.triangles},
                           {.weld = send.weld, .budget = SIZE_MAX, .find_crossings = false});
    if (const std::size_t turned = knurl::meshfile::turn_inside_out(file, mesh); turned > 0)
        fmt::print("  {} wound inside out and turned; --inside keeps {}\n",
                   turned == 1 ? "a closed part was" : fmt::format("{} closed parts were", turned),
                   turned == 1 ? "it so" : "them so");
}

/// `size` is that of the thing as it is felt (m).
void say_what_was_read(const knurl::meshfile::MeshFile& file, const knurl::meshfile::Unit& unit, double scale,
                       double size) {
    fmt::print("{}: {}, {} triangles, {} vertices\n", file.path, file.format, file.triangles.size(),
               file.vertices.size());
    fmt::print("  the box's diagonal is {:.4g} {}: {:.4g} m{}{}\n", file.size(), unit.name,
               unit.metres * file.size(),
               unit.guessed ? fmt::format("; the unit {} is a guess, --unit says another", unit.name) : "",
               scale != 1 ? fmt::format("; felt {:g} times as large, {:.4g} m", scale, size) : "");
    if (const auto odd = knurl::meshfile::odd_size(size)) fmt::print("  {}\n", *odd);
    if (file.material_names.size() > 1) fmt::print("  materials: {}\n", fmt::join(file.material_names, ", "));
}

/// Starts a servo with a simulated device whose hand goes around the thing, on the way that is written to
/// `stroke`. Makes the options fit them.
std::unique_ptr<knurl::measure::PrivateServo> start_demo(Options& w, const knurl::meshfile::MeshFile& file,
                                                         double size, const std::string& stroke) {
    // The premium15's workspace is about its origin. A larger thing is scaled down, for the hand's path as by
    // the claim.
    constexpr const char* device = "sim:premium15";
    constexpr double reach = 0.089;  // m: slightly less than the claim leaves of the device's own size
    const double fits = std::max(1.0, size / 2 / reach);
    w.feel.send.scale /= fits;
    if (fits > 1) fmt::print("  too large for the simulated device: felt at 1:{:.3g}\n", fits);
    const auto small = mesh_here(file, w.feel.send);
    const auto rows = feel::make_stroke(*small, w.stroke);
    feel::write_stroke(stroke, rows, -(small->low + small->high) / 2);
    if (!(w.feel.seconds > 0)) w.feel.seconds = rows.back().t;
    auto servo = std::make_unique<knurl::measure::PrivateServo>(
        std::vector<std::string>{"--device", device, "--hand", stroke});
    w.connect = servo->address();
    w.wait = 10;
    return servo;
}

void say_what_was_sent(const feel::FeelResult& result) {
    fmt::print("\n  the servo took {:.2f} s and holds {:.1f} MB for {} faces\n", result.send_seconds,
               static_cast<double>(result.sent.bytes) * 1e-6, result.sent.faces);
    for (const std::string& line : knurl::meshfile::notes_of(result.sent.notes)) fmt::print("  {}\n", line);
    if (result.scale > 1) fmt::print("  a metre of the device is {:.3g} m of the thing\n", result.scale);
    if (result.faults != 0)
        fmt::print("  the device faulted (mask {:#x}): see `knurl ls`, and clear it with `knurl reset`\n",
                   result.faults);
}

/// Compares the force with that of the same mesh in this process. False: the thing was never touched.
bool compare(const Options& w, const knurl::meshfile::MeshFile& file, feel::FeelResult& result) {
    feel::expect(result.cycles, *mesh_here(file, w.feel.send), result.stiffness, 1e9);
    const feel::Judgement judged = feel::judge(result.cycles);
    fmt::print("  {} cycles, {} of them touching; mean {:.2f} N, peak {:.2f} N, at {:.0f} N/m\n",
               judged.cycles, judged.touching, judged.mean_force, judged.peak_force, result.stiffness);
    if (judged.touching == 0) {
        fmt::print("  it was never touched: there is nothing to compare{}\n",
                   w.demo ? "; the simulated hand has missed it" : "");
        return false;
    }
    const bool comparable = w.feel.radius == 0 && w.friction == 0 && w.feel.shape.damping == 0 && !w.smooth;
    if (comparable)
        fmt::print(
            "  against the same mesh at the same places in this process: at most {:.2g} N off, {} contacts "
            "lost, "
            "{} jumps above 0.5 N ({} are the surface's own)\n",
            judged.worst_error, judged.lost, judged.jumps, judged.expected_jumps);
    return true;
}

void draw_picture(const Options& w, const knurl::meshfile::MeshFile& file, const feel::FeelResult& result) {
    const knurl::measure::Machine machine = knurl::measure::this_machine();
    const double scale = w.feel.send.scale;
    feel::draw(w.picture, file, scale, result.cycles,
               fmt::format("{}: {} triangles, {:.3g} m, felt at {:.0f} N/m", file.path, result.sent.faces,
                           scale * file.size(), result.stiffness),
               fmt::format("{}, Linux {}, {}", machine.processor, machine.kernel, machine.date));
    fmt::print("  {}\n", w.picture);
}

int run(Options& w) {
    if (!w.picture.empty()) knurl::measure::require_writable(w.picture);
    if (!w.csv.empty()) knurl::measure::require_writable(w.csv);
    knurl::meshfile::MeshFile file = knurl::meshfile::load_mesh(w.mesh);
    const knurl::meshfile::Unit unit =
        w.unit.empty() ? knurl::meshfile::guessed_unit(file.size()) : knurl::meshfile::unit_of(w.unit);
    knurl::SendOptions& send = w.feel.send;
    send.materials = feel::materials_of(file.material_names, w.materials);
    send.scale = unit.metres * w.scale;
    const double size = send.scale * file.size();
    say_what_was_read(file, unit, w.scale, size);
    prepare(file, send, w.inside);
    std::fflush(stdout);

    w.feel.shape.friction.dynamic = w.friction;
    w.feel.shape.shading = w.smooth ? knurl::Shading::smooth : knurl::Shading::flat;
    w.feel.fit = !w.no_fit;
    const knurl::measure::TemporaryFile path("knurl-feel");  // the way of the simulated hand
    std::unique_ptr<knurl::measure::PrivateServo> servo;
    if (w.demo) servo = start_demo(w, file, size, path.name);
    auto client = knurl::Client::connect(
        w.connect, {.name = "knurl-feel", .wait = std::chrono::milliseconds(static_cast<int>(w.wait * 1e3))});
    feel::FeelResult result = feel::feel(client, file, w.feel, stop, [](const std::string& line) {
        fmt::print("\r  {}", line);
        std::fflush(stdout);
    });
    if (result.sent.asset == 0) return 130;
    say_what_was_sent(result);
    const bool touched = compare(w, file, result);
    if (!w.csv.empty()) feel::write_csv(w.csv, result.cycles);
    if (!w.picture.empty()) draw_picture(w, file, result);
    // A person may come and go, but a demonstration without a touch has failed.
    return result.faults != 0 || (w.demo && !touched && !stop) ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    knurl::commandline::Command app("knurl-feel", "knurl-feel: a mesh from a file in the hand.");
    describe(app, options);
    app.action([&] {
        knurl::commandline::stop_on_signals();
        return run(options);
    });
    return knurl::commandline::run(app, argc, argv);
}
