// The form of all measuring programs: machine and results, plus what only this program has.

#include <knurl/json/json.hpp>
#include <knurl/measure/output_file.hpp>

#include "outcome.hpp"

namespace surface {
namespace {

using knurl::Json;

}  // namespace

void write_json(const std::filesystem::path& file, const std::vector<Outcome>& outcomes,
                const RunText& text) {
    knurl::measure::Run measured{.machine = text.machine, .results = {}};
    Json strokes = Json::array();
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
        measured.results.push_back(knurl::measure::summarise(key + ".age_at_use", "s", o.ages));
        measured.results.push_back(knurl::measure::summarise(key + ".force_jump", "N", jumps));
        measured.results.push_back(knurl::measure::summarise(key + ".force_error", "N", errors));
        const Judgement& j = o.judgement;
        strokes.push_back({{"way", key},
                           {"title", title_of(o.recording.way, text.rate)},
                           {"verdict", j.verdict()},
                           {"stable", j.stable() ? Json(*j.stable()) : Json(nullptr)},
                           {"interrupted", o.recording.interrupted},
                           {"fault_at_s", j.fault_at ? Json(*j.fault_at) : Json(nullptr)},
                           {"stiffness", o.recording.stiffness},
                           {"max_stiffness", o.recording.max_stiffness},
                           {"cycles", j.cycles},
                           {"late", j.late},
                           {"stalls", j.stalls},
                           {"missed", j.missed},
                           {"updates", o.recording.updates.size()},
                           {"age_p50_s", quantile(o.ages, 0.5)},
                           {"age_max_s", quantile(o.ages, 1)},
                           {"jump", j.jump},
                           {"jump_at_s", j.jump_at},
                           {"jumps", j.jumps},
                           {"force_error", j.force_error},
                           {"own_force_error", j.own_force_error ? Json(*j.own_force_error) : Json(nullptr)},
                           {"mean_force", j.mean_force},
                           {"kick", j.kick},
                           {"kick_at_s", j.kick_at},
                           {"limit_cycle", j.limit_cycle ? Json(*j.limit_cycle) : Json(nullptr)},
                           {"contact_share", j.contact_share},
                           {"contact_s", j.contact},
                           {"travel_m", j.travel}});
    }
    Json json = Json::parse(knurl::measure::to_json(measured));
    json["run"] = {{"model", text.model},           {"scale", text.scale},           {"device", text.device},
                   {"servo_rate", text.servo_rate}, {"application_rate", text.rate}, {"think_s", text.think}};
    json["strokes"] = std::move(strokes);
    knurl::measure::write_file(file, json.dump(1) + '\n');
}

}  // namespace surface
