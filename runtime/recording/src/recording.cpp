#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <knurl/messages/cdr.hpp>
#include <knurl/messages/channels.hpp>
#include <knurl/messages/messages.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/recording/recording.hpp>
#include <knurl/servo/asset_digest.hpp>
#include <knurl/servo/config.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::recording {

namespace {

constexpr const char* former_report_topic = "/knurl/report";  // up to November 2026
constexpr const char* inputs_topic = "/knurl/inputs";
constexpr const char* page_topic = "/knurl/scene";
constexpr const char* meshes_topic = "/knurl/mesh";
constexpr const char* metadata_name = "knurl";
constexpr const char* missing_name = "knurl missing";
constexpr std::size_t longest_word = 256;  // bytes of what the metadata says
constexpr const char* asset_media_type = "application/x-knurl-asset";

std::string asset_name(const protocol::AssetDigest& digest) {
    return fmt::format("asset-{:02x}", fmt::join(digest, ""));
}

/// All options: one that is missing here would be missing in a replay.
template <class Visit>
void each_option(servo::ServoOptions& options, Visit visit) {
    static_assert(sizeof(servo::ServoOptions) == 192, "a new option belongs here");
    visit("rate", options.rate);
    visit("max_dt", options.max_dt);
    visit("silence", options.silence);
    visit("start_active", options.start_active);
    visit("clamp_stiffness", options.clamp_stiffness);
    visit("budget", options.budget);
    visit("rise_speed", options.rise_speed);
    visit("automatic_recovery", options.automatic_recovery);
    servo::SupervisorLimits& limits = options.supervisor;
    visit("limits.peak_force", limits.peak_force);
    visit("limits.continuous_force", limits.continuous_force);
    visit("limits.peak_torque", limits.peak_torque);
    visit("limits.thermal_time", limits.thermal_time);
    visit("limits.slew", limits.slew);
    visit("limits.slew_fault_time", limits.slew_fault_time);
    visit("limits.speed_damping_from", limits.speed_damping_from);
    visit("limits.speed_fault", limits.speed_fault);
    visit("limits.speed_damping", limits.speed_damping);
    visit("limits.power", limits.power);
    visit("limits.power_time", limits.power_time);
    visit("limits.ramp_up", limits.ramp_up);
    visit("limits.ramp_down", limits.ramp_down);
    visit("limits.claim_ramp", limits.claim_ramp);
    visit("limits.arm_speed", limits.arm_speed);
    visit("limits.stall", limits.stall);
    visit("limits.clock_jump", limits.clock_jump);
    visit("limits.workspace_margin", limits.workspace_margin);
    visit("limits.off", limits.off);
}

McapMetadata metadata_of(RecordingInfo info) {
    McapMetadata all{{"version", info.version},
                     {"wire", fmt::format("{:016x}", info.wire)},
                     {"tape", fmt::format("{:016x}", info.input_log_layout)},
                     {"device_figures", fmt::format("{:016x}", info.figures)},
                     {"servo", info.servo},
                     {"device", info.device},
                     {"address", info.address},
                     {"profile", info.profile},
                     {"realtime_offset_ns", std::to_string(info.realtime_offset_ns)}};
    if (!info.cause.empty()) {
        all["cause"] = info.cause;
        all["assets"] = "of a flight record: reports alone, shapes that were felt are not in it";
    }
    // 17 digits reproduce every double exactly.
    each_option(info.options, [&](const char* name, auto& value) {
        if constexpr (std::is_same_v<decltype(value), bool&>)
            all[name] = value ? "true" : "false";
        else
            all[name] = fmt::format("{:.17g}", value);
    });
    return all;
}

RecordingInfo info_of(const McapMetadata& all, const std::string& path) {
    // Programs print it, and a file may hold any character.
    const auto text = [&](const std::string& name) {
        const auto found = all.find(name);
        if (found == all.end())
            throw std::runtime_error(
                fmt::format("{}: its metadata has no '{}': the file was changed", path, name));
        return words::printable(found->second, longest_word);
    };
    const auto number = [&](const std::string& name, auto& value, auto... base) {
        const std::string digits = text(name);
        const char* end = digits.data() + digits.size();
        if (std::from_chars(digits.data(), end, value, base...).ptr != end || digits.empty())
            throw std::runtime_error(
                fmt::format("{}: its metadata says {} = '{}', which is no number: the file was changed", path,
                            name, digits));
    };
    RecordingInfo info;
    info.version = text("version");
    info.servo = text("servo");
    info.device = text("device");
    info.address = text("address");
    info.profile = text("profile");
    if (all.count("cause") > 0) info.cause = text("cause");
    number("wire", info.wire, 16);
    number("tape", info.input_log_layout, 16);
    number("device_figures", info.figures, 16);
    number("realtime_offset_ns", info.realtime_offset_ns);
    each_option(info.options, [&](const char* name, auto& value) {
        if constexpr (std::is_same_v<decltype(value), bool&>)
            value = text(name) == "true";
        else
            number(name, value);
    });
    // All times of a replay are counted by it.
    if (const auto& rate = servo::ranges::rate;
        !(info.options.rate >= rate.low && info.options.rate <= rate.high))
        throw std::runtime_error(
            fmt::format("{}: its metadata says rate = {:g}, no servo's ({:g} to {:g} Hz): "
                        "the file was changed",
                        path, info.options.rate, rate.low, rate.high));
    return info;
}

// A report lies in its message as it lies in memory.
constexpr std::size_t report_at = std::size(messages::CdrWriter::encapsulation);

/// The header of a message of inputs.
struct InputHead {
    std::uint16_t type = 0;  // servo::InputType; 0: a gap
    std::uint16_t reserved[3] = {};
};
static_assert(sizeof(InputHead) == 8);

}  // namespace

