#include "offline_object.hpp"

#include <cmath>

#include <sys/mman.h>

#include <knurl/reps/all.hpp>
#include <knurl/reps/check.hpp>
#include <knurl/reps/describe.hpp>
#include <knurl/servo/asset_build.hpp>

namespace knurl::capi {

using servo::Offline;
using servo::OfflineClaim;

namespace {

knurl_vec3 to_c(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// Memory of an asset's source, mapped while it is built.
class Mapped {
  public:
    explicit Mapped(const detail::AssetMemory& source)
        : size_(source.bytes),
          at_(::mmap(nullptr, source.bytes, PROT_READ, MAP_SHARED, source.memory.get(), 0)) {
        if (at_ == MAP_FAILED) throw std::bad_alloc();
    }
    ~Mapped() { ::munmap(at_, size_); }
    Mapped(const Mapped&) = delete;
    Mapped& operator=(const Mapped&) = delete;
    std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(at_), size_}; }

  private:
    std::size_t size_;
    void* at_;
};

std::size_t cells_of(std::size_t body) {
    return (sizeof(protocol::CommandHeader) + body + shm::cell_bytes - 1) / shm::cell_bytes;
}

}  // namespace

OfflineObject::OfflineObject(std::string address, const knurl_offline_options& options)
    : Object(its_type), address_(std::move(address)), options_(options) {
    if (!(options.rate >= 1 && options.rate <= 1e6))
        throw Failed(KNURL_BAD_PARAMETERS,
                     "knurl_offline_options: rate = " + std::to_string(options.rate) + " Hz; give 1 to 1e6");
    if (options.representations < 1 || options.representations > max_representations)
        throw Failed(KNURL_BAD_PARAMETERS,
                     "knurl_offline_options: representations = " + std::to_string(options.representations) +
                         "; give 1 to " + std::to_string(max_representations));
    if (!address_.empty() && !address_.starts_with("sim:"))
        throw Failed(KNURL_NO_SUCH_DEVICE,
                     "device '" + address_ +
                         "': only a simulated one can be offline; give sim:PROFILE, for "
                         "instance sim:premium15, or none");
    begin();
}

void OfflineObject::begin() {
    std::unique_ptr<drivers::Device> fresh;  // before anything of the old one goes
    if (!address_.empty()) {
        try {
            fresh = drivers::open_device(address_);
        } catch (const std::exception& error) {
            throw Failed(KNURL_NO_SUCH_DEVICE, error.what());
        }
    }
    servo_.reset();
    device_ = std::move(fresh);
    if (address_.empty()) probe_.emplace(1 / options_.rate);
    drivers::Device& device = probe_ ? static_cast<drivers::Device&>(*probe_) : *device_;
    servo::ServoOptions options = servo::offline_options(options_.rate);
    options.supervisor.off = probe_.has_value();
    servo_ = std::make_unique<Offline>(device, options);
    claim_ = &servo_->claim(
        protocol::ClaimCapacity{.representations = options_.representations,
                                .batch_bytes = protocol::batch_bytes_for(options_.representations)});
    for (std::uint32_t i = 0; i < assets_.size(); ++i)
        servo_->servo().give(&claim_->servo_side(), i + 1, assets_[i].get());
    // Generations go on, so that a name from before stays stale.
    slots_.resize(options_.representations);
    for (Slot& slot : slots_) slot.present = false;
    free_.clear();
    for (std::uint32_t slot = options_.representations; slot-- > 0;) free_.push_back(slot);
    probe0_ = {};
    steps_ = answered_ = cells_ = 0;
    changed_ = false;
}

// One cycle takes so many cells of commands, but all of those before the first.
void OfflineObject::require_room_for(std::size_t cells) {
    const std::size_t room = steps_ == 0 ? std::size_t{claim_->layout().command_cells}
                                         : std::size_t{protocol::command_cells_per_cycle};
    if (cells_ + cells > room)
        throw Failed(KNURL_CHANNEL_FULL,
                     "more is added and removed than one cycle takes in; call knurl_offline_step in between");
    cells_ += cells;
}

// As the client does.
void OfflineObject::require_asset(std::uint32_t kind, std::span<const std::byte> params) const {
    if (kind != kind_of<Shape>) return;
    Shape shape;
    std::memcpy(static_cast<void*>(&shape), params.data(), sizeof shape);
    if (shape.asset > assets_.size())
        throw Failed(KNURL_BAD_PARAMETERS,
                     "asset " + std::to_string(shape.asset) +
                         ": none of that number was sent; knurl_offline_send_mesh gives the "
                         "number");
}

knurl_id OfflineObject::add(std::uint32_t kind, std::span<const std::byte> params,
                            const AddOptions& options) {
    if (const Verdict verdict = check_added(kind, params.data(), params.size(), options); !verdict)
        throw Failed(KNURL_BAD_PARAMETERS, describe(verdict, kind, ""));
    require_asset(kind, params);
    if (free_.empty())
        throw Failed(KNURL_BAD_PARAMETERS,
                     "all " + std::to_string(slots_.size()) +
                         " representations are there; remove one, or open with more (knurl_offline_options)");
    require_room_for(cells_of(sizeof(protocol::AddBody) + params.size()));
    const std::uint32_t place = free_.back();
    Slot& slot = slots_[place];
    claim_->add({.slot = place, .generation = slot.generation + 1}, kind, params.data(), params.size(),
                options);
    free_.pop_back();
    slot = {.generation = slot.generation + 1, .kind = kind, .present = true};
    return std::uint64_t{slot.generation} << 32 | place;
}

