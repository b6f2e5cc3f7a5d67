// OpenHaptics' device interface, libHD. The functions are declared from the documentation, as bindings in other languages
// (pyOpenHaptics) repeat it. The library's own scheduler calls us, usually at 1 kHz; that call is the loop.

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <ctime>

#include <Eigen/Geometry>

#include <knurl/drivers/cartesian_tool.hpp>

#include "backend.hpp"
#include "library.hpp"

namespace knurl::device {

namespace {

using drivers::JointEfforts;
using drivers::JointSample;
using drivers::Nanoseconds;
using drivers::process::Exchange;
using drivers::process::monotonic;

namespace hd {

// Numbers of the documentation.
constexpr unsigned success = 0, warm_motors = 0x0200, over_force = 0x0201, over_impulse = 0x0202,
                   over_velocity = 0x0203, force_error = 0x0204, device_fault = 0x0300, comm_error = 0x0302,
                   comm_config = 0x0303, timer_error = 0x0304, bad_handle = 0x0104, already = 0x0301;
constexpr unsigned invalid_handle = 0xffffffff;
constexpr unsigned buttons = 0x2000, inkwell = 0x2002, position = 0x2050, transform = 0x2052,
                   version = 0x2500, model = 0x2501, serial = 0x2504, usable_workspace = 0x2551,
                   input_dof = 0x2553, output_dof = 0x2554, calibration_style = 0x2555, update_rate = 0x2600,
                   max_force = 0x2603, max_continuous = 0x2604, temperature = 0x2605, max_torque = 0x2622,
                   force = 0x2700, torque = 0x2701, force_output = 0x4000;
constexpr unsigned calibrated = 0x5000, needs_update = 0x5001;
constexpr int style_encoder_reset = 1;
constexpr unsigned callback_done = 0, callback_again = 1;
constexpr unsigned short highest_priority = 0xffff;

struct Error {
    unsigned code;
    int internal;
    unsigned device;
};

}  // namespace hd

/// The functions that are used.
struct Hd {
    Library library;

    unsigned (*init)(const char*);
    void (*disable_device)(unsigned);
    void (*make_current)(unsigned);
    hd::Error (*error)();
    void (*enable)(unsigned);
    void (*start)();
    void (*stop)();
    unsigned long (*schedule)(unsigned (*)(void*), void*, unsigned short);
    void (*unschedule)(unsigned long);
    void (*begin)(unsigned);
    void (*end)(unsigned);
    void (*doubles)(unsigned, double*);
    void (*integers)(unsigned, int*);
    const char* (*text)(unsigned);
    void (*set_doubles)(unsigned, const double*);
    unsigned (*check_calibration)();
    void (*update_calibration)(unsigned);
    unsigned char (*is_enabled)(unsigned);

