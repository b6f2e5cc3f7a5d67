#pragma once

/// @file
/// What a recording has of a device beside its reports and inputs: what was in its scenes, so that who opens the file
/// sees it. The page is shown the same messages live (knurl.live.v1), and Foxglove the same markers.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace knurl::gateway {

/// One message.
struct SceneNote {
    /// Whom it is for.
    enum class Form {
        /// A text of knurl.live.v1: `servo` first, then `scene`, `felt`, and `arm`, which is what `frame` has of it.
        page,
        /// u64 claim, u32 number of the asset, u32 0, then the mesh as `GET /asset` gives it.
        mesh,
        /// visualization_msgs/MarkerArray.
        markers
    };
    /// Whom it is for.
    Form form = Form::page;
    /// Of the newest report at that time, CLOCK_MONOTONIC (ns).
    std::int64_t read_ns = 0;
    /// The message.
    std::string bytes;
};

/// Watches one device of a servo on this host.
class SceneNotes {
  public:
    /// `servo`: as Client::connect takes it. `realtime_offset_ns`: what is added to CLOCK_MONOTONIC in stamps.
    SceneNotes(const std::string& servo, std::string device, std::int64_t realtime_offset_ns);
    ~SceneNotes();
    SceneNotes(const SceneNotes&) = delete;
    SceneNotes& operator=(const SceneNotes&) = delete;

    /// What has changed, at most 30 times a second; every ten seconds all of it once more, so that a reader of the file
    /// can begin in the middle. Nothing while the servo does not answer.
    std::vector<SceneNote> look(std::chrono::steady_clock::time_point now);
    /// Why it sees nothing; empty: it sees.
    const std::string& trouble() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::gateway
