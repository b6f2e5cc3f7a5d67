#pragma once

/// @file
/// The seam between the library and what carries the two channels. On one box that is shared memory
/// (local.hpp); the bridge carries them to another host and implements the same three classes, and nothing
/// above this line differs.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <knurl/link/device.hpp>
#include <knurl/link/error.hpp>
#include <knurl/link/network.hpp>
#include <knurl/protocol/asset.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::detail {

/// The reports of one device for one reader, in the device's frame.
class ReportSource {
  public:
    virtual ~ReportSource() = default;
    virtual bool next(Report& out) noexcept = 0;  // in order
    /// As next(), of up to `most` reports: the one of number i goes to out + i * stride. Returns how many. What
    /// missed() has grown by lies before the first of them.
    virtual std::size_t next_some(std::byte* out, std::size_t stride, std::size_t most) noexcept = 0;
    virtual bool latest(Report& out) noexcept = 0;  // the newest, if it was not read yet; skips the others
    virtual bool newest(Report& out) const noexcept = 0;  // the newest; moves nothing
    virtual bool fresh() const noexcept = 0;              // next() has something
    virtual std::uint64_t unread() const noexcept = 0;    // how many that are
    virtual std::uint64_t missed() const noexcept = 0;

    /// Sleeps until fresh(), at most `timeout`.
    virtual void wait(std::chrono::nanoseconds timeout) noexcept = 0;
    /// Sleeps until the servo has ended another cycle, whatever was read, at most `timeout`.
    virtual void wait_cycle(std::chrono::nanoseconds timeout) noexcept = 0;
    /// Readable when a report comes after rearm(), and at once if one came before it. Throws Error.
    virtual int event() = 0;
    virtual void rearm() noexcept = 0;
    virtual Network network() const noexcept { return {}; }
};

/// The two channels of one claim. World frame of the claim.
class ClaimChannel {
  public:
    virtual ~ClaimChannel() = default;
    /// Whole messages, all or none; false: no room now. `cells` * 64 bytes.
    virtual bool push(const void* commands, std::uint32_t cells) noexcept = 0;
    virtual std::uint32_t command_cells() const noexcept = 0;  // that fit when it is empty
    virtual bool reply(protocol::Reply& out) noexcept = 0;     // the next one; false: none
    /// `entries` is header.bytes long. True: the batch before this one was taken.
    virtual bool publish(const protocol::BatchHeader& header,
                         std::span<const std::byte> entries) noexcept = 0;
    /// Takes what is newer than the last; false: nothing is.
    virtual bool feedback(protocol::FeedbackHeader& header,
                          std::vector<protocol::FeedbackEntry>& entries) = 0;
};

/// An asset on its way to the servo. Its end before the answer calls it off.
class AssetTransfer {
  public:
    virtual ~AssetTransfer() = default;
    virtual int event() const = 0;  // readable when the answer is there
    /// None: not in that time. Throws Error if it is refused; then it is over.
    virtual std::optional<protocol::AssetReady> answer(std::chrono::nanoseconds timeout) = 0;
};

/// Where a claim's assets go in. Throws Error.
class AssetDoor {
  public:
    virtual ~AssetDoor() = default;
    /// `source`: a memfd as protocol::AssetSource says, sealed.
    virtual std::unique_ptr<AssetTransfer> offer(std::uint32_t number, const shm::UniqueFd& source,
                                                 std::uint64_t bytes) = 0;
    virtual void forget(std::uint32_t number) = 0;
};

/// What an attach brings. `channel` and `assets` are null for an observer; who observes and resets has a
/// channel.
struct Attachment {
    protocol::Claimed terms;
    DeviceDescription device;
    std::uint32_t device_index = 0;
    std::shared_ptr<ReportSource> reports;
    std::unique_ptr<ClaimChannel> channel;
    std::shared_ptr<AssetDoor> assets;
};

/// One connection to a servo.
class Link {
  public:
    virtual ~Link() = default;
    virtual const std::vector<DeviceDescription>& devices() const = 0;
    virtual pid_t servo_pid() const = 0;
    /// poll() says POLLHUP or POLLRDHUP when the servo has gone.
    virtual int hang_up() const = 0;
    /// After that: one line, what has happened and what to do.
    virtual std::string why_it_ended() = 0;
    /// Throws Error; request.device is ignored, `device` is the index in devices().
    virtual Attachment attach(std::uint32_t device, protocol::ClaimRequest request) = 0;
    virtual void release(const Attachment& attachment) noexcept = 0;
};

}  // namespace knurl::detail
