#pragma once

/// @file
/// How people name a servo of this host: every form that a program prints is taken by every option.

#include <string>
#include <vector>

namespace knurl::protocol {

/// A servo of this host.
struct ServoAddress {
    /// Its name: "default".
    std::string name;
    /// Path of its socket.
    std::string socket;
};

/// Reads "default", "knurl:default" or a socket's path. Throws std::runtime_error, one line, for what is none
/// of these.
ServoAddress servo_address(const std::string& said);

/// Names of the servos that listen now, where a client looks for them.
std::vector<std::string> running_servos();

/// What to do where no servo of that name is: names the one that was probably meant, or those that run, or
/// says how to start one. Asks the servos: for a last word, not for a loop.
std::string instead_of_servo(const std::string& name);

/// What to say behind "servo ... has no device 'wanted'; ": the one that was probably meant, or those that it
/// has.
std::string instead_of_device(const std::string& wanted, const std::vector<std::string>& names);

}  // namespace knurl::protocol
