// Force Dimension's library, libdhd. drd's regulation is never started: nothing moves the device but the servo.

#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Geometry>

#include <knurl/drivers/cartesian_tool.hpp>

#include "backend.hpp"
#include "dhd_functions.hpp"
#include "dhd_models.hpp"

namespace knurl::device {

namespace {

using drivers::JointEfforts;
using drivers::JointSample;
using drivers::Nanoseconds;
using drivers::process::Exchange;

// From the documentation.
constexpr int timeguard = 1;      // returned: nothing was exchanged
constexpr int status_count = 17;  // dhdGetStatus
constexpr int status_reset = 3, status_force = 5, status_error = 9, status_cause = 14;
constexpr int cause_velocity = 2, cause_watchdog = 3;  // why forces are off
constexpr double watchdog_unit = 125e-6;               // s
constexpr int error_com = 2, error_busy = 3, error_no_device = 5, error_timeout = 7, error_not_ready = 12,
              error_in_use = 20;

std::string version_of(const Dhd& dhd) {
    int major = 0, minor = 0, release = 0, revision = 0;
    dhd.sdk_version(&major, &minor, &release, &revision);
    const std::string text =
        std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release);
    if (major != 3 || minor < 14)
        throw std::runtime_error(
            dhd.library.path() + " is of the SDK " + text +
            "; Knurl knows 3.14 to 3.17: install one of these, or name it in KNURL_LIBDHD");
    return text;
}

/// What a failed opening means, and what to do.
std::string opening_failed(const Dhd& dhd) {
    switch (dhd.error()) {
        case error_in_use:
        case error_busy:
            return "another program has it open (" + dhd.last_error() + "); end that one";
        case error_no_device:
            return "no Force Dimension device answers; switch it on, plug it in, and let the "
                   "group haptics use it (lsusb shows 1451:..., 70-knurl.rules)";
        case error_com:
            return "it does not answer (" + dhd.last_error() +
                   "); is this user allowed to open its USB node (group haptics, 70-knurl.rules)?";
        default:
            return dhd.last_error();
    }
}

class DhdDevice final : public Backend {
  public:
    explicit DhdDevice(const Arguments& arguments)
        : arguments_(arguments), dhd_(arguments.library), version_(version_of(dhd_)) {
        open();
        try {
            set_up();
        } catch (...) {
            close();
            throw;
        }
    }
    ~DhdDevice() override { close(); }

    drivers::process::Description description() const override;

    void run(Exchange& exchange) override {
        const auto period = static_cast<Nanoseconds>(1e9 / arguments_.setting("rate", 4000));
        Nanoseconds next = drivers::process::monotonic(), look = next;
        while (!exchange.leaving()) {
            const Nanoseconds now = drivers::process::monotonic();
            if (now >= look) {
                look_at_status(exchange);
                look = now + look_every;
            }
            if (exchange.awake()) send(exchange);
            receive(exchange);
            // An order ends the wait at once: it is what the hand feels.
            next = drivers::process::monotonic() + period;
            exchange.wait(next);
        }
        zero();
    }

  private:
    static constexpr Nanoseconds look_every = 50'000'000;   // status
    static constexpr Nanoseconds rest_first = 100'000'000;  // of zero orders, before forces come on again
    static constexpr int most_errors = 20;                  // in a row: then the device is given up

    void open() {
        const int count = dhd_.count();
        const std::string wanted = arguments_.serial.empty() ? arguments_.name : arguments_.serial;
        int opened = -1;
        if (count <= 0) {
            throw std::runtime_error(
                "the library sees no Force Dimension device; switch it on, plug it in, and let the group "
                "haptics use it "
                "(lsusb, 70-knurl.rules)");
        }
        // A small number is an index; serial numbers are larger.
        const bool is_index = arguments_.serial.empty() && (wanted.empty() || wanted.size() < 2);
        if (is_index) {
            const int index = wanted.empty() ? 0 : std::stoi(wanted);
            if (index >= count)
                throw std::runtime_error("there is no device " + wanted + "; the library sees " +
                                         std::to_string(count) + ", the first is 0");
            opened = dhd_.open_id(static_cast<char>(index));
        } else {
            opened = dhd_.open_serial(std::stoi(wanted));
        }
        if (opened < 0)
            throw std::runtime_error((wanted.empty() ? "" : "device " + wanted + ": ") +
                                     opening_failed(dhd_));
        id_ = static_cast<char>(opened);
    }

