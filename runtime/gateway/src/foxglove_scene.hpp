#pragma once
// A device's scenes as markers, for one subscription: what has changed since it was sent something the last time. So a slow
// peer gets what there is then, and none of what was in between.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <knurl/gateway/live_view.hpp>
#include <knurl/messages/drawing.hpp>

namespace knurl::gateway {

class FoxgloveScene {
  public:
    using Time = std::chrono::steady_clock::time_point;

    /// Markers to draw and delete that the subscriber has not; none: nothing has changed. At most about most_bytes:
    /// the rest comes with the next calls.
    std::vector<messages::Marker> changes(const SeenDevice& device, Time now);

    static constexpr std::size_t most_bytes = 1 << 20;

  private:
    using Key = std::pair<std::uint64_t, std::uint32_t>;  // claim, slot
    /// What of an item is seen, but for the hand.
    struct Look {
        std::uint32_t generation = 0;
        std::uint64_t version = 0;
        bool touching = false, fading = false, silent = false, asleep = false;
        std::shared_ptr<const SeenAsset> asset;  // of a mesh
        protocol::Frame frame;
        friend bool operator==(const Look& a, const Look& b) {
            return a.generation == b.generation && a.version == b.version && a.touching == b.touching &&
                   a.fading == b.fading && a.silent == b.silent && a.asleep == b.asleep &&
                   a.asset == b.asset && a.frame.device_centre == b.frame.device_centre &&
                   a.frame.world_centre == b.frame.world_centre && a.frame.scale == b.frame.scale &&
                   a.frame.force_scale == b.frame.force_scale;
        }
    };
    struct Drawn {
        Look look;
        Vec3 hand;  // when it was drawn
        std::set<std::int32_t> ids;
        std::size_t points = 0;
        Time at;
    };
    static Look look_of(const SeenClaim& claim, const SeenItem& item);
    static std::vector<messages::Marker> markers_of(const SeenDevice& device, const SeenClaim& claim,
                                                    const SeenItem& item, const Look& look, const Vec3& hand);
    void draw(const SeenDevice& device, const SeenClaim& claim, const SeenItem& item, Time now);
    void draw_changes(const SeenDevice& device, Time now);
    void wait(messages::Marker marker);

    std::map<Key, Drawn> drawn_;
    std::deque<messages::Marker> waiting_;
    std::size_t waiting_bytes_ = 0;
    Key last_{};  // that was looked at: the next call goes on behind it
    bool begun_ = false;
};

}  // namespace knurl::gateway
