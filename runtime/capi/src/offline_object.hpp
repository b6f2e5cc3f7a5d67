#pragma once
// The servo's own cycle in this process, which a handle of knurl_offline.h stands for.

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <knurl_offline.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/servo/offline.hpp>

#include "asset_source.hpp"
#include "handles.hpp"
#include "probe_device.hpp"
#include "shapes.hpp"

namespace knurl::capi {

struct OfflineObject final : Object {
    static constexpr Type its_type = Type::offline;

    OfflineObject(std::string address, const knurl_offline_options& options);
    void begin();  // as opened

    knurl_id add(std::uint32_t kind, std::span<const std::byte> params, const AddOptions& options);
    void set(knurl_id id, std::uint32_t kind, std::span<const std::byte> params);
    void remove(knurl_id id);
    void place_probe(std::uint32_t probe, const ProbePlacement& placement);
    std::uint32_t give(const detail::AssetMemory& source, SentShape& sent);
    void step(const knurl_pose* pose, knurl_cycle& cycle);
    std::optional<knurl_feedback> feedback(knurl_id id);

    std::mutex mutex;

  private:
    struct Slot {
        std::uint32_t generation = 0;
        Kind kind = 0;
        bool present = false;
    };

    Slot& named(knurl_id id);
    void require_room_for(std::size_t cells);
    void require_asset(std::uint32_t kind, std::span<const std::byte> params) const;
    void check_answers();

    const std::string address_;  // empty: a probe that is put somewhere
    const knurl_offline_options options_;
    std::vector<std::unique_ptr<Asset>> assets_;
    std::optional<ProbeDevice> probe_;
    std::unique_ptr<drivers::Device> device_;
    std::unique_ptr<servo::Offline> servo_;
    servo::OfflineClaim* claim_ = nullptr;
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> free_;
    ProbePlacement probe0_;
    std::uint64_t steps_ = 0, answered_ = 0;
    std::size_t cells_ = 0;  // of commands since the last step
    bool changed_ = false;   // parameters, since the last step
};

}  // namespace knurl::capi
