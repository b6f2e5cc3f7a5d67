#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>

#include <fmt/format.h>
#include <sys/random.h>
#include <unistd.h>

#include <knurl/servo/claim_table.hpp>

#include "fair_share.hpp"

namespace knurl::servo {

namespace {

constexpr std::uint64_t role_claim = 1;
constexpr std::uint64_t role_observer = 2;
constexpr std::uint32_t smallest_batch = 64;  // bytes: one small entry
constexpr double longest_interval = 3600;     // s between commits

shm::WaiterFlag* flag_in(shm::Segment& claim_segment) {
    // the flag has the same place for any capacity
    constexpr protocol::ClaimLayout layout = protocol::claim_layout({});
    return reinterpret_cast<shm::WaiterFlag*>(claim_segment.data() + layout.waiter);
}

bool bounded(double value, double most) {
    return std::abs(value) <= most;
}  // false for NaN

}  // namespace

ClaimTable::ClaimTable(HostedDevice device, shm::Waker& waker, MemoryBudget& memory)
    : device_(std::move(device)), waker_(waker), memory_(memory) {}

ClaimTable::~ClaimTable() {
    for (std::uint32_t row = 0; row < rows_.size(); ++row) {
        if (rows_[row].stage != Stage::free) clear(row);
    }
}

void ClaimTable::require_sane(const protocol::ClaimRequest& request) const {
    const auto refuse = [](std::string text) { throw RequestRefused("claim: " + text); };
    if (request.observe > protocol::observe_and_reset) refuse("observe is 0, 1 or 2");
    if (request.shared > 1) refuse("shared is 0 or 1");
    const protocol::ClaimCapacity& capacity = request.capacity;
    if (request.observe == 0 &&
        (capacity.representations < 1 || capacity.representations > protocol::max_representations)) {
        refuse(fmt::format("{} representations; allowed: 1 to {}", capacity.representations,
                           protocol::max_representations));
    }
    if (request.observe == 0 &&
        (capacity.batch_bytes < smallest_batch || capacity.batch_bytes > protocol::max_batch_bytes ||
         capacity.batch_bytes % 8 != 0)) {
        refuse(fmt::format("batches of {} bytes; allowed: multiples of 8 from {} to {}", capacity.batch_bytes,
                           smallest_batch, protocol::max_batch_bytes));
    }
    const double radius = request.workspace_radius;
    if (radius != 0 && !(radius >= 1e-9 && radius <= 1e9)) {
        refuse(fmt::format("workspace_radius = {:g} m; allowed: 1e-9 to 1e9, or 0 for the device's own",
                           radius));
    }
    const Vec3& centre = request.workspace_centre;
    if (!bounded(centre.x, 1e9) || !bounded(centre.y, 1e9) || !bounded(centre.z, 1e9)) {
        refuse(fmt::format("workspace_centre = ({:g}, {:g}, {:g}) m; allowed: up to 1e9 m", centre.x,
                           centre.y, centre.z));
    }
    if (!(request.update_interval >= 0 && request.update_interval <= longest_interval)) {
        refuse(fmt::format("update_interval = {:g} s; allowed: 0 (measured) to {:g}", request.update_interval,
                           longest_interval));
    }
    if (!(request.delay_allowance >= 0 && request.delay_allowance <= protocol::max_delay_allowance)) {
        refuse(fmt::format("delay_allowance = {:g} s; allowed: 0 to {:g}", request.delay_allowance,
                           protocol::max_delay_allowance));
    }
}

void ClaimTable::require_free_for(const protocol::ClaimRequest& request) const {
    if (request.observe != 0) return;
    for (const Row& row : rows_) {
        if ((row.stage != Stage::held && row.stage != Stage::granted) || row.observer) continue;
        if (row.shared && request.shared != 0) continue;
        throw RequestRefused(
            fmt::format("device \"{}\" is held by pid {} ({}); {}", device_.name, row.peer.pid, row.peer.name,
                        row.shared ? "it shares: claim it with shared = true"
                                   : "end that program, or claim with shared = true in both"),
            row.peer.pid);
    }
}

void ClaimTable::require_share_of(const protocol::ClaimRequest& request, const Peer& peer) const {
    std::size_t free = 0;
    Share held;
    for (const Row& row : rows_) {
        if (row.stage == Stage::free)
            ++free;
        else
            held.count(row.peer, peer);
    }
    const std::size_t reserved = request.observe == protocol::observe_only ? protocol::rows_for_claims : 0;
    const std::size_t left = free > reserved ? free - reserved : 0;
    if (left == 0)
        throw RequestRefused(fmt::format(
            "device \"{}\" has {} clients, which is all it takes{}; end one of them", device_.name,
            protocol::max_clients - free, reserved > 0 ? " but for those that claim it" : ""));
    if (const auto who = takes_too_much(held, peer, left))
        throw RequestRefused(fmt::format("device \"{}\": {} of its {} places; end one of them", device_.name,
                                         *who, protocol::max_clients));
}

std::uint64_t ClaimTable::require_memory(const char* what, std::uint64_t bytes) const {
    constexpr double mib = 1 << 20;
    if (bytes <= memory_.left()) return memory_.left();
    throw RequestRefused(fmt::format(
        "{} takes {:.1f} MiB, and of the {:.0f} MiB that clients of this servo may take {:.1f} are "
        "left; free some, or raise memory in the servo's configuration",
        what, static_cast<double>(bytes) / mib, static_cast<double>(memory_.total()) / mib,
        static_cast<double>(memory_.left()) / mib));
}

Grant ClaimTable::grant(const protocol::ClaimRequest& request, const Peer& peer) {
    require_sane(request);
    require_free_for(request);
    require_share_of(request, peer);
    const auto found =
        std::find_if(rows_.begin(), rows_.end(), [](const Row& row) { return row.stage == Stage::free; });
    const auto index = static_cast<std::uint32_t>(found - rows_.begin());

    const bool observer = request.observe != 0;
    ClaimTerms terms;
    terms.capacity = request.capacity;
    if (observer) terms.capacity = {0, 0};
    terms.resets = request.observe == protocol::observe_and_reset;
    if (terms.resets) terms.capacity = {1, smallest_batch};
    terms.frame = frame_for(device_.link, request);
    terms.limits = limits_for(device_.link, device_.rate, terms.frame);
    terms.update_interval = request.update_interval;
    terms.delay_allowance = request.delay_allowance;
    terms.observer = observer;
    terms.shared = request.shared != 0;

    const std::uint64_t bytes = claim_bytes(terms.capacity);
    require_memory("claim: it", bytes);

    Row fresh;  // enters the table only when it is complete
    fresh.memory = {memory_, bytes};
    shm::WakePair wake;
    try {
        fresh.segment = shm::Segment::create("knurl-claim", protocol::claim_layout(terms.capacity).total);
        fresh.segment.hold_pages();
        wake = shm::make_wake_pair();
        fresh.wake_fd = std::move(wake.servo);
        fresh.observer = observer;
        fresh.shared = terms.shared;
        fresh.peer = peer;
        fresh.trusted = trusted(peer);
        terms.woken_by_servo = fresh.trusted ? 1 : 0;
        if (getrandom(&fresh.key, sizeof fresh.key, 0) != sizeof fresh.key)
            throw std::runtime_error("no random numbers");
        fresh.claim = std::make_unique<Claim>(terms, fresh.segment.data(), &shared_row(index));
    } catch (const std::exception& error) {
        throw RequestRefused(
            fmt::format("claim of device \"{}\": the servo has no memory or descriptors left ({})",
                        device_.name, error.what()));
    }
    *found = std::move(fresh);
    identify(index, peer, observer ? role_observer : role_claim, terms.shared);
    found->stage = Stage::granted;

    Grant grant;
    grant.message.slot = index;
    grant.message.capacity = terms.capacity;
    grant.message.key = found->key;
    grant.message.frame = terms.frame;
    grant.message.limits = terms.limits;
    grant.segment_fd = found->segment.fd();
    grant.wake_fd = std::move(wake.client);
    return grant;
}

Claim& ClaimTable::serve(std::uint32_t index) {
    Row& row = rows_[index];
    const auto refuse = [&](const char* why) {
        clear(index);
        throw RequestRefused(fmt::format("claim of device \"{}\": {}", device_.name, why));
    };
    // First the seal: behind it no page can be taken away, so the look at the pages holds for good.
    if (!row.segment.sealed_against_new_writers())
        refuse("its memory is not sealed (F_SEAL_FUTURE_WRITE); map it, then seal it");
    if (!row.segment.has_every_page())
        refuse("a page of its memory was taken away before it was sealed; claim it again");
    try {
        waker_.add({.flag = flag_in(row.segment), .wake_fd = row.wake_fd.get(), .trusted = row.trusted});
    } catch (const std::exception& error) {
        refuse(error.what());
    }
    if (!device_.servo.adopt(row.claim.get())) refuse("the servo is busy with other claims; try again");
    row.stage = Stage::held;
    return *row.claim;
}

void ClaimTable::let_go(std::uint32_t index) noexcept {
    if (index >= rows_.size()) return;
    Row& row = rows_[index];
    if (row.stage == Stage::returned || row.stage == Stage::granted) clear(index);
    if (row.stage != Stage::held) return;
    row.stage = device_.servo.drop(row.claim.get()) ? Stage::leaving : Stage::dropping;
    ++on_their_way_;
}

bool ClaimTable::collect() noexcept {
    take_back_assets();
    if (on_their_way_ == 0) return false;
    for (std::uint32_t index = 0; index < rows_.size(); ++index) {
        Row& row = rows_[index];
        if (row.stage == Stage::dropping && device_.servo.drop(row.claim.get())) row.stage = Stage::leaving;
        if (row.stage == Stage::clearing) clear(index);
    }
    while (const Claim* back = device_.servo.released()) {
        take_back_assets();  // assets that came before the claim: its address may soon be another claim's
        const auto found = std::find_if(rows_.begin(), rows_.end(),
                                        [back](const Row& row) { return row.claim.get() == back; });
        if (found == rows_.end()) continue;
        if (found->stage == Stage::held) {
            found->stage = Stage::returned;
        } else {
            --on_their_way_;
            clear(static_cast<std::uint32_t>(found - rows_.begin()));
        }
    }
    return on_their_way_ > 0;
}

protocol::ClientRow& ClaimTable::shared_row(std::uint32_t row) const {
    std::byte* rows = device_.segment.data() + protocol::device_layout().clients;
    return reinterpret_cast<protocol::ClientRow*>(rows)[row];
}

void ClaimTable::identify(std::uint32_t index, const Peer& peer, std::uint64_t role, bool shared) noexcept {
    // Seqlock with one writer. Release on every word, as in the report ring: a reader that sees a new word
    // (acquire) also sees the odd sequence before it, so its second read of the sequence rejects the row.
    //   writer: sequence odd ─sb─> word (rel) ─sb─> sequence even (rel)
    //   reader: sequence (acq) ─sb─> words (acq) ─sb─> sequence again: the same and even?
    protocol::ClientRow& row = shared_row(index);
    const std::uint64_t sequence = row.sequence.load(std::memory_order_relaxed);
    row.sequence.store(sequence + 1, std::memory_order_relaxed);
    row.pid.store(static_cast<std::uint64_t>(peer.pid), std::memory_order_release);
    row.role.store(role, std::memory_order_release);
    row.shared.store(shared ? 1 : 0, std::memory_order_release);
    char name[protocol::name_bytes] = {};
    peer.name.copy(name, sizeof name - 1);
    for (std::size_t i = 0; i < sizeof name / 8; ++i) {
        std::uint64_t word;
        std::memcpy(&word, name + 8 * i, 8);
        row.name[i].store(word, std::memory_order_release);
    }
    row.sequence.store(sequence + 2, std::memory_order_release);
}

void ClaimTable::clear(std::uint32_t index) noexcept {
    Row& row = rows_[index];
    // Before the segment is unmapped. The broker does not wait for a wake-up, which its client can make long.
    if (!waker_.try_remove(flag_in(row.segment))) {
        if (row.stage != Stage::clearing) ++on_their_way_;
        row.stage = Stage::clearing;
        return;
    }
    if (row.stage == Stage::clearing) --on_their_way_;
    protocol::ClientRow& shared = shared_row(index);  // also the servo's half: the servo has released the row
    for (auto* word : {&shared.commits, &shared.refused, &shared.merged, &shared.age_ns, &shared.interval_ns,
                       &shared.gain_ppm, &shared.silent, &shared.armed, &shared.shed, &shared.missed,
                       &shared.contacts_cut_ppm, &shared.effects_cut_ppm, &shared.damping_cut_ppm}) {
        word->store(0, std::memory_order_relaxed);
    }
    for (auto& word : shared.present) word.store(0, std::memory_order_relaxed);
    identify(index, {}, 0, false);
    row = Row{};
}

}  // namespace knurl::servo
