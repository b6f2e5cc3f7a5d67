#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

#include <knurl/reps/all.hpp>
#include <knurl/servo/claim.hpp>

#include "claim_impl.hpp"

namespace knurl::servo {

namespace {

std::byte* laid_out(std::byte* memory, const protocol::ClaimLayout& layout) {
    shm::spsc_init(memory + layout.commands);
    shm::triple_init(memory + layout.batches);
    shm::spsc_init(memory + layout.replies);
    shm::triple_init(memory + layout.feedback);
    return memory;
}

std::optional<Channels> channels_of(std::byte* memory, const protocol::ClaimLayout& layout) {
    if (layout.batch_slot_bytes == 0) return std::nullopt;
    return Channels(laid_out(memory, layout), layout);
}

}  // namespace

Channels::Channels(std::byte* memory, const protocol::ClaimLayout& layout)
    : commands(memory + layout.commands, layout.command_cells),
      batches(memory + layout.batches, layout.batch_slot_bytes),
      replies(memory + layout.replies, protocol::reply_cells),
      feedback(memory + layout.feedback, layout.feedback_slot_bytes) {}

Claim::Impl::Impl(const ClaimTerms& stated, std::byte* memory, protocol::ClientRow* table_row)
    : terms(stated),
      layout(protocol::claim_layout(stated.capacity)),
      channels(channels_of(memory, layout)),
      wake_target{.flag = reinterpret_cast<shm::WaiterFlag*>(memory + layout.waiter),
                  .trusted = stated.woken_by_servo != 0},
      row(table_row),
      scene({.representations = stated.capacity.representations, .probes = protocol::max_probes},
            stated.limits),
      silence(stated.update_interval, stated.delay_allowance),
      feedback(channels ? stated.capacity.representations : 0),
      unshown(channels ? stated.capacity.representations : 0) {
    if (channels) slots.resize(terms.capacity.representations);
}

Claim::Claim(const ClaimTerms& terms, std::byte* memory, protocol::ClientRow* row)
    : impl(std::make_unique<Impl>(terms, memory, row)) {}
Claim::~Claim() = default;

void Claim::Impl::watch_silence(Nanoseconds now) noexcept {
    silent_for = silence.silent_for(now);
    scene.set_silence(silent_for);
}

Probe Claim::Impl::in_world(const Probe& device_hand) const noexcept {
    const protocol::Frame& f = terms.frame;
    Probe hand = device_hand;
    hand.position = f.scale * (device_hand.position - to_eigen(f.device_centre)) + to_eigen(f.world_centre);
    hand.velocity = f.scale * device_hand.velocity;
    hand.smooth_velocity = f.scale * device_hand.smooth_velocity;
    return hand;
}

void Claim::Impl::evaluate(const Probe& device_hand, double dt) noexcept {
    empty_for = scene.size() == 0 && wrench.force.isZero(0) && wrench.torque.isZero(0) ? empty_for + dt : 0;
    if (quiet()) return;
    wrench = scene.evaluate(in_world(device_hand), dt);
    touching = feedback.take(scene);
}

bool Claim::Impl::nothing_to_do() const noexcept {
    if (dropping || forgotten != 0) return false;
    if (!channels) return true;  // an observer has only its row in the table
    const bool gain_rests = wants_force() ? gain >= 1 && announced : !(gain > 0);
    if (!gain_rests || touching || batch_is_new || commands_left) return false;
    return scene_sleeps || (quiet() && feedback.size() == 0 && scene.evaluated() == 0);
}

void Claim::Impl::advance_gain(double step) noexcept {
    constexpr double rounding = 1e-9;  // so that n steps take n cycles
    const double before = gain;
    if (wants_force()) {
        gain = gain + step > 1 - rounding ? 1 : gain + step;
    } else {
        gain = gain - step < rounding ? 0 : gain - step;
    }
    gain_lost = std::max(0.0, before - gain);
}

Wrench Claim::Impl::device_wrench() const noexcept {
    // World and device lengths differ by `scale`, so lever arms and torques do, too.
    const double share = gain * terms.frame.force_scale;
    return {share * wrench.force, share / terms.frame.scale * wrench.torque};
}

Eigen::Vector3d Claim::Impl::device_contact_point() const noexcept {
    const protocol::Frame& f = terms.frame;
    return (scene.contact_point() - to_eigen(f.world_centre)) / f.scale + to_eigen(f.device_centre);
}

namespace {

// The scene's feedback is the application's, byte for byte: a thousand entries are copied once.
static_assert(sizeof(Feedback) == sizeof(protocol::FeedbackEntry));
static_assert(offsetof(Feedback, id) == offsetof(protocol::FeedbackEntry, id));
static_assert(offsetof(Feedback, wrench) + offsetof(Wrench, force) ==
              offsetof(protocol::FeedbackEntry, force));
static_assert(offsetof(Feedback, wrench) + offsetof(Wrench, torque) ==
              offsetof(protocol::FeedbackEntry, torque));
static_assert(offsetof(Feedback, contact_point) == offsetof(protocol::FeedbackEntry, contact_point));
static_assert(offsetof(Feedback, stiffness) == offsetof(protocol::FeedbackEntry, stiffness));
static_assert(offsetof(Feedback, tangential_stiffness) ==
              offsetof(protocol::FeedbackEntry, tangential_stiffness));
static_assert(offsetof(Feedback, flags) == offsetof(protocol::FeedbackEntry, flags));

/// Calls visit with the number of each set bit.
template <class Visit>
void each_bit(std::span<const std::uint64_t> words, Visit visit) noexcept {
    for (std::size_t w = 0; w < words.size(); ++w)
        for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1)
            visit(64 * w + static_cast<std::size_t>(std::countr_zero(rest)));
}

template <class T>
void put(std::atomic<T>& word, T value) noexcept {
    word.store(value, std::memory_order_relaxed);  // readable by anyone, orders nothing
}

}  // namespace

