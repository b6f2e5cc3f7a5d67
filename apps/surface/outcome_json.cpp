// The form that all measuring programs share: machine and results; beside it what only this program has.

#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "outcome.hpp"

namespace surface {
namespace {

using Json = nlohmann::ordered_json;

/// A percentile with fewer than 10 samples above it is null.
Json result(const std::string& name, const char* unit, const std::vector<double>& values) {
    const auto percentile = [&](double p) -> Json {
        if (static_cast<double>(values.size()) * (1 - p) < 10) return nullptr;
        return quantile(values, p);
    };
    return {{"name", name},
            {"unit", unit},
            {"n", values.size()},
            {"p50", percentile(0.5)},
            {"p99", percentile(0.99)},
            {"p999", percentile(0.999)},
            {"max", values.empty() ? Json(nullptr) : Json(quantile(values, 1))},
            {"reference", nullptr},
            {"ratio", nullptr}};
}

}  // namespace

void write_json(const std::filesystem::path& file, const std::vector<Outcome>& outcomes,
                const RunText& text) {
    const Machine& m = text.machine;
    Json json = {{"machine",
                  {{"processor", m.processor},
                   {"cpus", m.cpus},
                   {"kernel", m.kernel},
                   {"load", m.load},
                   {"idle", m.idle},
                   {"build", m.build},
                   {"date", m.date}}},
                 {"results", Json::array()},
                 {"run",
                  {{"model", text.model},
                   {"scale", text.scale},
                   {"device", text.device},
                   {"servo_rate", text.servo_rate},
                   {"application_rate", text.rate},
                   {"think", text.think}}},
                 {"strokes", Json::array()}};
    for (const Outcome& o : outcomes) {
        const std::string key = key_of(o.recording.way);
        std::vector<double> jumps, errors;
        const Ideal ideal{o.recording.stiffness, o.recording.greatest_force};
        for (std::size_t i = 1; i < o.judgement.cycles && i < o.recording.cycles.size(); ++i) {
            const Cycle& cycle = o.recording.cycles[i];
            if (cycle.number == o.recording.cycles[i - 1].number + 1)
                jumps.push_back((cycle.force - o.recording.cycles[i - 1].force).norm());
            errors.push_back((cycle.force - true_force(o.feet[i], ideal)).norm());
        }
        json["results"].push_back(result(key + ".age_at_use", "s", o.ages));
        json["results"].push_back(result(key + ".force_jump", "N", jumps));
        json["results"].push_back(result(key + ".force_error", "N", errors));
        const Judgement& j = o.judgement;
        json["strokes"].push_back({{"way", key},
                                   {"title", title_of(o.recording.way, text.rate)},
                                   {"verdict", j.verdict()},
                                   {"stable", j.stable()},
                                   {"interrupted", o.recording.interrupted},
                                   {"fault_at", j.fault_at ? Json(*j.fault_at) : Json(nullptr)},
                                   {"stiffness", o.recording.stiffness},
                                   {"max_stiffness", o.recording.max_stiffness},
                                   {"cycles", j.cycles},
                                   {"late", j.late},
                                   {"missed", j.missed},
                                   {"updates", o.recording.updates.size()},
                                   {"age_p50", quantile(o.ages, 0.5)},
                                   {"age_max", quantile(o.ages, 1)},
                                   {"jump", j.jump},
                                   {"jump_at", j.jump_at},
                                   {"jumps", j.jumps},
                                   {"force_error", j.force_error},
                                   {"mean_force", j.mean_force},
                                   {"kick", j.kick},
                                   {"kick_at", j.kick_at},
                                   {"limit_cycle", j.limit_cycle},
                                   {"contact_share", j.contact_share}});
    }
    std::ofstream out(file);
    out << json.dump(1) << '\n';
    out.close();
    if (!out)
        throw std::runtime_error(file.string() + ": cannot be written; check the folder and the space left");
}

}  // namespace surface
