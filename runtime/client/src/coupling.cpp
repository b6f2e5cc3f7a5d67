#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <knurl/client/coupling.hpp>

namespace knurl {

namespace {

using Eigen::Vector3d;

constexpr double forget = 0.97;       // share of the learnt values that is kept per frame
constexpr double thrifty = 0.8;       // share of the hand's force that the body gets when the reserve is
                                      // empty
constexpr double a_jump = 8;          // multiple of the body's usual deviation
constexpr double least_jump = 0.01;   // m at the hand
constexpr double short_way = 1e-4;    // m at the hand, imperceptible
constexpr double usual_force = 0.5;   // N at the hand, until it is measured
constexpr double all_gone = 0.02;     // N at the hand: a faded spring with less force counts as gone
constexpr std::uint64_t learnt = 10;  // frames until the usual values are known
constexpr double fade_in = 0.05;      // s in which a new spring becomes stiff

Vector3d at_most(const Vector3d& v, double length) {
    const double n = v.norm();
    return n > length ? Vector3d(length / n * v) : v;
}

void require(bool so, const char* what, double value, const char* rule) {
    if (!so)
        throw Error(Error::Kind::bad_parameters,
                    fmt::format("coupling: {} is {}, and must be {}", what, value, rule));
}

bool above_zero(double x) {
    return std::isfinite(x) && x > 0;
}

}  // namespace

Coupling::Coupling(const CouplingOptions& options)
    : options_(options), stiffness_(options.stiffness), frames_(options.interval, options.patience) {
    require(above_zero(options.scale.length), "scale.length", options.scale.length, "above 0 m");
    require(above_zero(options.scale.force), "scale.force", options.scale.force, "above 0 N");
    require(above_zero(options.stiffness), "stiffness", options.stiffness, "above 0 N/m");
    require(above_zero(options.interval), "interval", options.interval, "above 0 s");
    require(options.frames_late >= 0 && options.frames_late <= 2, "frames_late", options.frames_late,
            "0, 1 or 2");
    require(above_zero(options.greatest_force), "greatest_force", options.greatest_force, "above 0");
    require(above_zero(options.greatest_speed), "greatest_speed", options.greatest_speed, "above 0 m/s");
    require(above_zero(options.longest_move), "longest_move", options.longest_move, "above 0 s");
    require(above_zero(options.reserve), "reserve", options.reserve, "above 0 J");
    require(options.patience >= 2, "patience", options.patience, "2 intervals or more");
    require(above_zero(options.fade), "fade", options.fade, "above 0 s");
    require(above_zero(options.metre), "metre", options.metre, "above 0 m");
    require(above_zero(options.newton), "newton", options.newton, "above 0 N");
    options_.greatest_speed *= options.metre;
    options_.reserve *= options.metre * options.newton;
}

Vec3 Coupling::to_hand(const Vec3& body) const {
    return to_plain(hand_origin_ + options_.scale.length * (to_eigen(body) - body_origin_));
}

Vec3 Coupling::to_simulation(const Vec3& hand) const {
    return to_plain(body_origin_ + (to_eigen(hand) - hand_origin_) / options_.scale.length);
}

void Coupling::hold(const Vec3& body, const Vec3& hand) {
    hand_origin_ = to_eigen(hand);
    body_origin_ = to_eigen(body);
    // Pessimistic until it is measured: a frame's force moves the body the whole way.
    force_square_ = std::pow(options_.newton * usual_force, 2);
    force_way_ = force_square_ / options_.stiffness;
    compliance_ = 1 / options_.stiffness;
    stray_ = 0;
    held_frames_ = 0;
    superseded_ = 0;
    hand_ = hand_origin_;
    frames_.begin();
    // A new hold would cut off the force of the old one that still fades, which is a step. So it waits.
    if ((state_ == State::idle || state_ == State::stopped) && still_fades())
        state_ = State::stopped;
    else
        begin();
}

/// Checks the stiffness as sent and the force as rendered: a stiffness that is sent anew in each cycle is
/// cross-faded again and again.
bool Coupling::still_fades() const {
    return fading_ > 0 || force_.norm() > options_.newton * all_gone;
}

/// A spring without force follows the hand. Else it would become stiff with its end still on the way from the
/// last hold, since the servo moves the end and fades the stiffness in the same time.
void Coupling::park() {
    end_ = to_plain(hand_);
    moved_from_ = hand_;
    move_time_ = 0;
}

/// Starts here, with no energy in the spring. In the servo, its end is at the place sent last.
void Coupling::begin() {
    account_.lost = account_.hand - account_.body;
    account_.spring = 0;
    state_ = State::holding;
    fading_ = 1;
    felt_ = false;
    force_.setZero();
    body_.reset();
    for (Vector3d& force : sent_) force.setZero();
    moved_from_ = to_eigen(end_);
    end_ = to_plain(hand_);
    move_time_ = fade_in;
    begins_ = true;
}

void Coupling::let_go(double now) {
    if (state_ != State::idle && state_ != State::stopped) fade_from(now);
    state_ = State::idle;
}

void Coupling::fade_from(double now) {
    faded_from_ = now;
    account_.lost = account_.hand - account_.body;  // the energy in the spring is lost with it
    account_.spring = 0;
    for (Vector3d& force : sent_) force.setZero();
}

void Coupling::feel(const Report& report, const std::optional<HandFeedback>& feedback, const Vec3& attach) {
    const Vector3d here = to_eigen(report.position) + to_eigen(report.orientation) * to_eigen(attach);
    if (feedback && feedback->cycle != report.cycle) return;
    if (state_ == State::idle || state_ == State::stopped || !feedback) {
        hand_ = here;
        force_ = feedback ? Vector3d(feedback->share * to_eigen(feedback->force)) : Vector3d::Zero();
        felt_ = false;
        return;
    }
    const Vector3d force = feedback->share * to_eigen(feedback->force);
    if (feedback->share * feedback->stiffness > 0) stiffness_ = feedback->share * feedback->stiffness;
    if (felt_) {
        // The trapezium is exact for a spring: hand and end together change its energy by this amount.
        const double work = -0.5 * (force + force_).dot(here - hand_);
        account_.put_in(work);
    }
    felt_ = true;
    hand_ = here;
    force_ = force;
    account_.spring = force.squaredNorm() / (2 * stiffness_);
    account_.settle();
}

void Coupling::measure_compliance(const Vector3d& force, const Vector3d& way) {
    force_square_ = forget * force_square_ + force.squaredNorm();
    force_way_ = forget * force_way_ + force.dot(way);
    compliance_ = force_square_ > 0 ? std::max(0.0, force_way_ / force_square_) : 0;
    const double stray = (way - compliance_ * force).squaredNorm();
    stray_ = stray_ > 0 ? std::sqrt(forget * stray_ * stray_ + (1 - forget) * stray) : std::sqrt(stray);
}

/// Books the work of the force that acted on the way there. Nothing: the body is not held (any more).
std::optional<Vector3d> Coupling::moved_to(const Vec3& body) {
    const Vector3d place = to_eigen(to_hand(body));
    if (!place.allFinite())
        throw Error(Error::Kind::bad_parameters, "coupling: the body's place is no number");
    if (state_ == State::idle || (state_ == State::stopped && still_fades())) return {};
    if (state_ == State::stopped) begin();
    state_ = State::holding;
    ++counts_.frames;
    ++held_frames_;
    account_.created = -account_.left();
    if (body_) {
        const Vector3d way = place - *body_, &force = sent_[0];
        const bool jumped =
            held_frames_ > learnt &&
            (way - compliance_ * force).norm() > std::max(options_.metre * least_jump, a_jump * stray_);
        if (jumped) {
            ++counts_.jumps;
        } else {
            account_.body += force.dot(way);
            measure_compliance(force, way);
        }
    }
    body_ = place;
    // From here on the next force that was sent acts.
    for (std::size_t i = 0; i < static_cast<std::size_t>(options_.frames_late); ++i) sent_[i] = sent_[i + 1];
    return place;
}

void Coupling::superseded(const Vec3& body) {
    ++superseded_;
    moved_to(body);
}

Vec3 Coupling::frame(const Vec3& body, double now) {
    const bool held = state_ != State::idle;
    const std::optional<Vector3d> place = moved_to(body);
    if (held) frames_.frame(now, 1 + std::exchange(superseded_, 0));
    if (!place) return {};
    if (options_.keep_account) account_.keep(options_.reserve);
    account_.settle();
    move_end(*place, now);
    return to_plain(answer(*place) / options_.scale.force);
}

/// Moves the end no farther from the hand than the account covers.
void Coupling::move_end(const Vector3d& body, double now) {
    const double left = std::max(0.0, account_.hand - account_.body - account_.lost);
    Vector3d stretch = body - hand_;
    if (options_.keep_account) {
        const double reach = std::sqrt(2 * left / stiffness_);
        counts_.short_of += stretch.norm() > reach + options_.metre * short_way;
        stretch = at_most(stretch, reach);
    }
    const Vector3d end = hand_ + stretch;
    // The present place: from the force and, where the device is saturated, from the value sent.
    if (begins_) begun_at_ = moved_at_ = now;
    begins_ = false;
    const double share = move_time_ > 0 ? std::min(1.0, (now - moved_at_) / move_time_) : 1;
    const Vector3d sent = moved_from_ + share * (to_eigen(end_) - moved_from_);
    const double way = std::max((end - hand_ - force_ / stiffness_).norm(), (end - sent).norm());
    moved_from_ = sent;
    moved_at_ = now;
    end_ = to_plain(end);
    move_time_ = std::max({std::min(interval(), options_.longest_move), way / options_.greatest_speed,
                           begun_at_ + fade_in - now});
}

/// By the time this force acts, the body will have moved by the earlier ones, and it moves further while the
/// force acts. As in the implicit rule for spring and damper, the force is computed for the middle of its
/// time.
Vector3d Coupling::answer(const Vector3d& body) {
    const auto late = static_cast<std::size_t>(options_.frames_late);
    Vector3d there = body;
    double left = account_.hand - account_.body - account_.lost;
    for (std::size_t i = 0; i < late; ++i) {
        there += compliance_ * sent_[i];
        left -= compliance_ * sent_[i].squaredNorm();
    }
    Vector3d stretch = hand_ - there;
    if (options_.keep_account) stretch = at_most(stretch, std::sqrt(2 * std::max(0.0, left) / stiffness_));
    double share = 1;
    if (options_.keep_account) {
        // The body gets slightly less than the hand's force while the reserve is low; the difference fills
        // it.
        const double kept = left - stiffness_ * stretch.squaredNorm() / 2;
        share = thrifty + (1 - thrifty) * std::clamp(kept / options_.reserve, 0.0, 1.0);
    }
    Vector3d force = share * stiffness_ / (1 + stiffness_ * compliance_ / 2) * stretch;
    const double most = options_.greatest_force * options_.scale.force;
    counts_.bounded += force.norm() > most;
    force = at_most(force, most);
    sent_[late] = force;
    return force;
}

Coupling::State Coupling::watch(double now) {
    if (state_ == State::holding || state_ == State::late) {
        const FrameWatch::State frames = frames_.watch(now);
        state_ = frames == FrameWatch::State::on_time ? State::holding : State::late;
        if (frames == FrameWatch::State::stopped) {
            state_ = State::stopped;
            ++counts_.stops;
            fade_from(now);
        }
    }
    if (state_ == State::stopped || state_ == State::idle) {
        fading_ = std::clamp(1 - (now - faded_from_) / options_.fade, 0.0, fading_);
        if (!still_fades()) park();
    }
    return state_;
}

Spring Coupling::spring() const {
    Spring spring{.anchor = end_, .stiffness = options_.stiffness, .duration = move_time_};
    spring.stiffness *= fading_;
    return spring;
}

}  // namespace knurl
