#pragma once
// Every queue, count and drain of the two channels has a bound, and here is its name.

#include <cstddef>
#include <cstdint>

#include <knurl/reps/bounds.hpp>

namespace knurl::protocol {

inline constexpr std::uint32_t max_clients = 128;              // claims and observers of one device together
inline constexpr std::uint32_t max_claims_of_connection = 16;  // and observers
inline constexpr std::uint32_t max_devices = 8;                // of one servo process
inline constexpr std::uint32_t max_joints = 8;
using knurl::max_parameter_bytes;
using knurl::max_probes;
using knurl::max_representations;
/// Of a batch that has room for each of so many representations, of any kind: its EntryHeader and parameters.
constexpr std::uint32_t batch_bytes_for(std::uint32_t representations) {
    return representations * 512;
}
inline constexpr std::uint32_t max_batch_bytes = batch_bytes_for(max_representations);
inline constexpr std::uint32_t report_slots = 4096;       // about 4 s at 1 kHz: also the flight recorder
inline constexpr std::uint32_t max_command_cells = 8192;  // 64 B each, of one claim's command ring
inline constexpr std::uint32_t reply_cells = 2048;  // one for each of those, and for what comes with them
// of one claim in one cycle; a group that has begun is finished, and the rest waits for the next
inline constexpr std::uint32_t command_cells_per_cycle = 512;
inline constexpr double max_delay_allowance = 1.0;  // s, by which commits may come late on their way
inline constexpr std::size_t name_bytes = 64;       // names of servos, devices, clients, with the zero

inline constexpr std::uint32_t default_representations = 128;  // a claim that states nothing
inline constexpr std::uint32_t default_batch_bytes = batch_bytes_for(default_representations);

}  // namespace knurl::protocol
