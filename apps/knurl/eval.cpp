// knurl eval: the forces of a scene along a motion, without a servo, at once.

#include <cstdio>
#include <cstring>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include <knurl/measure/output_file.hpp>

#include "evaluation.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

struct EvalArguments {
    std::string scene, motion, out;
    EvaluationOptions options;
};

void append(fmt::memory_buffer& text, double value, char end) {
    // 17 digits reproduce every double exactly. Adding zero turns -0 into 0.
    fmt::format_to(std::back_inserter(text), "{:.17g}{}", value + 0.0, end);
}

void append(fmt::memory_buffer& text, const Vec3& v, char end) {
    append(text, v.x, ',');
    append(text, v.y, ',');
    append(text, v.z, end);
}

std::string csv_of(const std::vector<EvaluatedCycle>& cycles) {
    fmt::memory_buffer text;
    fmt::format_to(std::back_inserter(text), "t,x,y,z,fx,fy,fz,tx,ty,tz,px,py,pz\n");
    for (const auto& cycle : cycles) {
        append(text, cycle.t, ',');
        append(text, cycle.position, ',');
        append(text, cycle.force, ',');
        append(text, cycle.torque, ',');
        append(text, cycle.contact_point, '\n');
    }
    return fmt::to_string(text);
}

constexpr double lowest_rate = 500, highest_rate = 20'000;  // Hz, as for a servo

int run_eval(const EvalArguments& arguments) {
    if (!(arguments.options.rate >= lowest_rate && arguments.options.rate <= highest_rate)) {
        throw UsageError(fmt::format("--rate is {:g} Hz; give {:g} to {:g} Hz", arguments.options.rate,
                                     lowest_rate, highest_rate));
    }
    const auto scene = scenefile::read_scene(arguments.scene);
    const auto motion = drivers::load_motion(arguments.motion);
    const Evaluation evaluation = evaluate(scene, motion, arguments.options);
    measure::write_file(arguments.out, csv_of(evaluation.cycles));
    if (const auto doubt = drivers::unit_doubt(motion))
        fmt::print(stderr, "knurl eval: {}: {}\n", arguments.motion, *doubt);
    for (const auto& remark : evaluation.remarks) fmt::print(stderr, "knurl eval: {}\n", remark);
    return 0;
}

}  // namespace

void add_eval(commandline::Command& program) {
    auto& verb =
        program.verb("eval", "Forces of a scene along a motion, offline, through the servo's own cycle");
    auto arguments = std::make_shared<EvalArguments>();
    verb.option("--scene", arguments->scene, "scene: one [[table]] per representation")
        .required()
        .type_name("S.toml");
    verb.option("--motion", arguments->motion, "motion: t,x,y,z[,qw,qx,qy,qz] in s and m")
        .required()
        .type_name("M.csv");
    verb.option("--out", arguments->out, "result: t,x,y,z,fx,fy,fz,tx,ty,tz,px,py,pz; - is standard output")
        .required()
        .type_name("F.csv");
    verb.option("--rate", arguments->options.rate, "cycles per second").type_name("HZ").shows_default();
    verb.option("--device", arguments->options.device,
                "the motion is where the hand on this simulated device wants to go; its limits apply")
        .type_name("sim:PROFILE");
    verb.footer(
        "One row per cycle, t = i/rate, over the motion's span. Force and torque are the scene's, before "
        "the\n"
        "supervisor, torque about (x,y,z); p is the contact point of probe 0, else the probe. Without "
        "--device the\n"
        "probe is exactly on the motion (linear, slerp; the velocity is that of the segment that begins "
        "there).");
    verb.action([arguments] {
        arguments->options.motion_file = arguments->motion;
        return run_eval(*arguments);
    });
}

}  // namespace knurl::cli
