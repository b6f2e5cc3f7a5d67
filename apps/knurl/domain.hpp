#pragma once
// The servos of a DDS domain, as the registry of this host (knurl-dds) tells them: `knurl ls --domain`, `knurl top --domain`. This
// program is linked with no DDS. It asks a knurl-dds that runs here, or starts one for as long as it takes.

#include <cstdint>
#include <string>
#include <vector>

#include <knurl/json/json.hpp>

namespace knurl::cli {

/// An object for each servo (schemas/domain.schema.json). Throws std::runtime_error.
std::vector<Json> servos_of_domain(std::uint64_t domain);
/// For people.
std::string text_of_domain(std::uint64_t domain, const std::vector<Json>& servos);
/// For programs.
std::string json_of_domain(std::uint64_t domain, const std::vector<Json>& servos, int indent);

}  // namespace knurl::cli
