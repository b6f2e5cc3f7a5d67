#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include <knurl/servo/asset_build.hpp>
#include <knurl/servo/replay.hpp>

#include "servo_impl.hpp"
#include "state_words.hpp"

namespace knurl::servo {

using drivers::JointSample;

/// Plays back what the recorded device and clock returned. The servo's stage clock is off, so a cycle reads
/// the time twice: after the read and after the write.
struct Replay::Played final : drivers::Device, Clock {
    explicit Played(const drivers::Device& like) : like_(like) {}

    const drivers::LinkConfig& link() const noexcept override { return like_.link(); }
    const drivers::Mechanism& mechanism() const noexcept override { return like_.mechanism(); }
    drivers::ReadStatus read(Nanoseconds, JointSample& sample) noexcept override {
        sample = given;
        return static_cast<drivers::ReadStatus>(cycle.status);
    }
    bool write(Nanoseconds, const drivers::JointEfforts&) noexcept override {
        return (cycle.flags & CycleInput::written) != 0;
    }
    void make_safe() noexcept override {}
    Nanoseconds now() noexcept override {
        return std::exchange(asked, true) ? cycle.write_ns : cycle.read_ns;
    }

    CycleInput cycle;
    JointSample given;
    bool asked = false;

  private:
    const drivers::Device& like_;
};

struct Replay::Held {
    explicit Held(const ClaimTerms& stated)
        : layout(protocol::claim_layout(stated.capacity)),
          memory(layout.total),
          claim(stated, memory.data(), nullptr),
          commands(memory.data() + layout.commands, layout.command_cells),
          batches(memory.data() + layout.batches, layout.batch_slot_bytes),
          replies(memory.data() + layout.replies, protocol::reply_cells),
          sent(reinterpret_cast<shm::WaiterFlag*>(memory.data() + layout.waiter)) {}

