#pragma once
// The messages of knurl.live.v1 from the server to a page, as text: pure functions of what was seen.

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/gateway/live_view.hpp>
#include <knurl/gateway/socket.hpp>
#include <knurl/json/json.hpp>

#include "params_json.hpp"

namespace knurl::gateway {

std::string_view name_of(Role role) noexcept;

/// The tables of all kinds.
Json kinds_json();

/// `can_pull`: by device.
std::string servo_text(const LiveView& view, const std::vector<bool>& can_pull);
std::string frame_text(std::span<const SeenDevice> devices);
/// Message 1: the reports of this tick. Empty: there are none.
std::vector<std::byte> samples_of(std::uint32_t device, const SeenDevice& seen);
/// `recordings`: what is being recorded from here, by device.
std::string status_text(std::span<const SeenDevice> devices,
                        const std::map<std::size_t, std::string>& recordings);
/// What has changed since version `since`; 0: all of it. `mine`: numbers of the claims of the page that is told. Empty:
/// nothing has.
std::string scene_text(std::uint32_t device, const SeenDevice& seen, std::uint64_t since,
                       const std::set<std::uint64_t>& mine);
/// A mesh as `GET /asset` gives it.
std::string mesh_bytes(const SeenAsset& mesh);
/// What is touched; empty: nothing, and nothing was in `before` (which it sets).
std::string felt_text(std::uint32_t device, const SeenDevice& seen, bool& before);

}  // namespace knurl::gateway
