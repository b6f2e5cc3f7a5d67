#pragma once
// The servo's end of a peer's claim or observer: an ordinary claim of this process. Relays both directions.

#include <memory>
#include <string>
#include <vector>

#include <knurl/link/transport.hpp>

#include "batch_assembly.hpp"
#include "datagram_channel.hpp"
#include "frame_stream.hpp"
#include "out_queue.hpp"

namespace knurl::bridge {

/// What all streams of a peer use to send.
struct Way {
    FrameStream& frames;
    OutgoingDatagrams& outgoing;
    OutQueue& out;
    PathMtu& mtu;
};

class PeerStream {
  public:
    PeerStream(std::uint32_t id, detail::Attachment attachment, double report_rate);

    std::uint32_t device() const noexcept { return attachment_.device_index; }
    const detail::Attachment& attachment() const noexcept { return attachment_; }

    /// Reports go to this address from now on.
    void bind(const PeerAddress& to) noexcept { to_ = to; }

    // Each of these returns false if the peer must be closed, for `why`.
    bool commands(std::span<const std::byte> cells, Role role, const char*& why) noexcept;
    bool batch(std::span<const std::byte> whole, const char*& why) noexcept;  // by TCP
    /// After a cycle: its report, answers, feedback. `unseen`: number of reports before it that the bridge
    /// missed.
    bool cycle(const Report& report, std::uint64_t unseen, std::int64_t now, const Way& way,
               const char*& why) noexcept;

    void batch_piece(const DatagramHeader& header, std::span<const std::byte> body) noexcept;
    /// Records the newest report and advances the number by `numbers`. Called from outside for the first
    /// report, before the first cycle().
    void note(const Report& newest, std::uint64_t numbers = 1) noexcept;
    /// For a peer without a report: sends the newest again, with its own number.
    void repeat(const Way& way) noexcept;

  private:
    bool push_waiting() noexcept;
    bool answer(const Way& way, const char*& why) noexcept;
    void publish(std::span<const std::byte> whole) noexcept;
    std::uint64_t due(const Report& report, std::uint64_t unseen) noexcept;
    void send(const Report* report, const Way& way) noexcept;
    bool send_feedback(std::int64_t now, const Way& way) noexcept;
    std::size_t pieces(const Way& way, bool report) const noexcept;

    const std::uint32_t id_;
    detail::Attachment attachment_;
    std::int64_t period_ns_, due_ns_ = 0;  // by the reports' deadlines; 0: each report
    PeerAddress to_{};                     // no address: not bound yet
    // of the newest report, sent or not
    std::uint64_t number_ = 0;
    Report newest_{};

    std::vector<std::byte> waiting_;  // commands for which the servo's ring had no room; reserved
    std::vector<std::byte> scratch_;  // commands to be marked; reserved
    BatchAssembly batches_;
    protocol::FeedbackHeader feedback_;
    std::vector<protocol::FeedbackEntry> entries_;
    std::uint64_t answers_ = 0;                        // number sent
    std::uint64_t told_batch_ = 0, told_refused_ = 0;  // acknowledged to the peer so far
    std::uint64_t feedback_sent_ = 0;                  // cycle of the last feedback by TCP
    std::int64_t feedback_sent_ns_ = 0;
};

}  // namespace knurl::bridge
