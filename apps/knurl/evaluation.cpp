#include "evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/drivers/motion_device.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/reps/describe.hpp>
#include <knurl/servo/offline.hpp>

#include "scene_assets.hpp"

namespace knurl::cli {

namespace {

using scenefile::Change;
using scenefile::SceneFile;

/// The cycles i, at t = i/rate, that fall into the motion's span, both ends included.
struct CycleRange {
    std::int64_t first, last;
};

CycleRange cycles_within(const drivers::Motion& motion, double rate) {
    // s: an end that a decimal file states with rounding is included
    constexpr double rounding = 1e-9;
    const auto first = static_cast<std::int64_t>(std::ceil((motion.begin() - rounding) * rate));
    const auto last = static_cast<std::int64_t>(std::floor((motion.end() + rounding) * rate));
    if (last < first) {
        throw std::runtime_error(
            fmt::format("no cycle at {:g} Hz falls into the motion's span, {:g} to {:g} s; give a "
                        "longer motion or a higher --rate",
                        rate, motion.begin(), motion.end()));
    }
    return {first, last};
}

/// The subject of a message: "plane 'floor'", with the place in the file.
std::string called(const SceneFile& scene, const Change& change) {
    return fmt::format("{}:{}: {} '{}'", scene.path, change.line, kinds()[change.kind].name, change.id);
}

/// Plays a scene's changes into a claim, like an application: the adds and removals of a cycle as one group
/// of commands, the updates as one batch.
class Player {
  public:
    Player(const SceneFile& scene, servo::OfflineClaim& claim, bool limited)
        : scene_(scene), claim_(claim), limited_(limited), ids_(scene.items) {}

    /// Sends what takes effect in the cycle at `t`; `next_t` is the time of the following cycle.
    void send(bool first, double t, double next_t) {
        claim_.begin_group();
        if (first) place_probes();
        bool batch = false;
        for (; next_ < scene_.changes.size() && due(scene_.changes[next_], first, t); ++next_) {
            const Change& change = scene_.changes[next_];
            sent_.push_back(&change);
            switch (change.type) {
                case Change::Type::add:
                    add(change);
                    break;
                case Change::Type::update:
                    batch = update(change.item, change.kind, change.params) || batch;
                    break;
                case Change::Type::remove:
                    remove(change);
                    break;
            }
        }
        // A removal fades over the recovery in force. A removal with another recovery sends it one cycle
        // earlier, when it changes no force.
        for (std::size_t i = next_; i < scene_.changes.size() && due(scene_.changes[i], false, next_t); ++i) {
            const Change& change = scene_.changes[i];
            if (change.type != Change::Type::remove || ids_[change.item].generation == 0) continue;
            const auto params = with_recovery_of(change, params_[change.item]);
            if (params != params_[change.item]) batch = update(change.item, change.kind, params) || batch;
        }
        push_group(t);
        if (batch) claim_.commit();
    }

    /// Throws if the servo refused a change of this cycle. Notes each value that it applies differently.
    void check(std::vector<std::string>& remarks) {
        const auto replies = claim_.replies();
        answered_ += replies.size();
        if (answered_ < claim_.issued()) throw std::runtime_error(too_many_);
        for (const protocol::Reply& reply : replies) {
            const Verdict verdict = protocol::verdict_of(reply);
            if (!verdict) throw std::runtime_error(describe(verdict, reply.kind, refused_by()));
        }
        if (sent_.empty()) return;
        const auto& felt = claim_.feedback();
        if (felt.header.batches_refused > 0) {
            const Verdict verdict = protocol::verdict_of(felt.header);
            throw std::runtime_error(describe(verdict, felt.header.refused_kind, refused_by()));
        }
        for (const Change* change : sent_) {
            for (const auto& entry : felt.entries) {
                if (change->type == Change::Type::remove || !(entry.id == ids_[change->item])) continue;
                if ((entry.flags & Feedback::stiffness_clamped) != 0 &&
                    clamped_.insert(change->item).second) {
                    remarks.push_back(fmt::format("{}: {:.6g} N/m is applied; {}", called(scene_, *change),
                                                  entry.stiffness,
                                                  limited_ ? "stiffer is not stable on this device"
                                                           : "only a --device says how stiff infinity is"));
                }
                if ((entry.flags & Feedback::infeasible) != 0 && infeasible_.insert(change->item).second) {
                    remarks.push_back(
                        fmt::format("{}: contradicts other planes; no point is free of all of them",
                                    called(scene_, *change)));
                }
            }
        }
        sent_.clear();
    }