// No slot of the channel has been written, so all entries are stale.
FeedbackEntries::FeedbackEntries(std::size_t most) : entries_(most) {
    const std::vector<std::uint64_t> none((most + 63) / 64), all(none.size(), ~std::uint64_t{0});
    written_ = {.wholly = none, .flags = none};
    stale_.fill({.wholly = all, .flags = none});
}

bool FeedbackEntries::take(Scene& scene) noexcept {
    const std::size_t before = size_;
    size_ = scene.feedback(entries_, {.wholly = written_.wholly, .flags = written_.flags});
    news_ = size_ != before;
    for (Marks& stale : stale_) {
        for (std::size_t w = 0; w < written_.wholly.size(); ++w) {
            stale.wholly[w] |= written_.wholly[w];
            stale.flags[w] |= written_.flags[w];
        }
    }
    for (std::size_t w = 0; w < written_.wholly.size(); ++w)
        news_ = news_ || (written_.wholly[w] | written_.flags[w]) != 0;
    std::uint32_t flags = 0;  // the written entries contain all touched ones
    each_bit(written_.wholly, [&](std::size_t i) { flags |= entries_[i].flags; });
    return (flags & Feedback::touching) != 0;
}

/// Writes behind the header. Stale entries beyond the last one stay stale: nobody reads them now, but may
/// later.
void FeedbackEntries::write(shm::TripleWriter& to) noexcept {
    constexpr std::size_t tail = offsetof(Feedback, flags) / 8 * 8;
    Marks& stale = stale_[to.back()];
    const auto write_from = [&](std::size_t first, std::size_t w, std::uint64_t marks) {
        each_bit(std::array{marks}, [&](std::size_t bit) {
            const std::size_t i = 64 * w + bit;
            to.write(sizeof(protocol::FeedbackHeader) + i * sizeof(Feedback) + first,
                     reinterpret_cast<const std::byte*>(&entries_[i]) + first, sizeof(Feedback) - first);
        });
    };
    for (std::size_t w = 0; 64 * w < size_; ++w) {
        const std::size_t left = size_ - 64 * w;
        const std::uint64_t present = left < 64 ? (std::uint64_t{1} << left) - 1 : ~std::uint64_t{0};
        write_from(0, w, stale.wholly[w] & present);
        write_from(tail, w, stale.flags[w] & ~stale.wholly[w] & present);
        stale.wholly[w] &= ~present;
        stale.flags[w] &= ~present;
    }
}

void Claim::Impl::publish_missed() noexcept {
    if (row == nullptr) return;
    put(row->missed, shm::HardwareMemory::load(wake_target.flag->missed, std::memory_order::relaxed));
}

void Claim::Impl::publish(std::uint64_t cycle) noexcept {
    if (row != nullptr) {
        put(row->commits, batches_taken);
        put(row->refused, refused.count);
        put(row->merged, batches_merged);
        put(row->age_ns, static_cast<std::uint64_t>(in_force.age_ns));
        put(row->interval_ns, static_cast<std::uint64_t>(silence.interval() * 1e9));
        put(row->gain_ppm, static_cast<std::uint64_t>(gain * 1e6));
        const auto cut = [](double scale) { return static_cast<std::uint64_t>((1 - scale) * 1e6); };
        const bool felt_now = !wrench.force.isZero(0) || !wrench.torque.isZero(0);
        const HandScales told = felt_now ? scales : HandScales{};
        put(row->contacts_cut_ppm, cut(told.contacts));
        put(row->effects_cut_ppm, cut(told.effects));
        put(row->damping_cut_ppm, cut(told.damping));
        put(row->silent, std::uint64_t{silent_for > 0});
        put(row->armed, std::uint64_t{armed});
        put(row->shed, std::uint64_t{shed});
        if (counts_changed)
            for (Kind kind = 0; kind < Representations::size; ++kind)
                put(row->present[kind], std::uint64_t{scene.count(kind)});
        counts_changed = false;
    }
    if (!channels) return;

    protocol::FeedbackHeader header;
    header.cycle = cycle;
    header.batch = in_force.sequence;
    header.batch_cycle = in_force.cycle;
    header.batch_report_cycle = in_force.report_cycle;
    header.batch_commit_ns = in_force.commit_ns;
    header.batch_write_ns = in_force.write_ns;
    header.batch_age_ns = in_force.age_ns;
    header.batches_refused = refused.count;
    header.refused_batch = refused.sequence;
    header.refused_code = static_cast<std::uint32_t>(refused.verdict.code);
    header.refused_field = refused.verdict.field;
    header.refused_value = refused.verdict.value;
    header.refused_reason = refused.verdict.reason;
    header.refused_against = refused.verdict.against;
    header.refused_kind = refused.kind;
    header.refused_slot = refused.slot;
    header.gain = gain;
    header.silence = silent_for;
    header.scales = protocol::packed(scales);
    header.entries = static_cast<std::uint32_t>(feedback.size());

    // Without force and news, publishing is skipped: a hundred idle claims would cost too much. The same
    // holds for a scene out of reach. A continuing silence is not news.
    published.cycle = cycle;
    if (published.silence > 0 && header.silence > 0) published.silence = header.silence;
    const bool no_feedback = feedback.size() == 0 || (scene_sleeps && !feedback.news());
    if (no_feedback) header.scales = published.scales;  // without feedback, nothing is scaled
    if (no_feedback && std::memcmp(&published, &header, sizeof header) == 0) return;
    published = header;

    channels->feedback.write(0, &header, sizeof header);
    feedback.write(channels->feedback);
    channels->feedback.publish_written();
}

}  // namespace knurl::servo
