#pragma once

/// @file
/// Every queue, count and drain of the two channels has a bound, and here is its name.

#include <cstddef>
#include <cstdint>

#include <knurl/reps/bounds.hpp>

namespace knurl::protocol {

/// Most claims and observers of one device together.
inline constexpr std::uint32_t max_clients = 128;
/// Of these, those that observers leave free: whoever claims the device finds one.
inline constexpr std::uint32_t rows_for_claims = 16;
/// Most observers of one device by one process: nobody holds more than it leaves free.
inline constexpr std::uint32_t max_observers_of_process = (max_clients - rows_for_claims) / 2;
/// Most claims and observers of one connection.
inline constexpr std::uint32_t max_claims_of_connection = 16;
/// Most devices of one servo process.
inline constexpr std::uint32_t max_devices = 8;
/// Most joints of a device.
inline constexpr std::uint32_t max_joints = 8;
using knurl::max_parameter_bytes;
using knurl::max_probes;
using knurl::max_representations;
/// Bytes of a batch that has room for so many representations of any kind: EntryHeader and parameters of
/// each.
constexpr std::uint32_t batch_bytes_for(std::uint32_t representations) {
    return representations * 512;
}
/// Most bytes of a batch.
inline constexpr std::uint32_t max_batch_bytes = batch_bytes_for(max_representations);
/// Slots of the report ring: about 4 s at 1 kHz. It is the flight recorder, too.
inline constexpr std::uint32_t report_slots = 4096;
/// Most cells (64 B) of one claim's command ring.
inline constexpr std::uint32_t max_command_cells = 8192;
/// Cells of a claim's reply ring: one for each command, and for what comes with them.
inline constexpr std::uint32_t reply_cells = 2048;
/// Most cells of one claim that a cycle takes. A group that has begun is finished, and the rest waits for the
/// next cycle.
inline constexpr std::uint32_t command_cells_per_cycle = 512;
/// Cells of all claims together that a cycle takes, batches included (64 B of a batch are one). The claim that
/// reaches it is finished; the next ones have the first turn in the next cycle.
inline constexpr std::uint32_t intake_cells_per_cycle = 1024;
/// Least share of that of one claim, whatever the number of claims.
inline constexpr std::uint32_t least_command_cells = 32;
/// Most time by which commits may come late on their way (s).
inline constexpr double max_delay_allowance = 1.0;
/// Bytes of the names of servos, devices and clients, with the zero.
inline constexpr std::size_t name_bytes = 64;

/// Representations of a claim that states no number.
inline constexpr std::uint32_t default_representations = 128;
/// Bytes of a batch of such a claim.
inline constexpr std::uint32_t default_batch_bytes = batch_bytes_for(default_representations);

}  // namespace knurl::protocol
