// Foxglove's protocol: any texts and bytes of a peer, while devices and scenes come and go. Each text is answered by at
// most one status; what is sent is whole, bounded, and for a subscription that the peer has.

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <knurl/gateway/foxglove.hpp>
#include <knurl/json/json.hpp>
#include <knurl/reps/all.hpp>

#include "pieces.hpp"
#include "require.hpp"

using namespace knurl;
using fuzz::require;

namespace {

class Peer : public gateway::Socket {
  public:
    void send_text(std::string text) override {
        require(text.size() < 300'000, "a text is bounded");
        const Json said = Json::parse(text);
        const std::string op = said.at("op").get<std::string>();
        if (op != "status") return;
        ++statuses;
        const std::string message = said.at("message").get<std::string>();
        require(message.size() < 1000, "a status is short");
        for (const char c : message)
            require(static_cast<unsigned char>(c) >= ' ' && c != 0x7f, "a status is one line of text");
    }
    void send_binary(std::vector<std::byte> bytes) override {
        require(bytes.size() > 13 && bytes[0] == std::byte{1}, "message data");
        ++frames;
    }
    bool idle() const override { return is_idle; }
    void close(std::uint16_t, std::string) override {}
    gateway::Role role() const override { return gateway::Role::observe; }
    const std::string& peer() const override { return name_; }

    bool is_idle = true;
    std::size_t statuses = 0, frames = 0;

  private:
    std::string name_ = "127.0.0.1:1";
};

/// What the sockets look at.
struct World {
    std::vector<gateway::SeenDevice> devices;
    bool connected = true;
    std::uint64_t epoch = 1, cycle = 0;

    void add_device() {
        if (devices.size() >= 3) return devices.clear();
        gateway::SeenDevice& device = devices.emplace_back();
        device.info.name[0] = static_cast<char>('a' + devices.size());
        device.info.workspace_radius = 0.1;
    }
    void report() {
        for (gateway::SeenDevice& device : devices) {
            device.newest.emplace();
            device.newest->cycle = ++cycle;
            device.fresh.assign(2, *device.newest);
        }
    }
    /// An item of these bytes: kind, slot, parameters; without them it goes.
    void put(std::span<const std::byte> bytes) {
        if (devices.empty() || bytes.size() < 2) return;
        gateway::SeenDevice& device = devices.front();
        gateway::SeenClaim& claim = device.claims[1];
        claim.number = 1;
        const auto kind = std::to_integer<Kind>(bytes[0]) % (static_cast<Kind>(kinds().size()) + 1);
        const auto slot = std::to_integer<std::uint32_t>(bytes[1]) % 8;
        if (bytes.size() == 2) {
            claim.items.erase(slot);
            return;
        }
        gateway::SeenItem& item = claim.items[slot];
        item.id = {.slot = slot, .generation = 1};
        item.kind = kind;
        item.params.assign(bytes.begin() + 2, bytes.end());
        if (kind < kinds().size()) item.params.resize(kinds()[kind].size);
        item.version = ++device.scene_version;
    }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    World world;
    world.add_device();
    world.report();
    std::array<Peer, 2> peers;
    gateway::FoxgloveSource source(
        [&world] {
            return gateway::FoxgloveLook{.connected = world.connected,
                                         .epoch = world.epoch,
                                         .name = "default",
                                         .trouble = world.connected ? "" : "no servo",
                                         .devices = world.devices};
        },
        [] { return std::int64_t{0}; });
    std::array<std::unique_ptr<gateway::SocketHandler>, 2> handlers{source.handler(peers[0]),
                                                                    source.handler(peers[1])};
    std::chrono::steady_clock::time_point now{};
    const auto tick = [&] {
        now += std::chrono::milliseconds(16);
        for (auto& handler : handlers)
            if (handler) handler->tick(now);
    };
    tick();
    fuzz::Pieces pieces({data, size});
    int turns = 0;
    for (fuzz::Pieces::Piece piece; turns < 64 && pieces.next(piece); ++turns) {
        const std::size_t which = piece.control & 1;
        Peer& peer = peers[which];
        auto& handler = handlers[which];
        const std::string_view text(reinterpret_cast<const char*>(piece.bytes.data()), piece.bytes.size());
        const std::size_t before = peer.statuses;
        switch (piece.control >> 1 & 7) {
            case 0:
            case 1:
                if (handler) handler->text(text);
                require(peer.statuses <= before + 1, "a text is answered by one status at most");
                break;
            case 2:
                if (handler) handler->binary(piece.bytes);
                require(peer.statuses <= before + 1, "bytes are answered by one status at most");
                break;
            case 3:
                world.put(piece.bytes);
                break;
            case 4:
                world.connected = !world.connected;
                break;
            case 5:
                world.add_device();
                ++world.epoch;
                break;
            case 6:
                peer.is_idle = !peer.is_idle;
                break;
            case 7:
                handler = handler ? nullptr : source.handler(peer);
                break;
        }
        world.report();
        const std::size_t sent = peer.frames;
        tick();
        if (!peer.is_idle) require(peer.frames == sent, "a peer that does not read is sent nothing");
    }
    return 0;
}
