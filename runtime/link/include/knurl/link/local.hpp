#pragma once

/// @file
/// The two channels through shared memory: the handshake over the servo's Unix socket, then rings.

#include <knurl/link/transport.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::detail {

/// One attempt: throws Error::no_servo if nobody listens (yet), Error::permission, Error::incompatible.
std::unique_ptr<Link> connect_local(const std::string& servo, const std::string& client_name,
                                    std::chrono::milliseconds answer_time);

/// The channels in a claim's segment; the servo's side of the same memory is the counterpart.
std::unique_ptr<ClaimChannel> local_channel(std::shared_ptr<shm::Segment> claim,
                                            const protocol::ClaimCapacity& capacity);

/// What a claim's assets go through: who knows the claim's key may give it some.
std::shared_ptr<AssetDoor> local_assets(const std::string& servo, const std::string& client_name,
                                        std::uint32_t device, std::uint64_t key,
                                        std::chrono::milliseconds answer_time);

/// Reports in a device's segment, waited for by the flag in the claim's.
std::shared_ptr<ReportSource> local_reports(std::shared_ptr<const shm::Segment> device,
                                            std::shared_ptr<shm::Segment> claim,
                                            const protocol::ClaimCapacity& capacity, shm::UniqueFd wake_fd);

}  // namespace knurl::detail