    explicit Hd(const std::string& path) : library(path) {
        library.need("hdInitDevice", init);
        library.need("hdDisableDevice", disable_device);
        library.need("hdMakeCurrentDevice", make_current);
        library.need("hdGetError", error);
        library.need("hdEnable", enable);
        library.need("hdIsEnabled", is_enabled);
        library.need("hdStartScheduler", start);
        library.need("hdStopScheduler", stop);
        library.need("hdScheduleAsynchronous", schedule);
        library.need("hdUnschedule", unschedule);
        library.need("hdBeginFrame", begin);
        library.need("hdEndFrame", end);
        library.need("hdGetDoublev", doubles);
        library.need("hdGetIntegerv", integers);
        library.need("hdGetString", text);
        library.need("hdSetDoublev", set_doubles);
        library.need("hdCheckCalibration", check_calibration);
        library.need("hdUpdateCalibration", update_calibration);
    }
};

std::string meaning(unsigned code) {
    switch (code) {
        case hd::bad_handle:
            return "there is no such device";
        case hd::device_fault:
            return "the device reports a fault";
        case hd::already:
            return "another program has it open";
        case hd::comm_error:
            return "it does not answer";
        case hd::comm_config:
            return "it is not set up";
        case hd::timer_error:
            return "the library's timer does not run";
        default: {
            std::array<char, 32> text{};
            std::snprintf(text.data(), text.size(), "error 0x%04x", code);
            return text.data();
        }
    }
}

/// Out of the library's axes (x right, y up, z towards the user) into Knurl's, and back: the map of the gateway's
/// frames.hpp, which a test compares.
Eigen::Vector3d from_hd(const double* v) {
    return {v[2], v[0], v[1]};
}
std::array<double, 3> to_hd(const Eigen::Vector3d& v) {
    return {v.y(), v.z(), v.x()};
}

void sleep_ms(long ms) {
    const timespec t{.tv_sec = 0, .tv_nsec = ms * 1'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, 0, &t, nullptr);
}

class HdDevice final : public Backend {
  public:
    explicit HdDevice(const Arguments& arguments) : hd_(arguments.library) {
        const std::string name = arguments.name;
        handle_ = hd_.init(name.empty() ? nullptr : name.c_str());
        const hd::Error error = hd_.error();
        if (handle_ == hd::invalid_handle || error.code != hd::success)
            throw std::runtime_error(
                (name.empty() ? "the default device" : "device \"" + name + "\"") + ": " +
                meaning(error.code) +
                "; give it this name with the maker's Touch_Setup, run Touch_Diagnostic, and let "
                "this user open it (ls -l /dev/ttyACM* /dev/hidraw*, the maker's udev rule)");
        hd_.make_current(handle_);
        figure();
    }
    ~HdDevice() override {
        if (scheduled_) {
            ending_.store(true);
            for (int waited = 0; !ended_.load() && waited < 40; ++waited) sleep_ms(5);
            hd_.stop();
            hd_.unschedule(callback_);
        }
        hd_.disable_device(handle_);
    }
    HdDevice(const HdDevice&) = delete;
    HdDevice& operator=(const HdDevice&) = delete;

    drivers::process::Description description() const override;

    void run(Exchange& exchange) override {
        exchange_ = &exchange;
        hd_.enable(hd::force_output);
        callback_ = hd_.schedule([](void* self) { return static_cast<HdDevice*>(self)->frame(); }, this,
                                 hd::highest_priority);
        hd_.start();
        scheduled_ = true;
        const hd::Error error = hd_.error();
        if (error.code != hd::success) throw Gone("its scheduler does not start: " + meaning(error.code));
        for (int count = 0; !exchange.leaving(); ++count) {
            sleep_ms(5);
            if (const unsigned code = gone_.load(); code != 0)
                throw Gone("the device is gone: " + meaning(code));
            if (count % 20 == 0) look_at_calibration();
            say_warmth();
        }
    }

  private:
    static constexpr Nanoseconds rest_first = 100'000'000;  // of zero orders, before forces come on again
    static constexpr int most_errors = 20;                  // in a row

    void figure() {
        int value[2] = {3, 3};
        hd_.integers(hd::input_dof, &value[0]);
        hd_.integers(hd::output_dof, &value[1]);
        wrist_ = value[0] >= 6;
        torque_ = wrist_ && value[1] >= 6;
        look_at_calibration();
    }
    /// On the thread that has the device current; not in the loop, since it may take long.
    void look_at_calibration() {
        unsigned state = hd_.check_calibration();
        int style = 0;
        hd_.integers(hd::calibration_style, &style);
        // The encoders' reset is the user's to ask for: where the arm stands then becomes its zero.
        if (state == hd::needs_update && (style & hd::style_encoder_reset) == 0) {
            hd_.update_calibration(static_cast<unsigned>(style));
            state = hd_.check_calibration();
        }
        calibrated_.store(state == hd::calibrated);
    }
    void say_warmth() {
        if (!warm_.exchange(false) || monotonic() - warned_ < 10'000'000'000) return;
        warned_ = monotonic();
        double warmest = 0;
        for (const auto& motor : temperature_) warmest = std::max(warmest, motor.load());
        std::fprintf(stderr,
                     "knurl-device: hd: the motors are warm (%.2f of what they stand); let them rest\n",
                     warmest);
    }

    /// Called by the scheduler: one exchange with the device.
    unsigned frame() noexcept {
        hd_.make_current(handle_);
        hd_.begin(handle_);
        JointSample sample;
        const bool sense = read(sample);
        const bool leaving = ending_.load();
        JointEfforts efforts{};
        if (exchange_->awake()) {
            if (!leaving) efforts = exchange_->efforts(monotonic());
            if (efforts != JointEfforts{}) pushed_ = monotonic();
            give(efforts);
        }
        hd_.end(handle_);
        if (!heed_errors()) return hd::callback_done;
        if (leaving) {
            ended_.store(true);
            return hd::callback_done;
        }
        if (sense)
            exchange_->publish(sample, monotonic());
        else
            exchange_->garbage();
        return hd::callback_again;
    }
    bool read(JointSample& sample) noexcept {
        std::array<double, 3> at{};
        hd_.doubles(hd::position, at.data());
        const Eigen::Vector3d position = from_hd(at.data()) * 1e-3;
        for (int i = 0; i < 3; ++i) sample.position[static_cast<std::size_t>(i)] = position[i];
        if (wrist_ && !turned(sample)) return false;
        int value = 0;
        hd_.integers(hd::buttons, &value);
        sample.buttons = static_cast<std::uint32_t>(value) & 0xfU;
        value = 0;
        hd_.integers(hd::inkwell, &value);
        if (value != 0) sample.buttons |= inkwell_button;
        sample.calibrated = calibrated_.load();
        std::array<double, 8> warmth{};
        if (++frames_ % 100 == 1) {
            hd_.doubles(hd::temperature, warmth.data());
            for (std::size_t i = 0; i < temperature_.size(); ++i) temperature_[i] = warmth[i];
        }
        return position.allFinite();
    }
    /// From the transform, whose columns lie one after the other.
    bool turned(JointSample& sample) noexcept {
        std::array<double, 16> columns{};
        hd_.doubles(hd::transform, columns.data());
        const Eigen::Map<const Eigen::Matrix4d> matrix(columns.data());
        const Eigen::Matrix3d theirs = matrix.topLeftCorner<3, 3>();
        if (!(std::abs(theirs.determinant() - 1) < 1e-3)) return false;
        Eigen::Matrix3d axes;  // theirs to ours
        axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
        const Eigen::Quaterniond ours(Eigen::Matrix3d(axes * theirs * axes.transpose()));
        turn_ = drivers::CartesianTool::rotation_near(ours.normalized(), turn_);
        for (int i = 0; i < 3; ++i) sample.position[static_cast<std::size_t>(3 + i)] = turn_[i];
        return true;
    }
    void give(const JointEfforts& efforts) noexcept {
        const std::array<double, 3> force = to_hd({efforts[0], efforts[1], efforts[2]});
        hd_.set_doubles(hd::force, force.data());
        if (!torque_) return;
        const Eigen::Vector3d wanted(efforts[3], efforts[4], efforts[5]);
        const Eigen::Vector3d torque =
            wanted.isZero(0)
                ? wanted
                : Eigen::Vector3d(drivers::CartesianTool::left_jacobian(turn_).transpose().inverse() *
                                  wanted);
        const std::array<double, 3> theirs = to_hd(torque * 1e3);  // mN m
        hd_.set_doubles(hd::torque, theirs.data());
    }
    /// False: the device is gone.
    bool heed_errors() noexcept {
        bool off = hd_.is_enabled(hd::force_output) == 0;
        for (int i = 0; i < 4; ++i) {
            const hd::Error error = hd_.error();
            if (error.code == hd::success) {
                errors_ = i == 0 ? 0 : errors_;
                break;
            }
            if (error.code == hd::warm_motors) {
                warm_.store(true);
                continue;
            }
            const bool gone = error.code == hd::bad_handle ||
                              (error.code >= hd::device_fault && error.code <= hd::timer_error);
            if (gone || ++errors_ > most_errors) {
                gone_.store(error.code);
                return false;
            }
            off = true;
        }
        if (!off) return true;
        // The library has cut the force: the servo must learn of it. On again only after a rest at zero.
        exchange_->garbage();
        if (monotonic() - pushed_ > rest_first) hd_.enable(hd::force_output);
        return true;
    }

    static constexpr std::uint32_t inkwell_button = 1U << 4;

    Hd hd_;
    unsigned handle_ = hd::invalid_handle;
    unsigned long callback_ = 0;
    bool wrist_ = false, torque_ = false, scheduled_ = false;
    Exchange* exchange_ = nullptr;
    Nanoseconds pushed_ = 0, warned_ = -10'000'000'000;
    int errors_ = 0;
    std::uint64_t frames_ = 0;
    Eigen::Vector3d turn_ = Eigen::Vector3d::Zero();
    std::array<std::atomic<double>, 6> temperature_ = {};
    std::atomic<bool> calibrated_ = false, ending_ = false, ended_ = false, warm_ = false;
    std::atomic<unsigned> gone_ = 0;
};

drivers::process::Description HdDevice::description() const {
    const auto text = [this](unsigned what) {
        const char* said = hd_.text(what);
        return std::string(said == nullptr ? "" : said);
    };
    const auto number = [this](unsigned what) {
        double value = 0;
        hd_.doubles(what, &value);
        return std::isfinite(value) && value > 0 ? value : 0;
    };
    drivers::LinkConfig link;
    const std::string model = text(hd::model);
    for (const char c : model)
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            link.name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (link.name.empty()) link.name = "hd";
    link.serial = text(hd::serial);
    const double peak = number(hd::max_force), continuous = number(hd::max_continuous);
    link.description =
        model + " by OpenHaptics " + text(hd::version) +
        "; forces, workspace and rate as its library states them" +
        (peak > 0 ? "" : " (no peak force: 3.3 N, the Touch's, assumed)") +
        "; resolution 450 dpi assumed; damping, lag and mass not known: a low and a high estimate";
    const int joints = wrist_ ? 6 : 3;
    link.sensed_joints = joints;
    link.actuated_joints = torque_ ? 6 : 3;
    link.senses_orientation = wrist_;
    link.renders_torque = torque_;
    link.radians_per_count.assign(static_cast<std::size_t>(joints), 0);
    for (std::size_t i = 0; i < 3; ++i) link.radians_per_count[i] = 0.0254 / 450;
    link.peak_force = peak > 0 ? peak : 3.3;
    link.continuous_force = continuous > 0 ? std::min(continuous, link.peak_force) : link.peak_force / 4;
    link.peak_torque = torque_ ? std::max(number(hd::max_torque) * 1e-3, 0.05) : 0;
    for (int i = 0; i < link.actuated_joints; ++i)
        link.effort_limit.push_back(i < 3 ? link.peak_force : link.peak_torque);
    std::array<double, 6> box{};  // mm: least, greatest
    hd_.doubles(hd::usable_workspace, box.data());
    const Eigen::Vector3d least = from_hd(box.data()) * 1e-3, greatest = from_hd(box.data() + 3) * 1e-3;
    const double radius = (greatest - least).minCoeff() / 2;
    link.workspace_radius = std::isfinite(radius) && radius > 0.005 ? radius : 0.035;
    if (radius > 0.005)
        for (int i = 0; i < 3; ++i)
            link.workspace_centre[static_cast<std::size_t>(i)] = (least[i] + greatest[i]) / 2;
    int rate = 0;
    hd_.integers(hd::update_rate, &rate);
    link.nominal_rate = rate >= 100 && rate <= 4000 ? rate : 1000;
    link.damping = 0.2;                        // N s/m, low
    link.lag = 2 / link.nominal_rate + 20e-6;  // a cycle of its scheduler each way, and the hop
    return drivers::process::description_of(link, {.wrist = wrist_ ? 1 : 0, .gripper = -1}, true);
}

}  // namespace

std::unique_ptr<Backend> open_hd(const Arguments& arguments) {
    return std::make_unique<HdDevice>(arguments);
}

Survey survey_hd(const std::string& library) {
    const Hd hd(library);
    const char* said = hd.text(hd::version);
    // Which devices there are it tells nobody: they are opened by the names that Touch_Setup gave them.
    return {.version = said == nullptr ? "" : said, .devices = {}};
}

}  // namespace knurl::device