    /// Notes when the hand's budget scales forces, and which ones act then.
    void watch(double t) {
        const auto& felt = claim_.feedback();
        const HandScales scales = protocol::scales_of(felt.header);
        if (scales == HandScales{}) return;
        if (scaled_.empty()) scaled_since_ = t;
        least_ = {std::min(least_.contacts, scales.contacts), std::min(least_.effects, scales.effects),
                  std::min(least_.damping, scales.damping)};
        for (const auto& entry : felt.entries)
            if ((entry.flags & Feedback::touching) != 0) scaled_.insert(entry.id.slot);
    }

    /// One line if it did: how much of which limit, and which parts together are the reason.
    void add_scaled(std::vector<std::string>& remarks, const Limits& limits) const {
        if (least_ == HandScales{}) return;
        std::string text, parts;
        const auto add = [&text](double scale, const char* what) {
            if (scale < 1) text += fmt::format("{}{} to {:.3g}", text.empty() ? "" : ", ", what, scale);
        };
        add(least_.contacts, "the forces of surfaces");
        add(least_.effects, "those of effects");
        add(least_.damping, "what velocity adds");
        constexpr int most = 8;
        int named = 0;
        for (const Change& change : scene_.changes) {
            if (change.type != Change::Type::add || !scaled_.contains(ids_[change.item].slot)) continue;
            if (ids_[change.item].generation == 0 || ++named > most) continue;
            parts +=
                fmt::format("{}{} '{}'", parts.empty() ? "" : ", ", kinds()[change.kind].name, change.id);
        }
        if (named > most) parts += fmt::format(" and {} more", named - most);
        remarks.push_back(
            fmt::format("{}: from {:.3f} s on the hand would feel more at once than {:.6g} N/m, or be more "
                        "damped, than is stable on "
                        "this device: scaled down at times: {}; felt then: {}",
                        scene_.path, scaled_since_, limits.max_stiffness, text, parts));
    }

  private:
    /// Entries at 0 s or before the motion are there from the start, wherever it begins.
    static bool due(const Change& change, bool first, double t) {
        return change.at <= t || (first && change.at <= 0);
    }

    std::string refused_by() const {
        return fmt::format("{}:{}", scene_.path, sent_.empty() ? 1 : sent_.front()->line);
    }

    void push_group(double t) {
        too_many_ =
            fmt::format("{}: {} changes at {:g} s are more than one cycle can take; spread them over several",
                        refused_by(), sent_.size(), t);
        try {
            claim_.end_group();
        } catch (const std::runtime_error&) {  // the command ring is full
            throw std::runtime_error(too_many_);
        }
    }

    void place_probes() {
        for (std::uint32_t i = 0; i < scene_.probes.size(); ++i) claim_.place_probe(i, scene_.probes[i]);
    }

    void add(const Change& change) {
        RepresentationId& id = ids_[change.item];
        if (!free_slots_.empty()) {
            id = free_slots_.back();
            free_slots_.pop_back();
            ++id.generation;
        } else if (slots_ < Scene::max_representations) {
            id = {slots_++, 1};
        } else {
            throw std::runtime_error(
                fmt::format("{}: more than {} representations at once; remove some before",
                            called(scene_, change), Scene::max_representations));
        }
        claim_.add(id, change.kind, change.params.data(), change.params.size(), change.options);
        params_[change.item] = change.params;
    }

    bool update(std::uint32_t item, Kind kind, const std::vector<std::byte>& params) {
        claim_.update(ids_[item], kind, params.data(), params.size());
        params_[item] = params;
        return true;
    }

    /// `params` with the change's values for the fields that describe a change.
    static std::vector<std::byte> with_recovery_of(const Change& change, std::vector<std::byte> params) {
        for (const Field& field : kinds()[change.kind].fields) {
            if (!field.of_change) continue;
            std::memcpy(params.data() + field.offset, change.params.data() + field.offset, field.bytes());
        }
        return params;
    }

    void remove(const Change& change) {
        claim_.remove(ids_[change.item]);
        free_slots_.push_back(ids_[change.item]);
        ids_[change.item] = {};
    }

