#include "touch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bodies {

namespace {

constexpr double alone = 0.9;  // cosine between force and depth; a smaller one shows further surfaces

constexpr double near = 0.02;      // m
constexpr double a_little = 0.1;   // share of the stiffness per frame
constexpr double most_step = 0.1;  // N

constexpr double taking = 0.05;  // s in which the surface of a taken body fades out

}  // namespace

Touch::Touch(std::size_t body, std::uint32_t asset, const TouchOptions& options)
    : body_(body), options_(options), stiffness_(options.stiffness) {
    shape_.asset = asset;
    shape_.stiffness = options.stiffness;
    shape_.damping = options.damping;
    shape_.friction = {.dynamic = options.friction};
    // continues from its place: nothing needs a fade, and feedback has its whole force
    shape_.recovery = 0;
    push_.body = body;
}

void Touch::feel(const Vector3d& finger, const Vector3d& velocity,
                 const std::optional<knurl::HandFeedback>& feedback, double dt) {
    Vector3d force = Vector3d::Zero();
    depth_ = 0;
    if (there() && feedback && (feedback->flags & knurl::Feedback::touching)) {
        force = knurl::to_eigen(feedback->force);
        if (feedback->stiffness > 0) stiffness_ = feedback->stiffness;
        if (force.squaredNorm() > 0) {
            contact_ = knurl::to_eigen(feedback->contact_point);
            // The body's nearest free point. With friction the force leans away from it. Where several
            // surfaces are touched it lies on all of them, and the force shows which one is this body's.
            const Vector3d out = contact_ - finger, way = force.normalized();
            normal_ = out.dot(way) > alone * out.norm() ? Vector3d(-out.normalized()) : Vector3d(-way);
            depth_ = std::max(0.0, -out.dot(normal_));
        }
    }
    if (felt_) {
        const double work = -0.5 * (force + force_).dot(finger - finger_);
        account_.put_in(work);
        impulse_ += dt * 0.5 * (force + force_);
        time_ += dt;
    }
    felt_ = true;
    finger_ = finger;
    velocity_ = velocity;
    force_ = force;
    settle();
}

void Touch::held(bool so) {
    if (so && there()) leave();
    away_ |= held_ && !so;
    held_ = so;
}

void Touch::jumped() {
    leave();
    away_ = true;
}

void Touch::leave() {
    account_.drop_springs();
    force_.setZero();
    impulse_.setZero();
    push_.force.setZero();
    time_ = depth_ = gone_ = played_ = 0;
}

void Touch::settle() {
    account_.spring = stiffness_ * depth_ * depth_ / 2;
    account_.settle();
}

/// The share of the push that the account covers, if the hand stays where it is.
double Touch::affordable(const Vector3d& force, double give, double dt, const Vector3d& speed) const {
    const double funds = account_.hand - account_.body - account_.lost;
    const auto short_by = [&](double share) {
        const Vector3d pushed = share * force;
        const double way = speed.dot(normal_) * dt + give * pushed.dot(normal_);
        const double work = pushed.dot(speed) * dt + give * pushed.squaredNorm();
        const double held = std::max(0.0, depth_ - way);
        return work + stiffness_ * held * held / 2 - funds;
    };
    if (short_by(1) <= 1e-9) return 1;
    if (short_by(0) > 0) return 0;
    double low = 0, high = 1;
    for (int i = 0; i < 30; ++i) {
        const double middle = (low + high) / 2;
        (short_by(middle) <= 0 ? low : high) = middle;
    }
    return low;
}

Push Touch::push(const World& world, double dt) {
    push_.force = time_ > 0 ? Vector3d(-impulse_ / time_) : Vector3d::Zero();
    push_.point = contact_;
    impulse_.setZero();
    time_ = 0;
    account_.keep(options_.reserve);
    shape_.stiffness = admitted(world, dt);
    if (push_.force.squaredNorm() == 0) return push_;
    ++frames_;
    if (!options_.keep_account) return push_;
    const double share = affordable(push_.force, world.give(body_, contact_, normal_, dt), dt,
                                    world.speed_at(body_, contact_));
    short_of_ += share < 1;
    push_.force *= share;
    return push_;
}

/// Stiffness, N/m, for the next frame. Under the hand it changes in small steps, and grows only as far as the
/// account covers the spring's energy.
double Touch::admitted(const World& world, double dt) const {
    if (!(options_.softness > 0)) return options_.stiffness;
    Vector3d point = contact_, way = normal_;
    if (!touches()) {
        const double away = world.distance(body_, finger_, &point);
        if (away > near) return options_.stiffness;
        way = away * (point - finger_).normalized();
        if (way.squaredNorm() == 0) return shape_.stiffness;
        way.normalize();
    }
    const double give = world.give(body_, point, way, dt);
    const double wanted =
        std::min(options_.stiffness, give > 0 ? options_.softness / give : options_.stiffness);
    if (!touches()) return wanted;
    const double change = std::min(a_little * shape_.stiffness, most_step / std::max(depth_, 1e-6));
    const double funds = std::max(0.0, account_.left() + account_.spring);
    const double paid = depth_ > 0 ? std::max(shape_.stiffness, 2 * funds / (depth_ * depth_)) : wanted;
    return std::clamp(wanted, shape_.stiffness - change, std::min(paid, shape_.stiffness + change));
}

knurl::Shape Touch::stepped(const World& world, double interval) {
    account_.created = -account_.left();
    if (!there()) gone_ += std::exchange(played_, interval);
    if (gone_ > 3 * taking) away_ = false;
    if (away_) return rest();
    if (there()) gone_ = 0;
    const Pose from = world.before(body_);
    end_ = world.after(body_);
    const Vector3d lever = from.orientation.conjugate() * (push_.point - from.position);
    account_.body += push_.force.dot(end_.position + end_.orientation * lever - push_.point);
    settle();
    const double pace = world.last_dt() / interval;
    shape_.position = knurl::to_plain(from.position);
    shape_.orientation = knurl::to_plain(from.orientation);
    shape_.velocity = knurl::to_plain(Vector3d(pace * world.velocity(body_)));
    shape_.angular_velocity = knurl::to_plain(Vector3d(pace * world.angular_velocity(body_)));
    return shown(shape_);
}

knurl::Shape Touch::rest() const {
    knurl::Shape still = shape_;
    still.position = knurl::to_plain(end_.position);
    still.orientation = knurl::to_plain(end_.orientation);
    still.velocity = still.angular_velocity = {};
    return shown(still);
}

double Touch::fades_for() const {
    return there() ? 0 : std::max(0.0, taking - gone_);
}

/// The surface of a body that was taken, or has jumped, fades out and is then absent. After release it is met
/// anew, and does not push out a hand inside it.
knurl::Shape Touch::shown(knurl::Shape shape) const {
    if (there()) return shape;
    shape.stiffness = 0;
    shape.recovery = fades_for();
    if (gone_ > 2 * taking) shape.asset = 0;
    return shape;
}

}  // namespace bodies