    protocol::ClaimLayout layout;
    OfflineMemory memory;
    std::map<std::uint64_t, std::unique_ptr<Asset>> assets;  // by number; the claim refers to them
    Claim claim;
    shm::SpscProducer commands;
    shm::TripleWriter batches;
    shm::SpscConsumer replies;
    shm::SentCount sent;
};

namespace {

[[noreturn]] void nonsense(const InputRecord& record, const char* what) {
    throw InputLogError(fmt::format(
        "a record of type {} with {} bytes {}; the recording was edited, or made by another build",
        static_cast<unsigned>(record.type), record.bytes.size(), what));
}

template <class T>
T part_of(const InputRecord& record, std::size_t at) {
    if (record.bytes.size() < at + sizeof(T)) nonsense(record, "is too short");
    return read_as<T>(record.bytes.data() + at);
}

constexpr std::size_t after_number = sizeof(std::uint64_t);

/// Refuses figures that no broker would grant, since they size the claim's memory, and bytes that are no bool: to read
/// one as a bool is undefined.
void require_sane(const InputRecord& record, const ClaimTerms& terms) {
    const auto& c = terms.capacity;
    for (const bool* one : {&terms.observer, &terms.resets, &terms.shared}) {
        unsigned char byte = 0;
        std::memcpy(&byte, one, 1);
        if (byte > 1) nonsense(record, "adopts something that is no claim");
    }
    if (record.bytes.size() != after_number + sizeof terms || c.representations < 1 ||
        c.representations > protocol::max_representations || c.batch_bytes < 8 ||
        c.batch_bytes > protocol::max_batch_bytes || c.batch_bytes % 8 != 0)
        nonsense(record, "adopts something that is no claim");
}

}  // namespace

Replay::Replay(const drivers::Device& like, const ServoOptions& options, Sources sources)
    : played_(std::make_unique<Played>(like)),
      options_(options),
      segment_(protocol::device_layout().total),
      sources_(std::move(sources)) {}
Replay::~Replay() = default;

void Replay::gap() noexcept {
    exact_ = false;
}

void Replay::load(const InputRecord& record) {
    if (record.bytes.size() % 8 != 0 || record.bytes.size() > max_keyframe_words * 8)
        nonsense(record, "is no keyframe");
    // Nobody held the device, so a new servo with this state equals the recorded one. A keyframe after
    // replayed cycles adds nothing.
    if (exact_) return;
    claims_.clear();
    std::memset(segment_.data(), 0, segment_.size());
    servo_ = std::make_unique<Servo>(*played_, *played_, segment_.data(), options_);
    std::vector<std::uint64_t> words(record.bytes.size() / 8);
    std::memcpy(words.data(), record.bytes.data(), record.bytes.size());
    StateWords reader(words, StateWords::To::state);
    servo_->impl_->state(reader);
    if (reader.visited() != words.size()) nonsense(record, "is a keyframe of another length");
    servo_->impl_->stages.never();
    exact_ = true;
}

Replay::Held* Replay::held(const InputRecord& record) {
    const auto found = claims_.find(part_of<std::uint64_t>(record, 0));
    if (found == claims_.end()) nonsense(record, "is about a claim that is not there");
    return found->second.get();
}

const Report* Replay::feed(const InputRecord& record) {
    if (record.type == InputType::keyframe) {
        load(record);
        return nullptr;
    }
    if (!exact_) return nullptr;
    switch (record.type) {
        case InputType::adopt: {
            auto terms = part_of<ClaimTerms>(record, after_number);
            require_sane(record, terms);
            terms.woken_by_servo = 0;  // nobody sleeps
            auto& place = claims_[part_of<std::uint64_t>(record, 0)];
            if (place) nonsense(record, "adopts a claim twice");
            place = std::make_unique<Held>(terms);
            if (!servo_->adopt(&place->claim)) nonsense(record, "is one claim too many");
            return nullptr;
        }
        case InputType::drop:
            if (!servo_->drop(&held(record)->claim)) nonsense(record, "is one message too many");
            return nullptr;
        case InputType::drop_all:
            if (!servo_->drop_all()) nonsense(record, "is one message too many");
            return nullptr;
        case InputType::commands: {
            const std::size_t bytes = record.bytes.size() - after_number;
            if (!held(record)->commands.try_push(record.bytes.data() + after_number,
                                                 bytes / shm::cell_bytes) ||
                bytes % shm::cell_bytes != 0)
                nonsense(record, "has more commands than the claim could send");
            held(record)->sent.add();
            return nullptr;
        }
        case InputType::batch: {
            part_of<protocol::BatchHeader>(record, after_number);
            const std::size_t bytes = record.bytes.size() - after_number;
            Held& claim = *held(record);
            if (bytes % 8 != 0 || bytes > claim.layout.batch_slot_bytes)
                nonsense(record, "is a larger batch than the claim could send");
            claim.batches.publish(record.bytes.data() + after_number, bytes);
            claim.sent.add();
            return nullptr;
        }
        case InputType::commands_broken:  // as its application did: an invalid index
            shm::HardwareMemory::store(
                *shm::spsc_places(held(record)->memory.data() + held(record)->layout.commands,
                                  held(record)->layout.command_cells)
                     .tail,
                ~std::uint64_t{0}, std::memory_order::relaxed);
            held(record)->sent.add();
            return nullptr;
        case InputType::batch_broken:
            shm::HardwareMemory::store(
                *shm::triple_places(held(record)->memory.data() + held(record)->layout.batches,
                                    held(record)->layout.batch_slot_bytes)
                     .mid,
                shm::TripleMid::make(shm::TripleMid::index_mask, true, 0), std::memory_order::relaxed);
            held(record)->sent.add();
            return nullptr;
        case InputType::cycle: {
            CycleInput cycle;
            if (record.bytes.size() > sizeof cycle || record.bytes.size() < offsetof(CycleInput, velocity))
                nonsense(record, "is no cycle");
            std::memcpy(&cycle, record.bytes.data(), record.bytes.size());
            if (record.bytes.size() != cycle.bytes()) nonsense(record, "is no cycle");
            return step(cycle);
        }
        case InputType::shed:
            shed(record);
            return nullptr;
        case InputType::asset:
            give(record);
            return nullptr;
        case InputType::asset_forgotten: {
            const auto number = part_of<std::uint64_t>(record, after_number);
            Held& claim = *held(record);
            if (!claim.assets.contains(number) ||
                !servo_->forget(&claim.claim, static_cast<std::uint32_t>(number)))
                nonsense(record, "forgets an asset that is not there");
            return nullptr;
        }
        case InputType::keyframe:
            break;
    }
    nonsense(record, "is none of ours");
}

void Replay::shed(const InputRecord& record) {
    ClaimSet& claims = servo_->impl_->claims;
    const std::size_t place = claims.find(&held(record)->claim);
    if (place == claims.size()) nonsense(record, "sheds a claim that is not there");
    servo_->impl_->shed(place);
}

void Replay::give(const InputRecord& record) {
    const auto number = part_of<std::uint64_t>(record, after_number);
    const auto digest = part_of<protocol::AssetDigest>(record, after_number + sizeof number);
    Held& claim = *held(record);
    if (number < 1 || number > max_assets || claim.assets.contains(number))
        nonsense(record, "gives a claim an asset of a number that it cannot have");
    if (!sources_) throw InputLogError("an application sent a shape here, which was not recorded");
    try {
        auto& place = claim.assets[number];
        place = build_asset(sources_(digest), protocol::max_asset_bytes).asset;
        if (!servo_->give(&claim.claim, static_cast<std::uint32_t>(number), place.get(), digest))
            nonsense(record, "is one message too many");
    } catch (const InputLogError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputLogError(fmt::format("a recorded shape cannot be built again ({})", error.what()));
    }
}

const Report* Replay::step(const CycleInput& cycle) {
    if (cycle.cycle != servo_->impl_->report.cycle + 1)
        throw InputLogError(fmt::format("cycle {} follows cycle {}: records are missing between them",
                                        cycle.cycle, servo_->impl_->report.cycle));
    played_->cycle = cycle;
    played_->asked = false;
    JointSample& given = played_->given;
    given.position = cycle.position;
    given.velocity = cycle.velocity;
    given.has_velocity = (cycle.flags & CycleInput::has_velocity) != 0;
    given.calibrated = (cycle.flags & CycleInput::calibrated) != 0;
    given.buttons = cycle.buttons;
    if ((cycle.flags & CycleInput::guardian) != 0) servo_->guardian_acted();
    servo_->guardian_is_still((cycle.flags & CycleInput::guardian_still) != 0);
    if ((cycle.flags & CycleInput::jumped) != 0) servo_->clock_jumped();
    servo_->impl_->load.set_ppm(cycle.load_ppm);
    servo_->step(cycle.deadline, cycle.now);
    for (auto& [number, claim] : claims_) claim->replies.pop(claim->replies.available());
    free_released();
    return &servo_->last();
}

void Replay::free_released() {
    while (const std::optional<ReturnedAsset> back = servo_->returned())
        for (auto& [number, claim] : claims_)
            if (&claim->claim == back->claim) claim->assets.erase(back->number);
    while (const Claim* back = servo_->released())
        std::erase_if(claims_, [back](const auto& entry) { return &entry.second->claim == back; });
}

}  // namespace knurl::servo
