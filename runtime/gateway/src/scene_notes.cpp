#include <algorithm>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include <knurl/gateway/live_view.hpp>
#include <knurl/gateway/scene_notes.hpp>
#include <knurl/messages/channels.hpp>
#include <knurl/messages/markers.hpp>
#include <knurl/protocol/text.hpp>

#include "foxglove_scene.hpp"
#include "live_text.hpp"

namespace knurl::gateway {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto look_every = std::chrono::milliseconds(33);
constexpr auto whole_every = std::chrono::seconds(10);

std::string arm_text(std::uint32_t device, std::span<const Vec3> points) {
    std::string text = fmt::format(R"({{"op":"arm","device":{},"points":[)", device);
    for (std::size_t i = 0; i < points.size(); ++i)
        text +=
            fmt::format("{}[{:.5f},{:.5f},{:.5f}]", i > 0 ? "," : "", points[i].x, points[i].y, points[i].z);
    return text + "]}";
}

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

struct SceneNotes::Impl {
    LiveView view;
    std::string device;
    std::int64_t offset;
    std::optional<Clock::time_point> looked, whole;
    std::uint64_t epoch = 0;
    std::optional<std::uint64_t> version;  // of the scene that was told last
    std::string arm;                       // likewise
    bool felt_before = false;
    FoxgloveScene markers;
    std::set<std::tuple<std::uint64_t, std::uint32_t, const void*>> meshes;  // that were written
    std::vector<SceneNote> notes;
    std::int64_t read_ns = 0;

    Impl(const std::string& servo, std::string name, std::int64_t realtime_offset)
        : view(servo), device(std::move(name)), offset(realtime_offset) {}

    void add(SceneNote::Form form, std::string bytes) {
        if (!bytes.empty()) notes.push_back({.form = form, .read_ns = read_ns, .bytes = std::move(bytes)});
    }
    void begin() {
        epoch = view.epoch();
        felt_before = false;
        whole.reset();
        arm.clear();
        markers = {};
        meshes.clear();
        add(SceneNote::Form::page, servo_text(view, std::vector<bool>(view.devices().size(), false)));
    }
    void tell_page(std::uint32_t number, const SeenDevice& seen, Clock::time_point now) {
        if (!whole || now - *whole >= whole_every) {
            whole = now;
            version.reset();
        }
        if (seen.scene_version != version)
            add(SceneNote::Form::page, scene_text(number, seen, version.value_or(0), {}));
        version = seen.scene_version;
        add(SceneNote::Form::page, felt_text(number, seen, felt_before));
        if (std::string now_there = arm_text(number, seen.arm); now_there != arm)
            add(SceneNote::Form::page, arm = std::move(now_there));
    }
    void write_meshes(const SeenDevice& seen) {
        for (const auto& [number, claim] : seen.claims) {
            for (const auto& [asset, mesh] : claim.assets) {
                if (mesh == nullptr || !meshes.emplace(number, asset, mesh.get()).second) continue;
                std::string bytes;
                append(bytes, std::uint64_t{number});
                append(bytes, std::uint32_t{asset});
                append(bytes, std::uint32_t{0});
                add(SceneNote::Form::mesh, bytes + mesh_bytes(*mesh));
            }
        }
    }
    void draw_markers(const SeenDevice& seen, Clock::time_point now) {
        const std::vector<messages::Marker> drawn = markers.changes(seen, now);
        if (drawn.empty()) return;
        const messages::Bytes message =
            messages::markers_message(messages::base_frame(device), read_ns + offset, drawn);
        add(SceneNote::Form::markers, {reinterpret_cast<const char*>(message.data()), message.size()});
    }
};

SceneNotes::SceneNotes(const std::string& servo, std::string device, std::int64_t realtime_offset_ns)
    : impl_(std::make_unique<Impl>(servo, std::move(device), realtime_offset_ns)) {}
SceneNotes::~SceneNotes() = default;

const std::string& SceneNotes::trouble() const {
    return impl_->view.trouble();
}

std::vector<SceneNote> SceneNotes::look(Clock::time_point now) {
    Impl& all = *impl_;
    if (all.looked && now - *all.looked < look_every) return {};
    all.looked = now;
    all.view.tick(now);
    const auto devices = all.view.devices();
    const auto seen = std::find_if(devices.begin(), devices.end(), [&](const SeenDevice& one) {
        return protocol::printable(one.info.name) == all.device;
    });
    if (!all.view.connected() || seen == devices.end() || !seen->newest) return {};
    all.read_ns = seen->newest->read_ns;
    if (all.epoch != all.view.epoch()) all.begin();
    all.write_meshes(*seen);
    all.tell_page(static_cast<std::uint32_t>(seen - devices.begin()), *seen, now);
    all.draw_markers(*seen, now);
    return std::exchange(all.notes, {});
}

}  // namespace knurl::gateway
