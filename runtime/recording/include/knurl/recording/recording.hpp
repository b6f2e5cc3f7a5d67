#pragma once
// A recording: an MCAP file with two channels and a word about where it comes from.
//
//   /knurl/report   every report, as it lies in memory: ros2msg schema, cdr encoding; Foxglove and
//                   PlotJuggler plot it
//   /knurl/inputs   every input of Servo::step (knurl/servo/input_log.hpp): u16 type, six zero bytes, the record's
//                   bytes; type 0: records are missing here. For `knurl replay` alone
//   attachment "asset-DIGEST"  what an application sent (protocol/asset.hpp), by its SHA-256, once each
//   metadata "knurl"  build, servo, device, and what the servo was configured with
//   metadata "knurl missing"  digests of assets that were felt and are not in the file
//
// Times are CLOCK_REALTIME; `realtime_offset_ns` in the metadata is what was added to the servo's
// CLOCK_MONOTONIC.

#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <knurl/protocol/asset.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/recording/mcap.hpp>
#include <knurl/servo/input_log.hpp>
#include <knurl/servo/servo.hpp>

namespace knurl::recording {

struct RecordingInfo {
    std::string version;  // of Knurl
    // protocol::wire_hash, servo::input_log_layout, servo::figures_of
    std::uint64_t wire = 0, input_log_layout = 0, figures = 0;
    std::string servo, device, address, profile;
    std::string cause;  // of a salvaged one: why the servo ended
    std::int64_t realtime_offset_ns = 0;
    servo::ServoOptions options;
};

class RecordingWriter {
  public:
    /// Throws std::runtime_error.
    RecordingWriter(const std::string& path, const RecordingInfo& info, Existing existing);

    void report(const Report& report);
    void input(const servo::InputRecord& record);
    void gap();
    /// An asset of which the next inputs may tell. `between`: called now and then, to read on; it must not
    /// flush. False: the disk is full, it was dropped and counted.
    bool asset(const protocol::AssetDigest& digest, std::span<const std::byte> source,
               const std::function<void()>& between);
    bool has(const protocol::AssetDigest& digest) const { return assets_.contains(digest); }
    void missing(const protocol::AssetDigest& digest) { missing_.insert(digest); }
    std::size_t missing() const { return missing_.size(); }  // for good so far
    /// What was put in so far goes into the file; false: the disk is full, it was dropped and counted.
    bool flush();
    bool full() const noexcept { return file_.full(); }
    std::uint64_t pending() const noexcept { return file_.pending(); }  // messages since the last flush
    /// False: the disk is full, and the file has no index.
    bool finish();

    std::uint64_t dropped() const noexcept { return dropped_; }  // messages
    std::uint64_t bytes() const noexcept { return file_.bytes(); }
    const std::string& problem() const noexcept { return file_.problem(); }

  private:
    McapWriter file_;
    std::int64_t offset_, last_ = 0;  // ns
    std::uint16_t reports_ = 0, inputs_ = 0;
    std::uint64_t dropped_ = 0;
    std::set<protocol::AssetDigest> assets_, missing_;
};

class RecordingReader {
  public:
    /// Throws std::runtime_error: not ours, not whole, not readable.
    explicit RecordingReader(const std::string& path);

    const RecordingInfo& info() const noexcept { return info_; }
    /// Of those that are in what was read so far. Throws std::runtime_error, without the file's name.
    std::vector<std::byte> asset(const protocol::AssetDigest& digest);
    /// Throws std::runtime_error unless this build made it: only then it replays.
    void require_this_build() const;

    enum class Item { report, input, gap, end };
    /// The next one, in `report` or `input`. Throws std::runtime_error: the file was changed.
    Item next();
    Report report;
    servo::InputRecord input;

    std::optional<std::uint64_t> cut_off_at() const noexcept { return file_.cut_off_at(); }

  private:
    std::string path_;
    McapReader file_;
    RecordingInfo info_;
    std::uint16_t reports_ = 0, inputs_ = 0;
};

}  // namespace knurl::recording