    void set_up() {
        wrist_ = dhd_.has_wrist(id_);
        torque_ = dhd_.has_active_wrist(id_);
        gripper_ = dhd_.has_gripper(id_);
        grip_force_ = dhd_.has_active_gripper(id_);
        must(dhd_.gravity(1, id_), "gravity compensation");
        option(dhd_.base_x, "base_x", "dhdSetBaseAngleXDeg");
        option(dhd_.base_z, "base_z", "dhdSetBaseAngleZDeg");
        option(dhd_.tool_mass, "tool", "dhdSetEffectorMass");
        set_watchdog();
    }
    void option(int (*set)(double, char), const char* name, const char* function) {
        if (!arguments_.settings.contains(name)) return;
        if (set == nullptr)
            throw std::runtime_error(dhd_.library.path() + " has no " + function + ": leave " + name +
                                     "= out");
        must(set(arguments_.setting(name, 0), id_), name);
    }
    /// The device's own: the shortest that this loop can keep on a machine that is late at times.
    void set_watchdog() {
        const double wanted = arguments_.setting("watchdog", 5e-3);
        if (dhd_.set_watchdog == nullptr || dhd_.get_watchdog == nullptr) return;
        dhd_.expert_on();
        unsigned char units = 0;
        const auto asked = static_cast<unsigned char>(std::lround(wanted / watchdog_unit));
        if (dhd_.set_watchdog(asked, id_) >= 0 && dhd_.get_watchdog(&units, id_) >= 0)
            watchdog_ = units * watchdog_unit;
        dhd_.expert_off();
    }
    void must(int code, const char* what) {
        if (code < 0) throw std::runtime_error(std::string(what) + ": " + dhd_.last_error());
    }

    void zero() { order({}); }
    int order(const JointEfforts& efforts) {
        if (!torque_ && !grip_force_) return dhd_.set_force(efforts[0], efforts[1], efforts[2], id_);
        Eigen::Vector3d torque = Eigen::Vector3d::Zero();
        if (torque_) {
            // efforts = J^T torque
            const Eigen::Vector3d wanted(efforts[3], efforts[4], efforts[5]);
            if (!wanted.isZero(0))
                torque = drivers::CartesianTool::left_jacobian(turn_).transpose().inverse() * wanted;
        }
        const double grip = grip_force_ ? efforts[static_cast<std::size_t>(gripper_joint())] : 0;
        return dhd_.set_all(efforts[0], efforts[1], efforts[2], torque.x(), torque.y(), torque.z(), grip,
                            id_);
    }

    void send(Exchange& exchange) {
        if (!forces_on_) {
            // With forces on and none ordered the hand feels the gravity compensation alone; the brakes are off. Not
            // earlier: nobody would feed the watchdog.
            zero();
            if (!check(dhd_.enable_force(1, id_), exchange)) return;
            forces_on_ = true;
        }
        const JointEfforts efforts = exchange.efforts(drivers::process::monotonic());
        if (efforts != JointEfforts{}) pushed_ = drivers::process::monotonic();
        // Motors that saturate (2) are told to nobody: the library keeps the direction. A call that the time guard left
        // out (1) is made up for by the next.
        check(order(efforts), exchange, force_errors_);
    }

    void receive(Exchange& exchange) {
        JointSample sample;
        auto& q = sample.position;
        const int code = dhd_.position(&q[0], &q[1], &q[2], id_);
        if (!check(code, exchange)) return;
        if (wrist_) {
            std::array<double, 9> rows{};
            if (!check(dhd_.orientation(rows.data(), id_), exchange)) return;
            const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> matrix(rows.data());
            const bool rotation = std::abs(matrix.determinant() - 1) < 1e-3;
            if (!rotation) {
                exchange.garbage();
                return;
            }
            turn_ = drivers::CartesianTool::rotation_near(
                Eigen::Quaterniond(Eigen::Matrix3d(matrix)).normalized(), turn_);
            for (int i = 0; i < 3; ++i) q[static_cast<std::size_t>(wrist_joint() + i)] = turn_[i];
        }
        if (gripper_ && !check(dhd_.gap(&q[static_cast<std::size_t>(gripper_joint())], id_), exchange))
            return;
        sample.buttons = dhd_.buttons(id_);
        sample.calibrated = calibrated_;
        if (forces_off_)
            exchange.garbage();  // the servo believes that it renders, and must learn that it does not
        if (code != timeguard) exchange.publish(sample, drivers::process::monotonic());
    }

    /// Whether the device is homed, and whether it gives force at all.
    void look_at_status(Exchange& exchange) {
        std::array<int, status_count> state{};
        if (!check(dhd_.status(state.data(), id_), exchange)) return;
        calibrated_ = state[status_reset] != 0;
        if (state[status_error] != 0) throw Gone("the device reports an error; switch it off and on");
        forces_off_ = forces_on_ && state[status_force] == 0;
        if (!forces_off_) return;
        // Its own guards (too fast, watchdog) have switched forces off: on again only after a rest at zero, so that
        // no force comes back at once. A button or dead-man switch is the user's.
        const int cause = state[status_cause];
        const bool guard = cause == cause_velocity || cause == cause_watchdog;
        if (guard && drivers::process::monotonic() - pushed_ > rest_first) dhd_.enable_force(1, id_);
    }

    /// False: the call failed. Throws Gone when the device is.
    bool check(int code, Exchange& exchange) { return check(code, exchange, errors_); }
    bool check(int code, Exchange& exchange, int& in_row) {
        if (code >= 0) {
            in_row = 0;
            return true;
        }
        exchange.garbage();
        const int error = dhd_.error();
        const bool gone = error == error_no_device || error == error_com || error == error_not_ready;
        if (++in_row > most_errors || (gone && in_row > 2) || error == error_no_device)
            throw Gone((error == error_timeout ? "the device does not answer: " : "the device is gone: ") +
                       dhd_.last_error());
        return false;
    }

