#pragma once
// A recording: an MCAP file with channels that Foxglove, Lichtblick and PlotJuggler show, one for replay, and metadata
// about its origin.
//
//   /DEVICE/report  every report, as it lies in memory: ros2msg schema, cdr encoding
//   /DEVICE/measured_cp, measured_cf, measured_cv, measured_js, joy, /tf
//                   the report in the types of ROS 2 (messages/channels.hpp), 100 times a second
//   /DEVICE/scene   the scenes as visualization_msgs/MarkerArray, while they change
//   /knurl/scene    the scenes as knurl-web's page is told of them, JSON (knurl/gateway/scene_notes.hpp)
//   /knurl/mesh     their meshes, drawn
//   /knurl/inputs   every input of Servo::step (knurl/servo/input_log.hpp): u16 type, six zero bytes, the record's
//                   bytes; type 0: records are missing here. Only for `knurl replay`
//   attachment "asset-DIGEST"  an application's asset (protocol/asset.hpp), by its SHA-256, once each
//   metadata "knurl"  build, servo, device, and the servo's configuration
//   metadata "knurl missing"  digests of assets in use that are not in the file
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
#include <knurl/recording/report_channels.hpp>
#include <knurl/servo/input_log.hpp>
#include <knurl/servo/servo.hpp>

namespace knurl::recording {

struct RecordingInfo {
    std::string version;  // of Knurl
    // protocol::wire_hash, servo::input_log_layout, servo::figures_of
    std::uint64_t wire = 0, input_log_layout = 0, figures = 0;
    std::string servo, device, address, profile;
    std::string cause;         // if salvaged: why the servo ended
    std::uint32_t joints = 0;  // of a writer: how many are sensed; 0: not known
    std::int64_t realtime_offset_ns = 0;
    servo::ServoOptions options;
};

class RecordingWriter {
  public:
    /// Throws std::runtime_error.
    RecordingWriter(const std::string& path, const RecordingInfo& info, Existing existing);

    void report(const Report& report);
    void input(const servo::InputRecord& record);
    /// A message of /DEVICE/scene, /knurl/scene or /knurl/mesh; `read_ns`: of the newest report at that time.
    enum class Scene { markers, page, mesh };
    void scene(Scene form, std::int64_t read_ns, std::span<const std::byte> message);
    void gap();
    /// An asset to which the next inputs may refer. `between`: called at times, to continue reading; it must
    /// not flush. False: the disk is full; the asset was dropped and counted.
    bool asset(const protocol::AssetDigest& digest, std::span<const std::byte> source,
               const std::function<void()>& between);
    bool has(const protocol::AssetDigest& digest) const { return assets_.contains(digest); }
    void missing(const protocol::AssetDigest& digest) { missing_.insert(digest); }
    std::size_t missing() const { return missing_.size(); }  // permanently, so far
    /// Writes what was added so far; false: the disk is full; it was dropped and counted.
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
    ReportChannels channels_;
    std::uint16_t inputs_ = 0, page_ = 0, meshes_ = 0;
    std::uint64_t dropped_ = 0;
    std::set<protocol::AssetDigest> assets_, missing_;
};

class RecordingReader {
  public:
    /// Throws std::runtime_error: not a recording, incomplete, or unreadable.
    explicit RecordingReader(const std::string& path) : RecordingReader(McapReader(path), path) {}
    /// The same from an opened file; `path` begins its errors.
    RecordingReader(McapReader file, const std::string& path);

    const RecordingInfo& info() const noexcept { return info_; }
    /// An asset in the part that was read. Throws std::runtime_error, without the file's name.
    std::vector<std::byte> asset(const protocol::AssetDigest& digest);
    /// Throws std::runtime_error unless this build made it, as replay requires.
    void require_this_build() const;

    enum class Item { report, input, gap, end };
    /// The next item, in `report` or `input`. Throws std::runtime_error: the file was changed.
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
