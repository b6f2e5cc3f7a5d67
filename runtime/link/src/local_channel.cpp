#include <array>
#include <cerrno>
#include <cstring>
#include <optional>

#include <sys/epoll.h>
#include <unistd.h>

#include <knurl/link/error.hpp>
#include <knurl/link/local.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::detail {

namespace {

/// Readable when the servo has woken us, or when we raised it ourselves: only the servo can make our socket
/// readable.
class ReportEvent {
  public:
    explicit ReportEvent(int wake_fd) try : own_(shm::make_event()), both_(::epoll_create1(EPOLL_CLOEXEC)) {
        watch(wake_fd);
        watch(own_.get());
    } catch (const Error&) {
        throw;
    } catch (const std::exception& reason) {
        throw Error(Error::Kind::exhausted, reason.what());
    }
    int fd() const noexcept { return both_.get(); }
    void raise(bool raised) noexcept {
        if (raised == raised_) return;
        raised_ = raised;
        std::uint64_t count = 1;
        [[maybe_unused]] const ssize_t done =
            raised ? ::write(own_.get(), &count, sizeof count) : ::read(own_.get(), &count, sizeof count);
    }

  private:
    void watch(int fd) {
        epoll_event event{.events = EPOLLIN, .data = {}};
        if (!both_ || ::epoll_ctl(both_.get(), EPOLL_CTL_ADD, fd, &event) != 0)
            throw Error(Error::Kind::exhausted,
                        detail::format("descriptor for reports: {}; see the limit of open files (ulimit -n)",
                                       std::strerror(errno)));
    }
    shm::UniqueFd own_, both_;
    bool raised_ = false;
};

class LocalReports final : public ReportSource {
  public:
    LocalReports(std::shared_ptr<const shm::Segment> device, std::shared_ptr<shm::Segment> claim,
                 const protocol::ClaimCapacity& capacity, shm::UniqueFd wake_fd)
        : device_(std::move(device)),
          claim_(std::move(claim)),
          wake_fd_(std::move(wake_fd)),
          reader_(at(newest_one)),
          pulse_(at(newest_one)),
          flag_(reinterpret_cast<shm::WaiterFlag*>(claim_->data() + protocol::claim_layout(capacity).waiter)),
          waiter_(flag_, wake_fd_.get(), reader_),
          pulse_waiter_(flag_, wake_fd_.get(), pulse_) {}

    bool next(Report& out) noexcept override {
        const std::uint64_t missed_before = reader_.missed();
        const bool got = reader_.next(&out);
        tell_missed(missed_before);
        return got;
    }
    std::size_t next_some(std::byte* out, std::size_t stride, std::size_t most) noexcept override {
        const std::uint64_t missed_before = reader_.missed();
        const std::size_t got = reader_.next_some(out, stride, most);
        tell_missed(missed_before);
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
    int event() override {
        if (!event_) event_.emplace(wake_fd_.get());
        return event_->fd();
    }
    void rearm() noexcept override {
        const bool waits = waiter_.rearm();
        if (event_) event_->raise(!waits);
    }

  private:
    void tell_missed(std::uint64_t before) noexcept {
        if (reader_.missed() != before)  // for the table of clients; orders nothing
            shm::HardwareMemory::store(flag_->missed, reader_.missed(), std::memory_order::relaxed);
    }

    static constexpr std::uint64_t newest_one = shm::BroadcastReader::newest;
    shm::BroadcastReader at(std::uint64_t start) const {
        return {device_->data() + protocol::device_layout().reports, protocol::report_slots, sizeof(Report),
                start};
    }

    std::shared_ptr<const shm::Segment> device_;
    std::shared_ptr<shm::Segment> claim_;
    shm::UniqueFd wake_fd_;
    std::optional<ReportEvent> event_;  // made for event loops alone
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
                                            const protocol::ClaimCapacity& capacity, shm::UniqueFd wake_fd) {
    return std::make_shared<LocalReports>(std::move(device), std::move(claim), capacity, std::move(wake_fd));
}

}  // namespace knurl::detail