    const SceneFile& scene_;
    servo::OfflineClaim& claim_;
    const bool limited_;                        // by a device's limits
    std::vector<RepresentationId> ids_;         // per item; generation 0: not present
    std::vector<RepresentationId> free_slots_;  // in order of last use
    // in force
    std::vector<std::vector<std::byte>> params_ = std::vector<std::vector<std::byte>>(scene_.items);
    std::vector<const Change*> sent_;               // for this cycle
    std::set<std::uint32_t> clamped_, infeasible_;  // items with a remark already
    std::set<std::uint32_t> scaled_;                // slots that acted while the budget scaled
    HandScales least_;
    double scaled_since_ = 0;     // s
    std::size_t next_ = 0;        // index of the next change
    std::uint32_t slots_ = 0;     // ever used
    std::uint64_t answered_ = 0;  // commands
    std::string too_many_;        // the message if this cycle's changes do not fit
};

servo::ClaimTerms terms_for(const SceneFile& scene, const drivers::Device& device, bool limited,
                            double rate) {
    servo::ClaimTerms terms;  // the frame is the world's: scale 1, centre 0
    terms.capacity.representations = std::clamp(scene.items, 1u, Scene::max_representations);
    terms.capacity.batch_bytes = protocol::max_batch_bytes;
    terms.limits.period = 1 / rate;
    if (limited) terms.limits = servo::limits_for(device.link(), rate, terms.frame);
    return terms;
}

EvaluatedCycle cycle_of(double t, const Report& report, const ProbePlacement& probe0) {
    EvaluatedCycle cycle{.t = t,
                         .position = report.position,
                         .force = report.scene_force,
                         .torque = report.scene_torque,
                         .contact_point = report.contact_point};
    // Without contact a report has the hand's place, and a probe may be placed beside it.
    if ((report.flags & report_flags::touching) == 0 && !(probe0.offset == Vec3{})) {
        cycle.contact_point =
            to_plain(to_eigen(report.position) + to_eigen(report.orientation) * to_eigen(probe0.offset));
    }
    return cycle;
}

std::unique_ptr<drivers::Device> simulated(const EvaluationOptions& options) {
    if (!options.device.starts_with("sim:")) {
        throw std::runtime_error("--device " + options.device +
                                 ": only a simulated device can be evaluated offline; "
                                 "give sim:PROFILE, for instance sim:premium15");
    }
    return drivers::open_device(options.device, {.hand_file = options.motion_file});
}

}  // namespace

Evaluation evaluate(const SceneFile& scene, const drivers::Motion& motion, const EvaluationOptions& options) {
    const CycleRange cycles = cycles_within(motion, options.rate);
    const bool limited = !options.device.empty();
    SceneAssets built = build_assets(scene);
    drivers::MotionDevice exact(motion);
    const std::unique_ptr<drivers::Device> simulation = limited ? simulated(options) : nullptr;
    drivers::Device& device = limited ? *simulation : exact;

    auto servo_options = servo::offline_options(options.rate);
    servo_options.supervisor.off = !limited;
    servo::Offline servo(device, servo_options);
    servo::OfflineClaim& claim = servo.claim(terms_for(scene, device, limited, options.rate));
    for (std::uint32_t i = 0; i < built.assets.size(); ++i)
        servo.servo().give(&claim.servo_side(), i + 1, built.assets[i].get());
    Player player(scene, claim, limited);

    const ProbePlacement probe0 = scene.probes.empty() ? ProbePlacement{} : scene.probes.front();

    Evaluation result;
    result.remarks = scene.remarks;
    result.remarks.insert(result.remarks.end(), built.remarks.begin(), built.remarks.end());
    result.cycles.reserve(static_cast<std::size_t>(cycles.last - cycles.first + 1));
    for (std::int64_t i = cycles.first; i <= cycles.last; ++i) {
        const double t = static_cast<double>(i) / options.rate;
        // An end beyond the motion by rounding is the motion's end: beyond it a motion rests.
        exact.at(std::clamp(t, motion.begin(), motion.end()));
        player.send(i == cycles.first, t, static_cast<double>(i + 1) / options.rate);
        const Report& report = servo.step();
        player.check(result.remarks);
        if (limited) player.watch(t);
        result.cycles.push_back(cycle_of(t, report, probe0));
    }
    if (limited) player.add_scaled(result.remarks, servo::limits_for(device.link(), options.rate, {}));
    return result;
}

}  // namespace knurl::cli
