#include "spacemouse/device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/Geometry>

#include <knurl/drivers/pose_mechanism.hpp>

#include "rotation_vector.hpp"
#include "spacemouse/protocol.hpp"
#include "usb/address.hpp"
#include "usb/io_thread.hpp"

namespace knurl::drivers::spacemouse {

namespace {

/// Models from the SpaceTraveler to the SpaceMouse Compact.
constexpr UsbId ids[] = {{0x046d, 0xc603}, {0x046d, 0xc605}, {0x046d, 0xc606}, {0x046d, 0xc621},
                         {0x046d, 0xc623}, {0x046d, 0xc625}, {0x046d, 0xc626}, {0x046d, 0xc627},
                         {0x046d, 0xc628}, {0x046d, 0xc629}, {0x046d, 0xc62b}, {0x046d, 0xc640},
                         {0x256f, 0xc62e}, {0x256f, 0xc62f}, {0x256f, 0xc631}, {0x256f, 0xc632},
                         {0x256f, 0xc633}, {0x256f, 0xc635}, {0x256f, 0xc636}, {0x256f, 0xc638},
                         {0x256f, 0xc63a}};

constexpr double full_deflection = 350;  // counts; the stop is at 350 to 400

struct Settings {
    bool rate = false;    // deflection is a speed; else it is a position
    double range = 0.06;  // m, of the workspace: position at full deflection, or the limit of rate control
    double turn = 0.6;    // rad, likewise
    double speed = 0.1;   // m/s at full deflection, rate control; rad/s likewise
    double follow = 4;    // Hz, position control: how fast the probe approaches the cap's position
};

/// A probe without force. The cap's deflection d (-1 to 1 per axis) gives, under
///   position control: a place range * d, which the probe approaches with the time constant of `follow`;
///                     when released, the probe returns to the middle;
///   rate control:     a velocity speed * d; when released, the probe stays where it is.
/// In both modes the speed is limited, so that a blow on the cap causes no fault.
class SpaceMouse final : public Device {
  public:
    SpaceMouse(usb::Wanted wanted, const Settings& settings, int priority)
        : settings_(settings), io_(std::move(wanted), std::make_unique<Protocol>(), priority) {
        link_.name = "spacemouse";
        link_.serial = io_.info().serial;
        link_.description = (io_.info().name.empty() ? "SpaceMouse" : io_.info().name) + " in port " +
                            io_.info().port + ", no force; the cap's deflection is a " +
                            (settings.rate ? "speed" : "place");
        link_.sensed_joints = 7;
        link_.senses_orientation = true;
        link_.radians_per_count.assign(7, 0);
        link_.workspace_radius = settings.range;
    }

    const LinkConfig& link() const noexcept override { return link_; }
    const Mechanism& mechanism() const noexcept override { return mechanism_; }

    ReadStatus read(Nanoseconds now, JointSample& sample) noexcept override {
        const ReadStatus status = io_.take(reading_);
        const double dt =
            started_ ? std::clamp(static_cast<double>(now - last_) * 1e-9, 0.0, longest_step) : 0;
        started_ = true;
        last_ = now;
        if (status == ReadStatus::unplugged) reading_.counts = {};  // no hand holds the cap any more
        move(dt);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            sample.position[i] = place_[row];
            sample.velocity[i] = velocity_[row];
            sample.velocity[3 + i] = spin_[row];
        }
        sample.position[3] = orientation_.w();
        sample.position[4] = orientation_.x();
        sample.position[5] = orientation_.y();
        sample.position[6] = orientation_.z();
        sample.has_velocity = true;
        sample.calibrated = status != ReadStatus::unplugged;
        sample.buttons = reading_.buttons;
        // An untouched cap sends nothing, but its probe is known.
        return status == ReadStatus::stale ? ReadStatus::ok : status;
    }

    bool write(Nanoseconds, const JointEfforts&) noexcept override { return io_.there(); }
    void make_safe() noexcept override {}  // it has no motors

  private:
    static constexpr double longest_step = 10e-3;  // s
    static constexpr double most_speed = 0.5;      // m/s
    static constexpr double most_spin = 4;         // rad/s

    /// Device axes: x right, y towards the user, z down. Device frame: x right, y away, z up.
    Eigen::Vector3d deflection(std::size_t from) const noexcept {
        const auto one = [&](std::size_t i) {
            return std::clamp(reading_.counts[from + i] / full_deflection, -1.0, 1.0);
        };
        return {one(0), -one(1), -one(2)};
    }

    static Eigen::Vector3d limited(const Eigen::Vector3d& v, double most) noexcept {
        const double norm = v.norm();
        return norm > most ? Eigen::Vector3d(v * (most / norm)) : v;
    }

    void move(double dt) noexcept {
        const Eigen::Vector3d push = deflection(0), twist = deflection(3);
        const Eigen::Vector3d turned = rotation_vector(Eigen::Quaterniond::Identity(), orientation_);
        const double pull = 2 * std::numbers::pi * settings_.follow;
        if (settings_.rate) {
            velocity_ = settings_.speed * push;
            spin_ = settings_.speed / settings_.range * settings_.turn * twist;
        } else {
            velocity_ = pull * (limited(settings_.range * push, settings_.range) - place_);
            spin_ = pull * (limited(settings_.turn * twist, settings_.turn) - turned);
        }
        velocity_ = limited(velocity_, most_speed);
        spin_ = limited(spin_, most_spin);
        const Eigen::Vector3d before = place_;
        place_ = limited(place_ + velocity_ * dt, settings_.range);
        if (dt > 0) velocity_ = (place_ - before) / dt;  // at the edge of the workspace it stops
        orientation_ = (rotation(spin_ * dt) * orientation_).normalized();
    }

    Settings settings_;
    usb::IoThread io_;
    PoseMechanism mechanism_;
    LinkConfig link_;
    usb::Reading reading_;
    Nanoseconds last_ = 0;
    bool started_ = false;
    Eigen::Vector3d place_ = Eigen::Vector3d::Zero(), velocity_ = Eigen::Vector3d::Zero();  // m, m/s
    Eigen::Vector3d spin_ = Eigen::Vector3d::Zero();                                        // rad/s
    Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
};

std::unique_ptr<Device> open(std::string_view what, const OpenOptions& options) {
    usb::Address address(
        {.scheme = "spacemouse", .kind = "SpaceMouse", .ids = {std::begin(ids), std::end(ids)}}, what);
    Settings settings;
    settings.rate = address.flag("rate", settings.rate);
    settings.range = address.number("range", settings.range, 0.001, 1, "m");
    settings.turn = address.number("turn", settings.turn, 0, 3, "rad");
    settings.speed = address.number("speed", settings.speed, 0.001, 1, "m/s");
    settings.follow = address.number("follow", settings.follow, 0.1, 50, "Hz");
    address.done();
    if (options.check_only) return nullptr;
    return std::make_unique<SpaceMouse>(address.wanted(), settings, options.io_priority);
}

}  // namespace

Driver driver() {
    return {.scheme = "spacemouse",
            .help = "[SERIAL][,rate=on][,range=M][,turn=RAD][,speed=M_PER_S][,follow=HZ][,port=PORT]",
            .open = open,
            .usb = {std::begin(ids), std::end(ids)}};
}

}  // namespace knurl::drivers::spacemouse
