#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <knurl/dds/command_desk.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::dds {

namespace {

using namespace std::chrono_literals;
using Time = std::chrono::steady_clock::time_point;

constexpr std::chrono::seconds say_again{10};
constexpr std::size_t most_lines = 256;
constexpr std::size_t most_lags = 256;
constexpr std::size_t longest_id = 64;

double seconds(std::int64_t ns) {
    return static_cast<double>(ns) * 1e-9;
}

std::int64_t real_time() {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

bool finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

/// What one peer holds.
struct CommandDesk::Hand {
    std::unique_ptr<gateway::PeerCommands> claim;
    std::string text;
    std::set<std::string> names;  // of its representations
    std::optional<Vec3> held;     // where it holds the hand
};

/// How long the messages of one peer take, by two clocks that need not agree: what counts is how much longer than the
/// shortest.
struct CommandDesk::Lag {
    std::int64_t shortest = 0;
    Time since{};              // of `shortest`
    std::optional<Time> late;  // since then all of them are
};

CommandDesk::CommandDesk(CommandOptions options) : options_(std::move(options)), enabled_(options_.enabled) {
    if (!options_.wall_clock) options_.wall_clock = real_time;
    if (!options_.make_hand)
        options_.make_hand = [](gateway::PeerOptions peer) {
            return std::make_unique<gateway::PeerHand>(std::move(peer));
        };
}

CommandDesk::~CommandDesk() = default;

void CommandDesk::say(const std::string& line) {
    const Time now = options_.clock();
    const auto found = said_.find(line);
    if (found != said_.end() && now - found->second < say_again) return;
    if (said_.size() >= most_lines) said_.clear();
    said_[line] = now;
    options_.log(line);
}

void CommandDesk::look(const Report& report) {
    report_ = report;
}

void CommandDesk::look_away() {
    report_.reset();
}

std::string_view CommandDesk::state() const {
    if (report_ && report_->state == DeviceState::fault) return "FAULT";
    if (paused_) return "PAUSED";
    if (!enabled_ || (report_ && report_->state == DeviceState::disconnected)) return "DISABLED";
    return "ENABLED";
}

bool CommandDesk::may_command(const Origin& from, std::string_view what) {
    if (from.id.empty()) return false;  // its writer has gone meanwhile
    const auto& allowed = options_.from;
    if (allowed.empty() || std::find(allowed.begin(), allowed.end(), from.host) != allowed.end()) return true;
    say(fmt::format("{}: {} is not from a host that may command '{}' ({}): ignored", what, from.text,
                    options_.device, fmt::join(allowed, ", ")));
    return false;
}

bool CommandDesk::fresh(const Origin& from, const Head& head, std::string_view what) {
    const Time now = options_.clock();
    const std::int64_t took = options_.wall_clock() - from.written_ns, most = options_.lifespan.count();
    if (lags_.size() >= most_lags && !lags_.contains(from.id)) lags_.clear();
    auto [found, is_new] = lags_.try_emplace(from.id, Lag{.shortest = took, .since = now, .late = {}});
    Lag& lag = found->second;
    // Two clocks drift apart by 50 us a second at most: the shortest of long ago says less and less.
    constexpr double drift = 1e-4;
    const double away = std::chrono::duration<double, std::nano>(now - lag.since).count() * drift;
    lag.shortest = std::min(took, lag.shortest + static_cast<std::int64_t>(away));
    lag.since = now;
    if (took - lag.shortest > most) {
        if (!lag.late) lag.late = now;
        if (now - *lag.late < 1s) {
            say(fmt::format("{} of {} came {:.0f} ms late: ignored", what, from.text,
                            seconds(took - lag.shortest) * 1e3));
            return false;
        }
        say(fmt::format("the clock of {} or of this host has been set back; its messages count again",
                        from.text));
        lag.shortest = took;
    }
    lag.late.reset();
    // By the sender's own clock.
    const std::int64_t age = from.written_ns - head.stamp_ns;
    if (head.stamp_ns != 0 && std::abs(age) > most) {
        say(
            fmt::format("{} of {}: header.stamp is {:.3g} s {} than its sending; stamp it when it is sent, "
                        "or leave 0: ignored",
                        what, from.text, seconds(std::abs(age)), age > 0 ? "older" : "later"));
        return false;
    }
    return true;
}

bool CommandDesk::in_frame(const Origin& from, const Head& head, const std::string& frame,
                           std::string_view what) {
    if (head.frame.empty() || head.frame == frame) return true;
    say(fmt::format("{} of {}: frame_id is '{}'; give '{}', or leave it empty: ignored", what, from.text,
                    words::printable(head.frame, 60), frame));
    return false;
}

bool CommandDesk::admit(const Origin& from, const Head& head, std::string_view what) {
    if (!may_command(from, what) || !fresh(from, head, what)) return false;
    if (enabled_ && !paused_) return true;
    say(fmt::format("{} of {}: the device '{}' is {}; send state_command '{}' first: ignored", what,
                    from.text, options_.device, paused_ ? "paused" : "disabled",
                    paused_ ? "resume" : "enable"));
    return false;
}

bool CommandDesk::take_lead(const Origin& from, std::string_view what) {
    const Time now = options_.clock();
    if (!leader_.empty() && leader_ != from.id && now < led_at_ + options_.hold_on) {
        say(fmt::format("{} of {}: '{}' is commanded by {}; one at a time: ignored", what, from.text,
                        options_.device, leader_text_));
        return false;
    }
    leader_ = from.id;
    leader_text_ = from.text;
    led_at_ = now;
    return true;
}

CommandDesk::Hand* CommandDesk::hand_of(const Origin& from) {
    if (const auto found = hands_.find(from.id); found != hands_.end()) return &found->second;
    if (hands_.size() >= most_peers) {
        say(fmt::format("{} peers command '{}' already; {} has to wait until one is gone", most_peers,
                        options_.device, from.text));
        return nullptr;
    }
    gateway::PeerOptions peer;
    peer.servo = options_.servo;
    peer.device = options_.device;
    peer.peer = "dds " + from.text;
    peer.lapse = options_.deadline;
    peer.clock = options_.clock;
    Hand& hand = hands_[from.id];
    hand.claim = options_.make_hand(std::move(peer));
    hand.text = from.text;
    return &hand;
}

void CommandDesk::refuse(const Origin& from, const std::string& why) {
    say(fmt::format("{}: {}: ignored", from.text, why));
}

void CommandDesk::force(const Origin& from, const Head& head, Vec3 force, Vec3 torque, bool body) {
    const std::string_view what = body ? "body/servo_cf" : "servo_cf";
    if (!admit(from, head, what) ||
        !in_frame(from, head, body ? options_.tip_frame : options_.base_frame, what))
        return;
    if (!finite(force) || !finite(torque))
        return refuse(from, fmt::format("{} is not a finite number", what));
    if (!take_lead(from, what)) return;
    Hand* hand = hand_of(from);
    if (hand == nullptr) return;
    if (body) {
        if (!report_) return;
        const Quat& q = report_->orientation;
        const Eigen::Quaterniond turn(q.w, q.x, q.y, q.z);
        force = to_plain(turn * to_eigen(force));
        torque = to_plain(turn * to_eigen(torque));
    }
    hand->held.reset();
    if (std::string refused = hand->claim->push(force, torque, what); !refused.empty())
        return refuse(from, refused);
    hand->claim->sent();
}

void CommandDesk::place(const Origin& from, const Head& head, const Vec3& position) {
    if (!admit(from, head, "servo_cp") || !in_frame(from, head, options_.base_frame, "servo_cp")) return;
    if (!finite(position)) return refuse(from, "servo_cp is not a finite number");
    if (!take_lead(from, "servo_cp")) return;
    Hand* hand = hand_of(from);
    if (hand == nullptr) return;
    hand->held.reset();
    if (std::string refused = hand->claim->pull(position, "servo_cp"); !refused.empty())
        return refuse(from, refused);
    hand->claim->sent();
}

void CommandDesk::hold(const Origin& from) {
    if (!admit(from, {}, "hold") || !take_lead(from, "hold") || !report_) return;
    Hand* hand = hand_of(from);
    if (hand == nullptr) return;
    hand->held = report_->position;
    if (std::string refused = hand->claim->pull(*hand->held, "hold"); !refused.empty())
        return refuse(from, refused);
    hand->claim->sent();
}

void CommandDesk::free(const Origin& from) {
    // Letting go is never too late, and needs no right to the device.
    const auto found = hands_.find(from.id);
    if (found == hands_.end()) return;
    found->second.held.reset();
    found->second.claim->push({}, {}, "free");
    found->second.claim->sent();
    if (leader_ == from.id) leader_.clear();
}

void CommandDesk::word(const Origin& from, std::string_view said) {
    if (!may_command(from, "state_command")) return;
    static const std::vector<std::string> words{"enable", "disable", "pause", "resume", "home", "unhome"};
    if (said == "enable" || said == "resume") {
        if (report_ && report_->state == DeviceState::fault)
            return refuse(
                from,
                fmt::format("state_command '{}': '{}' is in fault; reset it on its host (`knurl reset`)",
                            said, options_.device));
        enabled_ = enabled_ || said == "enable";
        paused_ = false;
    } else if (said == "disable" || said == "pause") {
        (said == "pause" ? paused_ : enabled_) = said == "pause";
        if (said == "disable") paused_ = false;
        hands_.clear();
        leader_.clear();
    } else if (said == "unhome") {
        refuse(from, "state_command 'unhome': what its servo has calibrated stays so");
    } else if (said != "home") {
        refuse(from, fmt::format("state_command '{}': {}", knurl::words::printable(said, 60),
                                 knurl::words::did_you_mean(
                                     said, words, "give enable, disable, pause, resume, home or unhome")));
    }
}

void CommandDesk::put(const Origin& from, const Head& head, const std::string& id, std::uint32_t probe,
                      Kind kind, const std::vector<std::byte>& params) {
    const std::string_view what = kinds()[kind].name;
    if (!admit(from, head, what) || !in_frame(from, head, options_.base_frame, what)) return;
    if (id.size() > longest_id)
        return refuse(from,
                      fmt::format("{}: its id has {} bytes; give at most {}", what, id.size(), longest_id));
    if (const Verdict verdict = kinds()[kind].validate(params.data()); !verdict) {
        const auto fields = kinds()[kind].fields;
        return refuse(
            from,
            fmt::format("{}{}{} = {:g} cannot be", what, verdict.field < fields.size() ? "." : "",
                        verdict.field < fields.size() ? fields[verdict.field].name : "", verdict.value));
    }
    Hand* hand = hand_of(from);
    if (hand == nullptr) return;
    const std::string name = fmt::format("{}:{}", what, knurl::words::printable(id, longest_id));
    std::string refused;
    if (hand->names.contains(name)) {
        refused = hand->claim->set(name, params);
    } else {
        refused = hand->claim->add(name, kind, params, {.probe = probe});
        if (refused.empty()) hand->names.insert(name);
    }
    if (!refused.empty()) return refuse(from, refused);
    hand->claim->sent();
}

void CommandDesk::remove(const Origin& from, const std::string& id) {
    const auto found = hands_.find(from.id);
    if (found == hands_.end()) return;
    Hand& hand = found->second;
    bool any = id.empty();
    if (id.empty()) {
        hand.claim->clear();
        hand.names.clear();
    }
    std::erase_if(hand.names, [&](const std::string& name) {
        if (name.substr(name.find(':') + 1) != id) return false;
        hand.claim->remove(name);
        any = true;
        return true;
    });
    if (!any)
        return refuse(from, fmt::format("remove: it has added nothing with the id '{}'",
                                        words::printable(id, longest_id)));
    hand.claim->sent();
}

void CommandDesk::gone(const std::string& id) {
    lags_.erase(id);
    if (leader_ == id) leader_.clear();
    const auto found = hands_.find(id);
    if (found == hands_.end()) return;
    say(fmt::format("{} has gone: what it commanded of '{}' fades", found->second.text, options_.device));
    hands_.erase(found);
}

std::vector<std::string> CommandDesk::peers() const {
    std::vector<std::string> all;
    for (const auto& [id, hand] : hands_) all.push_back(id);
    return all;
}

void CommandDesk::tick() {
    for (auto& [id, hand] : hands_) {
        if (hand.held) hand.claim->pull(*hand.held, "hold");
        if (hand.held || !hand.names.empty()) hand.claim->sent();
        if (hand.held && leader_ == id) led_at_ = options_.clock();
        for (const gateway::Said& said : hand.claim->said()) say(fmt::format("{}: {}", hand.text, said.text));
    }
}

}  // namespace knurl::dds