    void close() noexcept {
        if (id_ < 0) return;
        zero();
        dhd_.stop(id_);  // forces off, brakes on
        dhd_.close(id_);
        id_ = -1;
    }

    // x y z, [gripper of a passive wrist], [wrist], [gripper of an active wrist]: driven joints come first.
    int gripper_joint() const { return gripper_ ? (wrist_ && torque_ ? 6 : 3) : -1; }
    std::string name_and_source(const DhdModel& model, bool known) const;
    double effort_limit(const DhdModel& model, int joint) const;
    int driven_joints(int joints) const;
    int wrist_joint() const { return gripper_joint() == 3 ? 4 : 3; }

    const Arguments& arguments_;
    Dhd dhd_;
    std::string version_;
    char id_ = -1;
    bool wrist_ = false, torque_ = false, gripper_ = false, grip_force_ = false;
    bool calibrated_ = false;
    bool forces_on_ = false, forces_off_ = false;  // switched on by us; off by the device all the same
    double watchdog_ = 0;                          // s
    int errors_ = 0, force_errors_ = 0;            // in a row
    Nanoseconds pushed_ = 0;
    Eigen::Vector3d turn_ = Eigen::Vector3d::Zero();
};

std::string DhdDevice::name_and_source(const DhdModel& model, bool known) const {
    const char* name = dhd_.name(id_);
    return std::string(!known && name != nullptr ? name : model.name) + " by the SDK " + version_ + "; " +
           model.source + "; damping, lag and mass not known: a low and a high estimate";
}

/// "omega.7 (right)": omega7.
std::string short_name(const DhdModel& model) {
    std::string name;
    for (const char* c = model.name; *c != '\0' && *c != ' '; ++c)
        if (std::isalnum(static_cast<unsigned char>(*c)) != 0) name += *c;
    return name;
}

double DhdDevice::effort_limit(const DhdModel& model, int joint) const {
    if (joint < 3) return model.force;
    const bool gripper = joint == gripper_joint();
    const double limit = gripper ? model.grip_force : model.torque;
    return limit > 0 ? limit : gripper ? 1 : 0.05;
}

int DhdDevice::driven_joints(int joints) const {
    if (torque_) return joints - (gripper_ && !grip_force_ ? 1 : 0);
    return grip_force_ ? 4 : 3;
}

drivers::process::Description DhdDevice::description() const {
    unsigned short serial = 0;
    const bool has_serial = dhd_.serial(&serial, id_) >= 0 && serial != 0;
    static constexpr DhdModel unknown{0, "",   4, 0,
                                      0, 0.03, 0, "not known to Knurl: 4 N and a ball of 30 mm assumed"};
    const DhdModel* found = dhd_model(dhd_.type(id_));
    const DhdModel& model = found == nullptr ? unknown : *found;

    drivers::LinkConfig link;
    link.name = found == nullptr ? "dhd" : short_name(model);
    link.serial = has_serial ? std::to_string(serial) : "";
    link.description = name_and_source(model, found != nullptr);
    const int joints = 3 + (wrist_ ? 3 : 0) + (gripper_ ? 1 : 0);
    link.sensed_joints = joints;
    link.actuated_joints = driven_joints(joints);
    link.senses_orientation = wrist_;
    link.renders_torque = torque_;
    link.radians_per_count.assign(static_cast<std::size_t>(joints), 0);
    for (std::size_t i = 0; i < 3; ++i) link.radians_per_count[i] = model.resolution;
    for (int i = 0; i < link.actuated_joints; ++i) link.effort_limit.push_back(effort_limit(model, i));
    link.workspace_radius = model.radius;
    link.peak_force = link.continuous_force = model.force;
    link.peak_torque = torque_ ? model.torque : 0;
    link.damping = 0.5;  // N s/m, low
    // A cycle of the USB exchange for the order, one for the sample, and the hop between the processes.
    link.lag = 2 / arguments_.setting("rate", 4000) + 0.5e-3 + 20e-6;
    link.has_watchdog = watchdog_ > 0;
    link.watchdog_time = watchdog_;
    link.has_brake = true;
    return drivers::process::description_of(link, {.wrist = wrist_ ? 1 : 0, .gripper = gripper_joint()},
                                            true);
}

}  // namespace

std::unique_ptr<Backend> open_dhd(const Arguments& arguments) {
    return std::make_unique<DhdDevice>(arguments);
}

Survey survey_dhd(const std::string& library) {
    const Dhd dhd(library);
    Survey survey{.version = version_of(dhd), .devices = {}};
    const int count = dhd.count();
    for (int i = 0; i < count; ++i)
        survey.devices.push_back({.name = "device " + std::to_string(i), .serial = "", .problem = ""});
    return survey;
}

}  // namespace knurl::device
