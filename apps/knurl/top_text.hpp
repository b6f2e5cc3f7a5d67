#pragma once
// What `knurl top` says of one device, for people and for programs.

#include <string>

#include <knurl/json/json.hpp>
#include <knurl/view/rates.hpp>

namespace knurl::cli {

using namespace view;

/// Lines of fields, two spaces or more apart.
std::string text_of(const DeviceRates& rates);
knurl::Json json_of(const DeviceRates& rates);

}  // namespace knurl::cli
