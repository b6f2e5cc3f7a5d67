#pragma once

/// @file
/// A device behind a process of its own (knurl-device), because only its maker's library can talk to it: what
/// the servo and that process share, and the process's end of it. drivers/README.md, "Behind a process".
///
///     servo:  read <── Newest<Sample> ──┐           ┌── the maker's library <── device
///             write ── Newest<Order> ───┴── lane ───┴── the maker's library ──> device
///                 └─ bell (futex)
///     guardian: acts += 1, bell
///
/// Each process that is started gets a lane of the mapping to itself. So one that was killed in the middle of
/// a word leaves nothing half done to the next, and the guardian's copy of the mapping holds for all of them.

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>

#include <knurl/drivers/device.hpp>
#include <knurl/drivers/newest.hpp>

namespace knurl::drivers::process {

/// Without an order for so long the process gives zero (ns).
inline constexpr Nanoseconds silence = 5'000'000;
/// Lanes of a mapping: a process that is started uses the next one.
inline constexpr unsigned lanes = 4;
/// Descriptor that a knurl-device inherits: the mapping.
inline constexpr int mapping_fd = 3;
/// Descriptor that a knurl-device inherits: a pidfd of its servo.
inline constexpr int servo_fd = 4;
/// Orders whose time under way is kept.
inline constexpr std::size_t kept_hops = 1024;

/// CLOCK_MONOTONIC (ns).
Nanoseconds monotonic() noexcept;

/// How the joints of such a device are its tip: CartesianTool.
struct ToolShape {
    /// 1: three joints are the rotation vector of the tip's orientation.
    std::int32_t wrist = 0;
    /// Joint that is the gripper's gap (m); -1: it has none.
    std::int32_t gripper = -1;
};

/// A LinkConfig and a ToolShape as plain bytes.
struct Description {
    /// LinkConfig::name.
    std::array<char, 64> name;
    /// LinkConfig::serial.
    std::array<char, 64> serial;
    /// LinkConfig::description.
    std::array<char, 512> text;
    /// LinkConfig::radians_per_count.
    std::array<double, max_joints> radians_per_count;
    /// LinkConfig::effort_limit.
    std::array<double, max_joints> effort_limit;
    /// LinkConfig::joint_least.
    std::array<double, max_joints> joint_least;
    /// LinkConfig::joint_greatest.
    std::array<double, max_joints> joint_greatest;
    /// LinkConfig::workspace_centre.
    std::array<double, 3> workspace_centre;
    /// LinkConfig::workspace_radius.
    double workspace_radius;
    /// LinkConfig::nominal_rate.
    double nominal_rate;
    /// LinkConfig::peak_force.
    double peak_force;
    /// LinkConfig::continuous_force.
    double continuous_force;
    /// LinkConfig::peak_torque.
    double peak_torque;
    /// LinkConfig::damping.
    double damping;
    /// LinkConfig::rotational_damping.
    double rotational_damping;
    /// LinkConfig::lag.
    double lag;
    /// LinkConfig::measured_max_stiffness.
    double measured_max_stiffness;
    /// LinkConfig::grip_damping.
    double grip_damping;
    /// LinkConfig::apparent_mass.
    double apparent_mass;
    /// LinkConfig::watchdog_time.
    double watchdog_time;
    /// LinkConfig::sensed_joints.
    std::int32_t sensed_joints;
    /// LinkConfig::actuated_joints.
    std::int32_t actuated_joints;
    /// LinkConfig::senses_orientation.
    std::int32_t senses_orientation;
    /// LinkConfig::renders_torque.
    std::int32_t renders_torque;
    /// LinkConfig::has_watchdog.
    std::int32_t has_watchdog;
    /// LinkConfig::has_brake.
    std::int32_t has_brake;
    /// Device::has_buttons.
    std::int32_t has_buttons;
    /// The mechanism.
    ToolShape shape;
};

/// As bytes; texts that are too long are cut.
Description description_of(const LinkConfig& link, const ToolShape& shape, bool has_buttons);
/// Back from bytes. Throws std::runtime_error if they make no sense: the process that wrote them runs other people's
/// code.
LinkConfig link_of(const Description& description);

/// What the servo wants.
struct Order {
    /// Efforts of the joints (N, N m).
    JointEfforts efforts = {};
    /// Shared::acts when the sample that this answers was read. An order from before the last act counts as zero.
    std::uint64_t acts = 0;
    /// When it was written: CLOCK_MONOTONIC (ns).
    Nanoseconds written = 0;
    /// On which CPU; -1: not known. The process keeps off it.
    std::int32_t cpu = -1;
};

/// What the device is.
struct Sample {
    /// The joints.
    JointSample joints;
    /// When the library returned them: CLOCK_MONOTONIC (ns).
    Nanoseconds taken = 0;
};

/// How far a process has come.
enum class LaneState : std::uint32_t {
    /// It looks for the device.
    starting,
    /// The description is there, samples come.
    ready,
    /// It could not, and `message` says why. The process ends.
    failed,
};

/// What one process shares with the servo.
struct Lane {
    /// From the servo.
    Newest<Order> orders;
    /// To the servo.
    Newest<Sample> samples;
    /// LaneState. Release after description and message, acquire in the servo.
    alignas(64) std::atomic<std::uint32_t> state = 0;
    /// Rises as long as the library's calls return.
    std::atomic<std::uint64_t> beat = 0;
    /// What the library gave that cannot be a sample, or refused: the servo counts it as bad.
    std::atomic<std::uint64_t> garbage = 0;
    /// Orders taken in all; their times under way (ns) are kept in a ring.
    std::atomic<std::uint64_t> hops = 0;
    /// Times under way, from write() to the call of the library (ns).
    std::array<std::atomic<std::uint32_t>, kept_hops> hop = {};
    /// What the device is.
    Description description = {};
    /// Why there is none.
    std::array<char, 512> message = {};
};

/// The mapping.
struct Shared {
    /// The build: size of all this.
    std::uint64_t size = sizeof(Shared);
    /// Changes when there is something to look at; a futex.
    alignas(64) std::atomic<std::uint32_t> bell = 0;
    /// 1: somebody waits for the bell.
    std::atomic<std::uint32_t> waits = 0;
    /// How often somebody asked for zero.
    std::atomic<std::uint64_t> acts = 0;
    /// 1: the cycle has begun; before that nothing is sent to the device.
    std::atomic<std::uint32_t> awake = 0;
    /// 1: zero, close, end.
    std::atomic<std::uint32_t> leave = 0;
    /// One of them is in use.
    std::array<Lane, lanes> lane;
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free &&
              std::atomic<std::uint64_t>::is_always_lock_free);

/// Says that there is something to look at. Never waits.
void ring(Shared& shared) noexcept;

/// The process's end. One thread uses it, but for leave().
class Exchange {
  public:
    /// Maps the inherited descriptor `mapping`. Throws std::runtime_error: it is no mapping of this build.
    Exchange(int mapping, unsigned lane);
    ~Exchange();
    Exchange(const Exchange&) = delete;
    Exchange& operator=(const Exchange&) = delete;

