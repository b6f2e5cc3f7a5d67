#pragma once
// Which devices the program shall find: what `knurl as` writes into the environment.

#include <string>
#include <vector>

namespace knurl::lookalike {

/// Where a device is: a servo, as Client::connect takes it, and a name there.
struct Place {
    std::string servo;
    std::string device;
    std::string alias{};  // what the program calls it, beside its own name
};

/// The devices that KNURL_AS_DEVICES names ("[NAME=][SERVO/]DEVICE", with commas between), in that order. Names it none: all
/// devices of the servo KNURL_AS_SERVO ("knurl:default"). Throws Error.
std::vector<Place> places();

/// Reads what KNURL_AS_DEVICES may hold; `servo` is that of names without one.
std::vector<Place> places_said(const std::string& devices, const std::string& servo);

}  // namespace knurl::lookalike
