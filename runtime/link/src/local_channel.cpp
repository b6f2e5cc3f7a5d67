#include <array>

#include <knurl/link/local.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::detail {

namespace {

class LocalReports final : public ReportSource {
  public:
    LocalReports(std::shared_ptr<const shm::Segment> device, std::shared_ptr<shm::Segment> claim,
                 const protocol::ClaimCapacity& capacity, shm::UniqueFd event)
        : device_(std::move(device)),
          claim_(std::move(claim)),
          event_(std::move(event)),
          reader_(at(newest_one)),
          pulse_(at(newest_one)),
          flag_(reinterpret_cast<shm::WaiterFlag*>(claim_->data() + protocol::claim_layout(capacity).waiter)),
          waiter_(flag_, event_.get(), reader_),
          pulse_waiter_(flag_, event_.get(), pulse_) {}

    bool next(Report& out) noexcept override {
        const std::uint64_t missed_before = reader_.missed();
        const bool got = reader_.next(&out);
        if (reader_.missed() != missed_before)  // for the table of clients; orders nothing
            shm::HardwareMemory::store(flag_->missed, reader_.missed(), std::memory_order::relaxed);
        return got;
    }
    bool latest(Report& out) noexcept override { return reader_.latest(&out); }
    bool newest(Report& out) const noexcept override {
        // The newest slot is overwritten only 4095 reports later, so one retry is more than enough.
        for (int attempt = 0; attempt < 2; ++attempt) {
            const std::uint64_t end = reader_.published();
            if (end > 0 && reader_.at(end - 1, &out)) return true;
        }
        return false;
    }
    bool fresh() const noexcept override { return reader_.fresh(); }
    std::uint64_t unread() const noexcept override { return reader_.unread(); }
    std::uint64_t missed() const noexcept override { return reader_.missed(); }
    void wait(std::chrono::nanoseconds timeout) noexcept override { waiter_.wait(timeout); }
    void wait_cycle(std::chrono::nanoseconds timeout) noexcept override {
        pulse_ = at(reader_.published());
        pulse_waiter_.wait(timeout);
    }
    int event() const noexcept override { return event_.get(); }
    void rearm() noexcept override { waiter_.rearm(); }

  private:
    static constexpr std::uint64_t newest_one = shm::BroadcastReader::newest;
    shm::BroadcastReader at(std::uint64_t start) const {
        return {device_->data() + protocol::device_layout().reports, protocol::report_slots, sizeof(Report),
                start};
    }

    std::shared_ptr<const shm::Segment> device_;
    std::shared_ptr<shm::Segment> claim_;
    shm::UniqueFd event_;
    shm::BroadcastReader reader_;
    shm::BroadcastReader pulse_;  // a second position in the same ring: where wait_cycle began
    shm::WaiterFlag* flag_;
    shm::Waiter waiter_;
    shm::Waiter pulse_waiter_;
};

class LocalChannel final : public ClaimChannel {
  public:
    LocalChannel(std::shared_ptr<shm::Segment> claim, const protocol::ClaimCapacity& capacity)
        : claim_(std::move(claim)),
          layout_(protocol::claim_layout(capacity)),
          most_entries_(capacity.representations),
          commands_(claim_->data() + layout_.commands, layout_.command_cells),
          replies_(claim_->data() + layout_.replies, protocol::reply_cells),
          batches_(claim_->data() + layout_.batches, layout_.batch_slot_bytes),
          feedback_(claim_->data() + layout_.feedback, layout_.feedback_slot_bytes),
          sent_(reinterpret_cast<shm::WaiterFlag*>(claim_->data() + layout_.waiter)) {}

    bool push(const void* commands, std::uint32_t cells) noexcept override {
        const bool pushed = commands_.try_push(commands, cells);
        sent_.add();
        return pushed;
    }
    std::uint32_t command_cells() const noexcept override { return commands_.capacity(); }

    bool reply(protocol::Reply& out) noexcept override {
        if (replies_.available() == 0 || !replies_.peek(0, &out, 1)) return false;
        replies_.pop(1);
        return true;
    }

    bool publish(const protocol::BatchHeader& header, std::span<const std::byte> entries) noexcept override {
        const std::array parts{std::as_bytes(std::span(&header, 1)), entries};
        const bool taken = batches_.publish(header.commands_before, parts);
        sent_.add();
        return taken;
    }

    bool feedback(protocol::FeedbackHeader& header, std::vector<protocol::FeedbackEntry>& entries) override {
        if (!feedback_.take()) return false;
        feedback_.copy(&header, 0, sizeof header);
        entries.resize(std::min(header.entries, most_entries_));
        feedback_.copy(entries.data(), sizeof header, entries.size() * sizeof(protocol::FeedbackEntry));
        return true;
    }

  private:
    std::shared_ptr<shm::Segment> claim_;
    protocol::ClaimLayout layout_;
    std::uint32_t most_entries_;
    shm::SpscProducer commands_;
    shm::SpscConsumer replies_;
    shm::TripleWriter batches_;
    shm::TripleReader feedback_;
    shm::SentCount sent_;
};
static_assert(sizeof(protocol::Reply) == shm::cell_bytes);
static_assert(sizeof(protocol::BatchHeader) % 8 == 0 && sizeof(protocol::EntryHeader) % 8 == 0);
static_assert(sizeof(protocol::FeedbackHeader) % 8 == 0 && sizeof(protocol::FeedbackEntry) % 8 == 0);

}  // namespace

std::unique_ptr<ClaimChannel> local_channel(std::shared_ptr<shm::Segment> claim,
                                            const protocol::ClaimCapacity& capacity) {
    return std::make_unique<LocalChannel>(std::move(claim), capacity);
}

std::shared_ptr<ReportSource> local_reports(std::shared_ptr<const shm::Segment> device,
                                            std::shared_ptr<shm::Segment> claim,
                                            const protocol::ClaimCapacity& capacity, shm::UniqueFd event) {
    return std::make_shared<LocalReports>(std::move(device), std::move(claim), capacity, std::move(event));
}

}  // namespace knurl::detail
