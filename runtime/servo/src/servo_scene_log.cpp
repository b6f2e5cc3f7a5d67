// The cycle's entries in the scene log, while somebody watches (scene_log.hpp). What a cycle writes is bounded, however
// many representations change at once: the log has the state of a slot when its turn comes.

#include <algorithm>
#include <array>
#include <bit>

#include "servo_impl.hpp"

namespace knurl::servo {

namespace {

std::uint64_t bits_of(const std::array<const Asset*, max_assets>& assets) noexcept {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < assets.size(); ++i)
        if (assets[i] != nullptr) bits |= std::uint64_t{1} << i;
    return bits;
}

}  // namespace

template <class... Part>
void Servo::Impl::put_scene(SceneRecord type, const Part&... parts) noexcept {
    scene_log->put(static_cast<std::uint16_t>(type), {as_bytes(parts)...});
}
template void Servo::Impl::put_scene(SceneRecord, const std::uint64_t&) noexcept;

void Servo::Impl::watch_scenes(RecordLog* log) noexcept {
    scene_log = log;
    command_processor.shows = log != nullptr;
    if (log == nullptr) return;
    put_scene(SceneRecord::begin);
    for (std::size_t place = 0; place < claims.size(); ++place) {
        Claim::Impl& c = claims[place];
        c.unshown.all();
        c.shown_probes = 0;
        c.shown_touching = c.shown_asleep = false;
    }
}

// Changes and what is felt by turns. A turn may write several records: looking whether there are any costs more than
// writing them, most of the time.
void Servo::Impl::show_scenes() noexcept {
    report.cycle / scene_log_turn % 2 == 0 ? show_changes() : show_contacts();
}

void Servo::Impl::show_changes() noexcept {
    constexpr std::size_t claims_at_once = 4;
    std::uint32_t records = most_scene_changes, slots = 256;
    for (std::size_t n = std::min(claims.size(), claims_at_once); n > 0 && records > 0; --n) {
        if (next_shown >= claims.size()) next_shown = 0;
        Claim::Impl& c = claims[next_shown];
        if (c.channels && c.unshown.any()) show_changes_of(c, records, slots);
        if (records > 0) ++next_shown;
    }
}

void Servo::Impl::show_contacts() noexcept {
    // 30 times a second a round over all claims begins. However many are touched, a turn writes of a few, and the round
    // takes longer.
    constexpr std::uint64_t round = 32;  // cycles
    if (felt_left == 0) {
        if (report.cycle % round != scene_log_turn) return;
        felt_left = claims.size();
    }
    for (int looked = 0, written = 0; felt_left > 0 && looked < 64 && written < most_scene_felt;
         ++looked, --felt_left) {
        if (claims.size() == 0) return;
        if (next_felt >= claims.size()) next_felt = 0;
        Claim::Impl& c = claims[next_felt++];
        if (c.channels && show_felt(c)) ++written;
    }
}

void Servo::Impl::show_changes_of(Claim::Impl& c, std::uint32_t& records, std::uint32_t& slots) noexcept {
    if (c.unshown.take_claim()) {
        const auto* rows =
            reinterpret_cast<const protocol::ClientRow*>(segment + protocol::device_layout().clients);
        const SceneClaim claim{.row = c.row == nullptr ? 0 : static_cast<std::uint32_t>(c.row - rows),
                               .assets = bits_of(c.assets),
                               .frame = c.terms.frame};
        put_scene(SceneRecord::claim, c.number, claim);
        --records;
    }
    while (records > 0) {
        const auto probe = c.unshown.take_probe();
        if (!probe) break;
        const ProbePlacement placement = c.scene.placement(*probe);
        const std::uint32_t bit = 1u << *probe;
        const bool at_tip = placement.radius == 0 && to_eigen(placement.offset).isZero(0);
        if (at_tip && (c.shown_probes & bit) == 0) continue;  // as all are that were never placed
        c.shown_probes |= bit;
        put_scene(SceneRecord::probe, c.number, SceneProbe{.probe = *probe, .placement = placement});
        --records;
    }
    while (records > 0) {
        const auto next = c.unshown.take_slot(slots);
        if (!next) return;
        const Scene::Shown shown = c.scene.shown(next->slot);
        if (!shown.params.empty()) {
            const SceneItem item{.id = shown.id, .kind = shown.kind, .options = shown.options};
            scene_log->put(static_cast<std::uint16_t>(SceneRecord::item),
                           {as_bytes(c.number), as_bytes(item), shown.params});
        } else if (next->changed) {
            put_scene(SceneRecord::item_gone, c.number, RepresentationId{.slot = next->slot});
        } else {
            continue;
        }
        --records;
    }
}

bool Servo::Impl::show_felt(Claim::Impl& c) noexcept {
    if (c.unshown.claim_waits()) return false;
    if (!c.touching && !c.shown_touching && c.scene_sleeps == c.shown_asleep) return false;
    c.shown_touching = c.touching;
    c.shown_asleep = c.scene_sleeps;
    std::array<SceneContact, most_scene_contacts> contacts;
    SceneFelt felt{.asleep = c.scene_sleeps ? 1u : 0u};
    if (c.touching) {
        c.feedback.each_touched([&](const Feedback& entry) {
            if (felt.contacts == contacts.size()) return;
            contacts[felt.contacts++] = {.id = entry.id,
                                         .flags = entry.flags,
                                         .force = to_plain(entry.wrench.force),
                                         .contact = to_plain(entry.contact_point)};
        });
    }
    scene_log->put(
        static_cast<std::uint16_t>(SceneRecord::felt),
        {as_bytes(c.number), as_bytes(felt), std::as_bytes(std::span(contacts).first(felt.contacts))});
    return true;
}

}  // namespace knurl::servo
