#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include <knurl/drivers/reach.hpp>
#include <knurl/drivers/sim_device.hpp>

#include "sim/arm.hpp"
#include "sim/hand.hpp"
#include "sim/live_hand.hpp"

namespace knurl::drivers {

namespace {

constexpr std::uint64_t fnv_offset = 0xcbf29ce484222325U;
constexpr std::uint64_t fnv_prime = 0x100000001b3U;

void hash(std::uint64_t& digest, std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) {
        digest = (digest ^ ((word >> (8 * byte)) & 0xffU)) * fnv_prime;
    }
}

bool during(std::int64_t at, std::int64_t reads, std::uint64_t read) {
    return at >= 0 && read >= static_cast<std::uint64_t>(at) && read < static_cast<std::uint64_t>(at + reads);
}

/// The joints with the tip at the start of a motion (and with its orientation, if both know it). Only at
/// start.
JointArray start_of(const SimProfile& profile, const Motion& motion) {
    const MotionRow& start = motion.rows().front();
    std::optional<Eigen::Quaterniond> turned;
    if (motion.has_orientation() && profile.senses_orientation) turned = start.orientation;
    if (const auto joints = reach(*profile.mechanism, profile.centre, start.position, turned)) {
        return *joints;
    }
    throw std::runtime_error(profile.name + " cannot reach the start of the hand's motion, " +
                             std::to_string(start.position.x()) + "," + std::to_string(start.position.y()) +
                             "," + std::to_string(start.position.z()) + " m; keep it within " +
                             std::to_string(profile.workspace_radius) + " m of the origin");
}

LinkConfig describe(const SimProfile& p) {
    LinkConfig link;
    link.name = p.name;
    link.description = p.description;
    link.sensed_joints = p.joints;
    link.actuated_joints = p.joints - p.passive_joints;
    link.senses_orientation = p.senses_orientation;
    link.renders_torque = p.renders_torque;
    link.nominal_rate = p.rate;
    for (std::size_t i = 0; i < static_cast<std::size_t>(p.joints); ++i) {
        const double stated = p.radians_per_count[i];
        link.radians_per_count.push_back(stated > 0 ? stated : p.quantum / p.lever[i]);
    }
    link.joint_least = p.least;
    link.joint_greatest = p.greatest;
    for (std::size_t i = 0; i < static_cast<std::size_t>(link.actuated_joints); ++i) {
        const double stated = p.effort_limit[i];
        link.effort_limit.push_back(stated > 0 ? stated : p.peak_force * p.largest_lever[i]);
    }
    link.workspace_radius = p.workspace_radius;
    link.peak_force = p.peak_force;
    link.continuous_force = p.continuous_force > 0 ? p.continuous_force : p.peak_force / 2;
    link.peak_torque = p.peak_torque;
    link.damping = p.damping;
    if (p.senses_orientation) link.rotational_damping = p.rotational_damping;
    link.lag = p.lag > 0 ? 1 / (2 * std::numbers::pi * p.lag) : 0;
    link.grip_damping = p.hand.grip * p.hand.damping;
    link.apparent_mass = p.mass;
    link.has_watchdog = p.watchdog > 0;
    link.watchdog_time = p.watchdog;
    return link;
}

}  // namespace

struct SimDevice::Body {
    SimProfile profile;
    LinkConfig link;
    Arm arm;
    Hand hand;
    std::unique_ptr<LiveHand> live;  // null: `hand` has the wanted place
    SimFaults faults;
    SimState state;
    JointSample sample;

    Arm::JointVector target;   // N m, the amplifiers' commands, after DAC and limits
    Arm::JointVector exerted;  // N m, after the lag
    bool connected = true;
    bool asleep = false;        // the watchdog has switched the motors off
    Nanoseconds now = 0;        // of the last read
    Nanoseconds simulated = 0;  // ns since the first read
    Nanoseconds written = 0;    // simulated ns of the last write
    std::uint64_t digest = fnv_offset;

    Body(SimProfile p, const std::optional<Motion>& motion)
        : profile(std::move(p)),
          link(describe(profile)),
          arm(profile),
          hand(profile.hand, motion, placed(motion), profile.seed),
          target(Arm::JointVector::Zero(profile.joints)),
          exerted(target) {
        set_grip(profile.hand.grip);
        if (!profile.live.empty()) live = std::make_unique<LiveHand>(profile.live, profile.workspace_radius);
        publish(0);
    }

    /// The tip at the start of the hand's motion, or else at its present place.
    MotionSample placed(const std::optional<Motion>& motion) {
        if (motion) {
            arm.place(start_of(profile, *motion), {});
        }
        return tip();
    }

    MotionSample tip() const {
        return {.position = arm.pose().position,
                .orientation = arm.pose().orientation,
                .velocity = arm.twist().head<3>(),
                .angular_velocity = arm.twist().tail<3>()};
    }

    void set_grip(double grip) {
        hand.set_grip(grip);
        arm.set_mass(profile.mass + grip * profile.hand.finger_mass);
        link.grip_damping = grip * profile.hand.damping;
    }

    double time() const { return static_cast<double>(simulated) * 1e-9; }

