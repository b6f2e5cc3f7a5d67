#pragma once
// A servo's state as text.

#include <cstdint>
#include <string>
#include <string_view>

#include <knurl/view/servo_view.hpp>

namespace knurl::view {

std::string_view state_name(DeviceState state);  // "ramp up"
std::string fault_names(std::uint32_t mask);     // "slew, power"; empty: none
DeviceState state_of(const DeviceView& device);  // of its newest report
std::uint32_t faults_of(const DeviceView& device);
double force_of(const DeviceView& device);                   // N, as sent
std::string representations_text(const ClientView& client);  // "3 plane, 1 spring"

}  // namespace knurl::view
