#pragma once
// A recording: an MCAP file with two channels and a word about where it comes from.
//
//   /knurl/report   every report, as it lies in memory: ros2msg schema, cdr encoding; Foxglove and
//   PlotJuggler plot it /knurl/inputs   every input of Servo::step (knurl/servo/tape.hpp): u16 type, six zero
//   bytes, the record's bytes;
//                   type 0: records are missing here. For `knurl replay` alone
//   metadata "knurl"  build, servo, device, and what the servo was configured with
//
// Times are CLOCK_REALTIME; `realtime_offset_ns` in the metadata is what was added to the servo's
// CLOCK_MONOTONIC.

#include <cstdint>
#include <string>

#include <knurl/protocol/report.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/servo/tape.hpp>

#include "mcap.hpp"

namespace knurl::cli {

struct RecordingInfo {
    std::string version;  // of Knurl
    std::uint64_t wire = 0, tape = 0,
                  figures = 0;  // protocol::wire_hash, servo::tape_layout, servo::figures_of
    std::string servo, device, address, profile;
    std::string cause;  // of a salvaged one: why the servo ended
    std::int64_t realtime_offset_ns = 0;
    servo::ServoOptions options;
};

class RecordingWriter {
  public:
    /// Throws std::runtime_error.
    RecordingWriter(const std::string& path, const RecordingInfo& info);

    void report(const Report& report);
    void input(const servo::TapeRecord& record);
    void gap();
    /// What was put in so far goes into the file; false: the disk is full, it was dropped and counted.
    bool flush();
    bool full() const noexcept { return file_.full(); }
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
};

class RecordingReader {
  public:
    /// Throws std::runtime_error: not ours, not whole, not readable.
    explicit RecordingReader(const std::string& path);

    const RecordingInfo& info() const noexcept { return info_; }
    /// Throws std::runtime_error unless this build made it: only then it replays.
    void require_this_build() const;

    enum class Item { report, input, gap, end };
    /// The next one, in `report` or `input`. Throws std::runtime_error: the file was changed.
    Item next();
    Report report;
    servo::TapeRecord input;

    std::optional<std::uint64_t> cut_off_at() const noexcept { return file_.cut_off_at(); }

  private:
    std::string path_;
    McapReader file_;
    RecordingInfo info_;
    std::uint16_t reports_ = 0, inputs_ = 0;
};

}  // namespace knurl::cli