    /// All forces on the tip except the hand's and dry friction.
    Arm::Wrench passive(const MotionSample& tip) const {
        Eigen::Vector3d force = -profile.damping * tip.velocity;
        force.z() -= profile.mass * profile.gravity;
        const double distance = tip.position.norm();
        if (distance > profile.stop_radius) {
            const Eigen::Vector3d outwards = tip.position / distance;
            const double press = profile.stop_stiffness * (distance - profile.stop_radius) +
                                 profile.stop_damping * outwards.dot(tip.velocity);
            force -= std::max(0.0, press) * outwards;
        }
        Arm::Wrench wrench;
        wrench << force, -profile.rotational_damping * tip.angular_velocity;
        return wrench;
    }

    double stop(double q, double rate, double least, double greatest) const {
        const double over = q - std::clamp(q, least, greatest);
        return over == 0 ? 0 : -profile.joint_stop_stiffness * over - profile.joint_stop_damping * rate;
    }

    Arm::JointVector joint_stops() const {
        Arm::JointVector efforts = Arm::JointVector::Zero(arm.joints());
        for (Eigen::Index i = 0; i < arm.joints(); ++i) {
            const auto joint = static_cast<std::size_t>(i);
            efforts[i] =
                stop(arm.position()[i], arm.rates()[i], profile.least[joint], profile.greatest[joint]);
        }
        // The stop of a row A_i q acts on all joints in that row: tau = A_i^T times its effort.
        for (Eigen::Index i = 0; i < profile.coupling.rows(); ++i) {
            const auto row = profile.coupling.row(i).transpose();
            const double effort = stop(row.dot(arm.position()), row.dot(arm.rates()),
                                       profile.row_least[static_cast<std::size_t>(i)],
                                       profile.row_greatest[static_cast<std::size_t>(i)]);
            if (effort != 0) efforts += effort * row;
        }
        return efforts;
    }

    void advance(Nanoseconds gap) {
        const auto steps = (gap + max_sub_step - 1) / max_sub_step;
        if (steps == 0) {
            return;
        }
        const double h = static_cast<double>(gap) * 1e-9 / static_cast<double>(steps);
        const double follow = profile.lag > 0 ? -std::expm1(-h * 2 * std::numbers::pi * profile.lag) : 1;
        const auto watchdog = static_cast<Nanoseconds>(profile.watchdog * 1e9);
        for (Nanoseconds step = 0; step < steps; ++step) {
            const Nanoseconds at = simulated + gap * step / steps;
            if (watchdog > 0 && at - written > watchdog && !asleep) {
                asleep = true;
                ++state.watchdog_trips;
                target.setZero();
            }
            exerted += follow * (target - exerted);
            const double t = static_cast<double>(at) * 1e-9;
            const MotionSample before = tip();
            MotionSample wants = hand.wanted(t);
            if (live) {
                const MotionSample moved = live->wanted(h);
                wants.position = moved.position;
                wants.velocity = moved.velocity;
            }
            const HandForce pull = hand.force(t, wants, before);
            Arm::Wrench wrench = passive(before);
            wrench.head<3>() += pull.force;
            wrench.tail<3>() += pull.torque;
            const Arm::JointVector rates_before = arm.rates();
            arm.step(h, exerted + joint_stops(), wrench);

            // In a semi-implicit step, the change of kinetic energy is force times the mean velocity.
            const MotionSample after = tip();
            state.energy_to_hand -= h * 0.5 *
                                    (pull.force.dot(before.velocity + after.velocity) +
                                     pull.torque.dot(before.angular_velocity + after.angular_velocity));
            state.motor_work += h * 0.5 * exerted.dot(rates_before + arm.rates());
            state.peak_motor_force = std::max(state.peak_motor_force, arm.motor_force().norm());
            state.hand_force = pull.force;
            state.hand_wants = wants.position;
        }
        simulated += gap;
    }

    void publish(Nanoseconds skipped) {
        state.t = time();
        for (Eigen::Index i = 0; i < arm.joints(); ++i) {
            const auto joint = static_cast<std::size_t>(i);
            state.joints[joint] = arm.position()[i];
            state.rates[joint] = arm.rates()[i];
            state.efforts[joint] = exerted[i];
        }
        const MotionSample here = tip();
        state.position = here.position;
        state.orientation = here.orientation;
        state.velocity = here.velocity;
        state.angular_velocity = here.angular_velocity;
        state.motor_force = arm.motor_force();
        state.kinetic_energy = arm.kinetic_energy();
        state.skipped += skipped;
        for (const JointArray* words : {&state.joints, &state.rates, &state.efforts}) {
            for (std::size_t i = 0; i < static_cast<std::size_t>(profile.joints); ++i) {
                hash(digest, std::bit_cast<std::uint64_t>((*words)[i]));
            }
        }
        hash(digest, static_cast<std::uint64_t>(simulated));
    }

    void measure() {
        sample.calibrated = true;
        for (std::size_t i = 0; i < static_cast<std::size_t>(profile.joints); ++i) {
            const double count = link.radians_per_count[i];
            sample.position[i] =
                count > 0 ? count * std::nearbyint(state.joints[i] / count) : state.joints[i];
        }
    }