OfflineObject::Slot& OfflineObject::named(knurl_id id) {
    const auto place = static_cast<std::uint32_t>(id);
    if (place >= slots_.size() || !slots_[place].present || slots_[place].generation != id >> 32)
        throw Failed(KNURL_STALE, "there is no representation " + std::to_string(id) + "; it was removed");
    return slots_[place];
}

void OfflineObject::set(knurl_id id, std::uint32_t kind, std::span<const std::byte> params) {
    const Slot& slot = named(id);
    if (slot.kind != kind)
        throw Failed(KNURL_BAD_ARGUMENT, "the representation is a " + std::string(kinds()[slot.kind].name) +
                                             ", and the parameters are those of a " +
                                             std::string(kinds()[kind].name));
    if (const Verdict verdict = check_parameters(kind, params.data(), params.size()); !verdict)
        throw Failed(KNURL_BAD_PARAMETERS, describe(verdict, kind, ""));
    require_asset(kind, params);
    claim_->update({.slot = static_cast<std::uint32_t>(id), .generation = slot.generation}, kind,
                   params.data(), params.size());
    changed_ = true;
}

void OfflineObject::remove(knurl_id id) {
    Slot& slot = named(id);
    require_room_for(cells_of(sizeof(protocol::RemoveBody)));
    const auto place = static_cast<std::uint32_t>(id);
    claim_->remove({.slot = place, .generation = slot.generation});
    slot.present = false;
    free_.push_back(place);
}

void OfflineObject::place_probe(std::uint32_t probe, const ProbePlacement& placement) {
    if (const Verdict verdict = check_placement(probe, placement); !verdict)
        throw Failed(KNURL_BAD_PARAMETERS, describe(verdict, nullptr, "place_probe"));
    require_room_for(cells_of(sizeof(protocol::PlaceProbeBody)));
    claim_->place_probe(probe, placement);
    if (probe == 0) probe0_ = placement;
}

std::uint32_t OfflineObject::give(const detail::AssetMemory& source, SentShape& sent) {
    if (assets_.size() >= max_assets)
        throw Failed(KNURL_BAD_PARAMETERS, "there are " + std::to_string(max_assets) +
                                               " assets, as many as can be; open another servo");
    const Mapped mapped(source);
    constexpr std::uint64_t budget = std::uint64_t{4} << 30;
    servo::BuiltAsset built = servo::build_asset(mapped.bytes(), budget);
    assets_.push_back(std::move(built.asset));
    const auto number = static_cast<std::uint32_t>(assets_.size());
    const protocol::AssetReady& ready = built.ready;
    sent = {.asset = number,
            .faces = ready.faces,
            .bytes = ready.bytes,
            .low = {ready.low[0], ready.low[1], ready.low[2]},
            .high = {ready.high[0], ready.high[1], ready.high[2]},
            .notes = ready.notes};
    servo_->servo().give(&claim_->servo_side(), number, assets_.back().get());
    return number;
}

void OfflineObject::check_answers() {
    for (const protocol::Reply& reply : claim_->replies()) {
        ++answered_;
        const Verdict verdict = protocol::verdict_of(reply);
        if (!verdict) throw Failed(KNURL_REFUSED, describe(verdict, reply.kind, "the servo refused"));
    }
}

void OfflineObject::step(const knurl_pose* pose, knurl_cycle& cycle) {
    if (probe_ && pose == nullptr)
        throw Failed(KNURL_BAD_ARGUMENT,
                     "pose is NULL, and the servo has no device that knows where its hand is");
    if (!probe_ && pose != nullptr)
        throw Failed(KNURL_BAD_ARGUMENT,
                     "pose is given, and the device '" + address_ + "' has a hand of its own; give NULL");
    if (probe_ && !probe_->put(*pose))
        throw Failed(KNURL_BAD_PARAMETERS,
                     "the pose is not finite, or its orientation has no length; no cycle was made");
    if (changed_) claim_->commit();
    changed_ = false;
    const Report& report = servo_->step();
    cells_ = 0;
    if (answered_ < claim_->issued()) check_answers();
    const bool touching = (report.flags & report_flags::touching) != 0;
    const Vec3 free_probe =
        probe0_.offset == Vec3{}
            ? report.contact_point
            : to_plain(to_eigen(report.position) + to_eigen(report.orientation) * to_eigen(probe0_.offset));
    cycle = {.size = 0,
             .time = static_cast<double>(steps_++) / options_.rate,
             .position = to_c(report.position),
             .velocity = to_c(report.velocity),
             .force = to_c(report.scene_force),
             .torque = to_c(report.scene_torque),
             .contact_point = to_c(touching ? report.contact_point : free_probe),
             .flags = report.flags,
             .buttons = report.buttons};
}

std::optional<knurl_feedback> OfflineObject::feedback(knurl_id id) {
    const Slot& slot = named(id);
    const RepresentationId wanted{.slot = static_cast<std::uint32_t>(id), .generation = slot.generation};
    const OfflineClaim::FeedbackSet& felt = claim_->feedback();
    const HandScales scales = protocol::scales_of(felt.header);
    for (const protocol::FeedbackEntry& entry : felt.entries) {
        if (!(entry.id == wanted)) continue;
        return knurl_feedback{
            .size = 0,
            .force = to_c(entry.force),
            .torque = to_c(entry.torque),
            .contact_point = to_c(entry.contact_point),
            .stiffness = entry.stiffness,
            .tangential_stiffness = entry.tangential_stiffness,
            .share = felt.header.gain * (kinds()[slot.kind].surface ? scales.contacts : scales.effects),
            .damping_share = felt.header.gain * scales.damping,
            .cycle = felt.header.cycle,
            .flags = entry.flags,
            .reserved = 0};
    }
    return std::nullopt;
}

}  // namespace knurl::capi
