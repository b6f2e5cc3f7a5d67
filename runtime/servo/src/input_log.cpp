#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <knurl/servo/input_log.hpp>

namespace knurl::servo {

namespace {

static_assert(offsetof(CycleInput, velocity) == log_slot_payload);
static_assert(max_input_record / log_slot_payload < 0xffff);

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) noexcept {
    for (int i = 0; i < 8; ++i) hash = (hash ^ ((value >> (8 * i)) & 0xff)) * 0x100000001b3;  // FNV-1a
    return hash;
}
constexpr std::uint64_t mix_begin = 0xcbf29ce484222325;

}  // namespace

std::uint64_t input_log_layout() noexcept {
    std::uint64_t hash = mix_begin;
    for (const std::uint64_t value :
         {std::uint64_t{sizeof(CycleInput)}, std::uint64_t{sizeof(InputLogHeader)},
          std::uint64_t{sizeof(ClaimTerms)}, std::uint64_t{offsetof(ClaimTerms, resets)},
          std::uint64_t{sizeof(ServoOptions)}, std::uint64_t{log_slot_bytes}, std::uint64_t{input_log_slots},
          static_cast<std::uint64_t>(InputType::asset_forgotten),
          std::uint64_t{sizeof(protocol::AssetDigest)}})
        hash = mix(hash, value);
    return hash;
}

std::uint64_t figures_of(const drivers::Device& device) {
    const drivers::LinkConfig& link = device.link();
    std::uint64_t hash = mix_begin;
    const auto number = [&hash](double value) {
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        hash = mix(hash, bits);
    };
    const auto numbers = [&](const auto& values) { std::for_each(values.begin(), values.end(), number); };
    for (const int value : {link.sensed_joints, link.actuated_joints, int{link.senses_orientation},
                            int{link.renders_torque}, device.mechanism().joints()})
        hash = mix(hash, static_cast<std::uint64_t>(value));
    numbers(link.radians_per_count);
    numbers(link.effort_limit);
    numbers(link.joint_least);
    numbers(link.joint_greatest);
    numbers(link.workspace_centre);
    numbers(std::initializer_list<double>{link.workspace_radius, link.peak_force, link.continuous_force,
                                          link.peak_torque, link.damping, link.rotational_damping, link.lag,
                                          link.measured_max_stiffness, link.grip_damping,
                                          link.apparent_mass});
    // A mechanism cannot be compared by parameters, so its tip positions in a few postures are hashed.
    const auto joints =
        static_cast<std::size_t>(std::clamp(device.mechanism().joints(), 0, drivers::max_joints));
    for (int posture = 0; posture < 4; ++posture) {
        drivers::JointArray q = {};
        for (std::size_t i = 0; i < joints; ++i) q[i] = 0.1 * posture + 0.03 * static_cast<double>(i);
        drivers::TipPose pose;
        drivers::Jacobian jacobian = drivers::Jacobian::Zero();
        const bool there =
            device.mechanism().forward(std::span<const double>(q.data(), joints), pose, jacobian);
        hash = mix(hash, there ? 1 : 0);
        if (!there) continue;
        std::for_each(pose.position.data(), pose.position.data() + 3, number);
        std::for_each(jacobian.data(), jacobian.data() + jacobian.size(), number);
    }
    return hash;
}

InputLog::InputLog(std::byte* memory, const InputLogHeader& header)
    : log_((std::memcpy(memory, &header, sizeof header), memory + input_log_header_bytes), input_log_slots) {
    static_assert(sizeof(InputLogHeader) <= input_log_header_bytes);
}

void InputLog::put(InputType type, std::initializer_list<std::span<const std::byte>> parts) noexcept {
    log_.put(static_cast<std::uint16_t>(type), parts);
}

std::uint64_t InputLog::written(const std::byte* memory) {
    return RecordLog::written(memory + input_log_header_bytes, input_log_slots);
}

InputLogReader::InputLogReader(const std::byte* memory, std::uint64_t from)
    : memory_(memory), log_(memory + input_log_header_bytes, input_log_slots, from, max_input_record) {}

InputLogHeader InputLogReader::header() const {
    InputLogHeader header;
    std::memcpy(&header, memory_, sizeof header);
    return header;
}

InputLogReader::Next InputLogReader::next(InputRecord& out) {
    const Next found = log_.next(record_);
    if (found != Next::record) return found;
    out.type = static_cast<InputType>(record_.type);
    std::swap(out.bytes, record_.bytes);
    return found;
}

}  // namespace knurl::servo