RecordingWriter::RecordingWriter(const std::string& path, const RecordingInfo& info, Existing existing)
    : file_(path, "Knurl " + info.version, existing),
      offset_(info.realtime_offset_ns),
      channels_(file_, info.device, info.joints) {
    inputs_ = file_.add_channel(inputs_topic, "knurl", nullptr);
    page_ = file_.add_channel(page_topic, "json", nullptr);
    meshes_ = file_.add_channel(meshes_topic, "knurl", nullptr);
    file_.add_metadata(metadata_name, metadata_of(info));
}

void RecordingWriter::report(const Report& report) {
    channels_.write(report, report.read_ns + offset_);
}

void RecordingWriter::scene(Scene form, std::int64_t read_ns, std::span<const std::byte> message) {
    const std::uint16_t channel = form == Scene::page   ? page_
                                  : form == Scene::mesh ? meshes_
                                                        : channels_.number(messages::Channel::scene);
    file_.message(channel, read_ns + offset_, message, {});
}

void RecordingWriter::input(const servo::InputRecord& record) {
    if (record.type == servo::InputType::cycle &&
        record.bytes.size() >= offsetof(servo::CycleInput, write_ns))
        std::memcpy(&last_, record.bytes.data() + offsetof(servo::CycleInput, now), sizeof last_);
    const InputHead head{.type = static_cast<std::uint16_t>(record.type)};
    file_.message(inputs_, last_ + offset_, std::as_bytes(std::span(&head, 1)), record.bytes);
}

void RecordingWriter::gap() {
    const InputHead head;
    file_.message(inputs_, last_ + offset_, std::as_bytes(std::span(&head, 1)), {});
}

bool RecordingWriter::flush() {
    const std::uint64_t pending = file_.pending();
    if (file_.flush()) return true;
    dropped_ += pending;
    gap();
    return false;
}

bool RecordingWriter::asset(const protocol::AssetDigest& digest, std::span<const std::byte> source,
                            const std::function<void()>& between) {
    if (has(digest)) return true;
    if (!file_.attach(asset_name(digest), asset_media_type, last_ + offset_, source, between)) {
        ++dropped_;
        return false;
    }
    assets_.insert(digest);
    missing_.erase(digest);
    return true;
}

bool RecordingWriter::finish() {
    bool whole = flush();
    McapMetadata gone;
    for (const protocol::AssetDigest& digest : missing_)
        gone[asset_name(digest)] = "was felt, and is not in this file";
    try {
        if (whole && !gone.empty()) file_.add_metadata(missing_name, gone);
    } catch (const std::runtime_error&) {  // the disk is full
        whole = false;
    }
    return whole && file_.finish();
}

RecordingReader::RecordingReader(McapReader file, const std::string& path)
    : path_(path), file_(std::move(file)) {
    const McapMetadata* metadata = file_.metadata(metadata_name);
    if (metadata == nullptr)
        throw std::runtime_error(
            file_.cut_off_at()
                ? path + ": cut off before anything was recorded"
                : path + ": an MCAP file, but none that knurl record made (it has no metadata 'knurl')");
    info_ = info_of(*metadata, path);
    reports_ = file_.channel(messages::topic(messages::Channel::report, info_.device));
    if (reports_ == 0) reports_ = file_.channel(former_report_topic);
    inputs_ = file_.channel(inputs_topic);
    // Any build with the same report reads the reports; the servo's internal state is only for replay.
    if (file_.library() != "Knurl " + info_.version)
        throw std::runtime_error(path +
                                 ": its header and its metadata name two versions: the file was changed");
}

std::vector<std::byte> RecordingReader::asset(const protocol::AssetDigest& digest) {
    auto source = file_.attachment(asset_name(digest));
    if (!source)
        throw std::runtime_error(
            fmt::format("an application sent a shape here, {}, which is not in the recording: it replays up "
                        "to this place",
                        asset_name(digest)));
    if (servo::digest_of(*source) != digest)
        throw std::runtime_error(
            fmt::format("{} is not what its name says: the file was changed", asset_name(digest)));
    return *std::move(source);
}

void RecordingReader::require_this_build() const {
    if (!info_.cause.empty())
        throw std::runtime_error(
            path_ + ": a flight record's reports alone, which do not replay; --csv and --scene take them");
    if (info_.version == KNURL_VERSION && info_.wire == protocol::wire_hash() &&
        info_.input_log_layout == servo::input_log_layout())
        return;
    throw std::runtime_error(fmt::format(
        "{}: made by Knurl {} (layout {:016x}-{:016x}), this is {} ({:016x}-{:016x}); replay it with the "
        "build that made it",
        path_, info_.version, info_.wire, info_.input_log_layout, KNURL_VERSION, protocol::wire_hash(),
        servo::input_log_layout()));
}

RecordingReader::Item RecordingReader::next() {
    McapReader::Message message;
    const auto changed = [this] {
        return std::runtime_error(
            path_ +
            ": a message has the wrong length: the file was changed, or made by another "
            "version");
    };
    while (file_.next(message)) {
        if (message.channel == reports_) {
            if (message.data.size() != report_at + sizeof report) throw changed();
            std::memcpy(&report, message.data.data() + report_at, sizeof report);
            return Item::report;
        }
        if (message.channel != inputs_) continue;
        InputHead head;
        if (message.data.size() < sizeof head) throw changed();
        std::memcpy(&head, message.data.data(), sizeof head);
        if (head.type == 0) return Item::gap;
        input.type = static_cast<servo::InputType>(head.type);
        input.bytes.assign(message.data.begin() + sizeof head, message.data.end());
        return Item::input;
    }
    return Item::end;
}

}  // namespace knurl::recording