    ReadStatus answer(std::uint64_t read, JointSample& out) {
        if (faults.unplug_at >= 0 && read >= static_cast<std::uint64_t>(faults.unplug_at)) {
            connected = faults.replug_at >= 0 && read >= static_cast<std::uint64_t>(faults.replug_at);
            if (!connected) {
                target.setZero();
                out = sample;
                return ReadStatus::unplugged;
            }
        }
        if (during(faults.stale_at, faults.stale_reads, read)) {
            out = sample;
            return ReadStatus::stale;
        }
        if (during(faults.bad_at, faults.bad_reads, read)) {
            out = sample;
            return ReadStatus::bad;
        }
        measure();
        out = sample;
        if (during(faults.nan_at, faults.nan_reads, read)) {
            out.position[0] = std::nan("");
        }
        if (during(faults.jump_at, faults.jump_reads, read)) {
            out.position[static_cast<std::size_t>(std::clamp(faults.jump_joint, 0, max_joints - 1))] +=
                faults.jump;
        }
        if (live) out.buttons = live->buttons();
        out.calibrated = !during(faults.unhomed_at, faults.unhomed_reads, read);
        return ReadStatus::ok;
    }
};

SimDevice::SimDevice(SimProfile profile, const std::optional<Motion>& hand)
    : body_(std::make_unique<Body>(std::move(profile), hand)) {}

SimDevice::~SimDevice() = default;

const LinkConfig& SimDevice::link() const noexcept {
    return body_->link;
}
bool SimDevice::has_buttons() const noexcept {
    return body_->live != nullptr;
}

const Mechanism& SimDevice::mechanism() const noexcept {
    return *body_->profile.mechanism;
}
const SimState& SimDevice::state() const noexcept {
    return body_->state;
}
const SimProfile& SimDevice::profile() const noexcept {
    return body_->profile;
}
SimFaults& SimDevice::faults() noexcept {
    return body_->faults;
}
std::uint64_t SimDevice::digest() const noexcept {
    return body_->digest;
}
void SimDevice::set_grip(double grip) noexcept {
    body_->set_grip(std::clamp(grip, 0.0, 1.0));
}

ReadStatus SimDevice::read(Nanoseconds now, JointSample& sample) noexcept {
    Body& body = *body_;
    const Nanoseconds gap = body.state.reads == 0 ? 0 : std::max<Nanoseconds>(0, now - body.now);
    const Nanoseconds simulated = std::min(gap, max_catch_up);
    body.now = body.state.reads == 0 ? now : std::max(now, body.now);
    body.advance(simulated);
    body.publish(gap - simulated);
    return body.answer(body.state.reads++, sample);
}

bool SimDevice::write(Nanoseconds, const JointEfforts& efforts) noexcept {
    Body& body = *body_;
    if (!body.connected) {
        return false;
    }
    ++body.state.writes;
    body.written = body.simulated;
    body.asleep = false;
    const auto joints = static_cast<std::size_t>(body.link.actuated_joints);
    const std::span<const double> asked(efforts.data(), joints);
    if (!std::all_of(asked.begin(), asked.end(), [](double effort) { return std::isfinite(effort); })) {
        ++body.state.refused_efforts;
        body.target.setZero();
        return true;
    }
    const double steps = body.profile.dac_bits > 0 ? std::exp2(body.profile.dac_bits - 1) - 1 : 0;
    for (std::size_t i = 0; i < joints; ++i) {
        const double limit = body.link.effort_limit[i];
        const double clipped = std::clamp(asked[i], -limit, limit);
        body.target[static_cast<Eigen::Index>(i)] =
            steps > 0 ? std::nearbyint(clipped / limit * steps) / steps * limit : clipped;
    }
    return true;
}

void SimDevice::notify(Notice notice) noexcept {
    if (notice == Notice::claim_active) {
        body_->hand.begin(body_->time());
    } else if (notice == Notice::disabled) {
        body_->hand.rest(body_->time());
    }
}

void SimDevice::place(const JointArray& joints, const JointArray& rates) noexcept {
    body_->arm.place(joints, rates);
    body_->target.setZero();
    body_->exerted.setZero();
    body_->publish(0);
}

Driver sim_driver() {
    std::string names;
    for (const std::string& name : sim_profile_names()) {
        names += (names.empty() ? "" : "|") + name;
    }
    return {.scheme = "sim",
            .help = names + "[,grip=0.5,push=1.5,live=/dev/input/event3,...]",
            .open = [](std::string_view what, const OpenOptions& options) -> std::unique_ptr<Device> {
                SimProfile profile = sim_profile(what);
                if (options.check_only) profile.live.clear();
                if (what.find(",seed=") == std::string_view::npos) {
                    profile.seed = options.seed;
                }
                std::optional<Motion> hand;
                if (!options.hand_file.empty()) {
                    hand = load_motion(options.hand_file);
                }
                return std::make_unique<SimDevice>(std::move(profile), hand);
            }};
}

}  // namespace knurl::drivers
