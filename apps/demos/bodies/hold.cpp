#include "hold.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bodies {

namespace {

constexpr double all_gone = 0.02;    // N: faded springs with less force count as gone
constexpr double at_rest = 1e-3;     // m/s
constexpr double taking_anew = 0.1;  // s in which new springs replace those that still fade

}  // namespace

Vector3d Hold::arm(std::size_t spring) const {
    static const Vector3d corners[springs] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    return options_.arm / std::sqrt(3.0) * corners[spring];
}

void Hold::take(const World& world, std::size_t body) {
    // Dropping the rest of the previous hold at once would be a step.
    softly_ = softly_ || there_ > 0 || remains_ > all_gone;
    body_ = body;
    const Pose pose = world.after(body);
    for (std::size_t i = 0; i < springs; ++i) {
        ends_[i] = position_ + orientation_ * arm(i);
        on_body_[i] = pose.orientation.conjugate() * (ends_[i] - pose.position);
    }
    move_ = 0;
    share_ = 1;
}

void Hold::let_go(double now) {
    body_.reset();
    let_go_ = now;
    slips_ = false;
    account_.drop_springs();
}

void Hold::feel(const knurl::Report& report, const SpringFeedback& feedback) {
    position_ = knurl::to_eigen(report.position);
    orientation_ = knurl::to_eigen(report.orientation);
    velocity_ = knurl::to_eigen(report.velocity);
    spin_ = knurl::to_eigen(report.angular_velocity);
    account_.spring = remains_ = 0;
    for (std::size_t i = 0; i < springs; ++i) {
        const Vector3d point = position_ + orientation_ * arm(i);
        const Vector3d told = feedback[i] ? knurl::to_eigen(feedback[i]->force) : Vector3d::Zero();
        const Vector3d force = body_ ? told : Vector3d::Zero();
        remains_ = std::max(remains_, told.norm());
        // The trapezium is exact for a spring.
        if (felt_ && body_) account_.put_in(-0.5 * (force + forces_[i]).dot(point - points_[i]));
        if (feedback[i] && feedback[i]->stiffness > 0)
            account_.spring += force.squaredNorm() / (2 * feedback[i]->stiffness);
        points_[i] = point;
        forces_[i] = force;
    }
    felt_ = true;
    account_.settle();
}

std::vector<Pull> Hold::pulls(const World& world) {
    if (!body_) return {};
    account_.keep(options_.credit);
    const double share = share_ = std::clamp(2 + account_.left() / options_.credit, 0.0, 1.0);
    ++frames_;
    short_of_ += share < 1;
    const double mass = world.bodies()[*body_].mass;
    std::vector<Pull> all;
    // In a simulation slower than real time the hand appears faster. The springs do not use that speed: no
    // hand continues like that for a whole long frame, and the body would be thrown.
    for (std::size_t i = 0; i < springs; ++i) {
        const Vector3d lever = orientation_ * arm(i);
        all.push_back(
            {.body = *body_,
             .on_body = on_body_[i],
             .towards = position_ + lever,
             .velocity = velocity_ + spin_.cross(lever),
             .stiffness = share * options_.stiffness,
             .damping = share * options_.damping * 2 * std::sqrt(options_.stiffness * mass / springs)});
    }
    return all;
}

void Hold::stepped(const World& world, double interval) {
    if (!body_) return;
    account_.created = -account_.left();
    account_.body += world.pulled();
    account_.settle();
    slips_ = share_ == 0 && world.velocity(*body_).norm() < at_rest;
    if (slips_) account_.forgive();
    const Pose pose = world.after(*body_);
    for (std::size_t i = 0; i < springs; ++i) ends_[i] = pose.position + pose.orientation * on_body_[i];
    move_ = interval;
}

std::array<knurl::Spring, Hold::springs> Hold::told(double now) {
    std::array<knurl::Spring, springs> all;
    there_ = 1;
    // A released body's springs follow the hand as they fade, so that the hand is not drawn back.
    if (!body_) {
        ends_ = points_;
        move_ = options_.fade / 4;
        there_ = let_go_ < 0 ? 0 : std::clamp(1 - (now - let_go_) / options_.fade, 0.0, 1.0);
    }
    if (std::exchange(softly_, false)) soft_until_ = now + taking_anew;
    const double soft = body_ ? soft_until_ - now : 0;
    for (std::size_t i = 0; i < springs; ++i)
        all[i] = {.anchor = knurl::to_plain(ends_[i]),
                  .attach = knurl::to_plain(arm(i)),
                  .stiffness = share_ * there_ * options_.stiffness,
                  .duration = std::max(move_, soft)};
    return all;
}

}  // namespace bodies