    /// The device is open. The servo hears of it with the first sample.
    void ready(const Description& description) noexcept;
    /// It is not, or is no longer: one line, what was wrong and what to do.
    void failed(std::string_view why) noexcept;
    /// True: zero the device, close it, end.
    bool leaving() const noexcept;
    /// From any thread: from now on leaving().
    void leave() noexcept;
    /// False: the servo's cycle has not begun, so nothing may be sent to the device.
    bool awake() const noexcept;

    /// What the device is to give now: the newest order, or zero after `silence` without one, after an act of the
    /// guardian, and before the first sample was read.
    JointEfforts efforts(Nanoseconds now) noexcept;
    /// A sample.
    void publish(const JointSample& joints, Nanoseconds taken) noexcept;
    /// The library gave nonsense, or refused to give force.
    void garbage() noexcept;
    /// The library's calls return.
    void beat() noexcept;
    /// Until something new is there, or the time has come.
    void wait(Nanoseconds until) noexcept;

  private:
    static constexpr Nanoseconds spin =
        60'000;  // before and after an order is due: a wake-up takes longer than this
    static constexpr Nanoseconds longest_period = 5'000'000;

    void note(const Order& next) noexcept;
    bool spin_until(Nanoseconds end) const noexcept;

    Shared* shared_;
    Lane* lane_;
    Nanoseconds period_ = 0;  // between the last two orders; 0: they do not come regularly
    int cpu_ = -1;            // the servo's
    int moved_ = 0;           // off it
    Order order_;
    bool ordered_ = false;     // an order has come
    bool told_ = false;        // that it is ready
    std::uint32_t heard_ = 0;  // bell
    std::atomic<bool> leave_ = false;
};

}  // namespace knurl::drivers::process
