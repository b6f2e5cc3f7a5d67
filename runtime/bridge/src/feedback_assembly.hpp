#pragma once
// Assembles feedback from its datagrams. The acknowledgement of batches counts on arrival. The entries count
// when all of one cycle have arrived, and never go back to an older cycle. The acknowledgement is shown only
// after the answers to earlier commands have arrived by TCP, as on one host.

#include <algorithm>
#include <vector>

#include "wire.hpp"

namespace knurl::bridge {

class FeedbackAssembly {
  public:
    explicit FeedbackAssembly(std::uint32_t representations)
        : coming_(representations), whole_(representations) {}

    /// `answers`: number of answers to commands that were sent before it.
    void header(const protocol::FeedbackHeader& header, std::uint64_t answers) noexcept {
        if (header.cycle < newest_.header.cycle) return;
        newest_ = {.header = header, .answers = answers};
        // One header waits for its answers while newer ones arrive. Else a steady stream of commands would
        // never show any.
        if (!waits_) waiting_ = newest_;
        waits_ = true;
        if (header.entries == 0) finish(header.cycle, 0);
    }

    /// `bytes`: `entries` FeedbackEntry structs from index `first` on, of `cycle`.
    void piece(const DatagramHeader& header, const ReportPiece& piece,
               std::span<const std::byte> bytes) noexcept {
        if (piece.feedback_cycle <= whole_cycle_ || piece.feedback_cycle < coming_cycle_) return;
        if (header.pieces == 0 || header.pieces > max_pieces || header.piece >= header.pieces) return;
        if (piece.first_entry > coming_.size() || piece.entries > coming_.size() - piece.first_entry ||
            bytes.size() != piece.entries * sizeof(protocol::FeedbackEntry))
            return;
        if (piece.feedback_cycle != coming_cycle_ || header.pieces != pieces_) {
            coming_cycle_ = piece.feedback_cycle;
            pieces_ = header.pieces;
            here_ = 0;
            entries_ = 0;
        }
        if (!bytes.empty())
            std::memcpy(static_cast<void*>(coming_.data() + piece.first_entry), bytes.data(), bytes.size());
        here_ |= 1u << header.piece;
        entries_ = std::max(entries_, piece.first_entry + piece.entries);
        if (here_ != (1u << pieces_) - 1) return;
        std::swap(coming_, whole_);
        finish(coming_cycle_, entries_);
    }

    /// All of it at once, by TCP.
    void all(const protocol::FeedbackHeader& now, std::span<const std::byte> bytes) noexcept {
        header(now, 0);  // its answers came before it
        if (now.cycle <= whole_cycle_ || now.entries > whole_.size() ||
            bytes.size() != now.entries * sizeof(protocol::FeedbackEntry))
            return;
        if (!bytes.empty()) std::memcpy(static_cast<void*>(whole_.data()), bytes.data(), bytes.size());
        finish(now.cycle, now.entries);
    }

    std::uint64_t newest_cycle() const noexcept { return newest_.header.cycle; }

    /// `answers`: number that has arrived. True: something is new since the last call.
    bool take(std::uint64_t answers, protocol::FeedbackHeader& header,
              std::vector<protocol::FeedbackEntry>& entries) {
        if (waits_ && newest_.answers <= answers) waiting_ = newest_;
        if (waits_ && waiting_.answers <= answers) {
            shown_ = waiting_.header;
            waits_ = newest_.header.cycle > shown_.cycle;
            waiting_ = newest_;
            changed_ = true;
        }
        if (!changed_) return false;
        changed_ = false;
        header = shown_;
        header.cycle = whole_cycle_;  // the cycle of the entries
        header.entries = whole_size_;
        entries.assign(whole_.begin(), whole_.begin() + whole_size_);
        return true;
    }

  private:
    void finish(std::uint64_t cycle, std::uint32_t entries) noexcept {
        whole_cycle_ = std::max(whole_cycle_, cycle);
        whole_size_ = entries;
        changed_ = true;
    }

    struct Numbered {
        protocol::FeedbackHeader header;
        std::uint64_t answers = 0;
    };
    Numbered newest_, waiting_;
    protocol::FeedbackHeader shown_;
    bool waits_ = false;
    std::vector<protocol::FeedbackEntry> coming_, whole_;
    std::uint64_t coming_cycle_ = 0, whole_cycle_ = 0;
    std::uint32_t whole_size_ = 0, entries_ = 0;
    unsigned pieces_ = 0, here_ = 0;
    bool changed_ = false;
};

}  // namespace knurl::bridge
