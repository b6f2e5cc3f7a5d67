#pragma once
// Commands under way and their answers. Keeps a claim within its command ring at the servo. A command
// occupies its cells until the application has read its answer. So the ring at the other end always has room
// for what arrives, and no queue here can grow.

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <knurl/protocol/command.hpp>
#include <knurl/shm/spsc_ring.hpp>

namespace knurl::bridge {

class Unanswered {
  public:
    /// `cells`: size of the command ring; 0: no claim.
    explicit Unanswered(std::uint32_t cells) : cells_(cells), sent_(cells), replies_(cells) {}

    std::uint32_t capacity() const noexcept { return cells_; }
    bool fits(std::uint32_t cells) const noexcept { return cells <= cells_ - used_; }

    /// A group was sent: whole messages, which fit.
    void sent(const void* commands, std::uint32_t cells) noexcept {
        const auto* at = static_cast<const std::byte*>(commands);
        const auto* const end = at + std::size_t{cells} * shm::cell_bytes;
        while (at < end) {
            protocol::CommandHeader header;
            std::memcpy(&header, at, sizeof header);
            if (header.cells == 0) return;
            Sent& command = sent_[sent_end_++ % cells_];
            command = {.number = header.number, .cells = header.cells};
            if (header.type == protocol::CommandType::remove) {
                std::memcpy(&command.removed, at + sizeof header, sizeof command.removed);
                command.removes = true;
            }
            used_ += header.cells;
            at += std::size_t{header.cells} * shm::cell_bytes;
        }
    }

    /// An answer has arrived. One without a request is dropped.
    void answered(const protocol::Reply& reply) noexcept {
        if (replies_end_ - replies_begin_ >= sent_end_ - sent_begin_) return;
        replies_[replies_end_++ % cells_] = reply;
    }
    std::uint64_t answers() const noexcept { return replies_end_; }  // number that has arrived

    struct Answer {
        protocol::Reply reply;
        bool removed = false;  // the servo has removed `id`
        RepresentationId id;
    };
    /// The next answer for the application. False: none.
    bool next(Answer& answer) noexcept {
        if (replies_begin_ == replies_end_) return false;
        answer.reply = replies_[replies_begin_++ % cells_];
        // A command without an answer was malformed, and so were all after it: the servo takes no more.
        while (sent_begin_ != sent_end_ && sent_[sent_begin_ % cells_].number <= answer.reply.command) {
            const Sent& command = sent_[sent_begin_++ % cells_];
            used_ -= command.cells;
            const bool ok = static_cast<Verdict::Code>(answer.reply.code) == Verdict::Code::ok;
            answer.removed = ok && command.removes && command.number == answer.reply.command;
            answer.id = command.removed;
        }
        return true;
    }

  private:
    struct Sent {
        std::uint64_t number = 0;
        std::uint32_t cells = 0;
        bool removes = false;
        RepresentationId removed{};
    };
    std::uint32_t cells_, used_ = 0;
    std::vector<Sent> sent_;
    std::vector<protocol::Reply> replies_;
    std::uint64_t sent_begin_ = 0, sent_end_ = 0, replies_begin_ = 0, replies_end_ = 0;
};

}  // namespace knurl::bridge
