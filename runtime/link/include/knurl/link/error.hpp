#pragma once

#include <stdexcept>
#include <string>

#include <sys/types.h>

namespace knurl {

/// Everything that can go wrong outside the cycle: one line that says what, where, and what to do.
class Error : public std::runtime_error {
  public:
    /// What went wrong, for programs.
    enum class Kind {
        /// Nobody listens under that name.
        no_servo,
        /// This user may not open the socket; on another host: the key is wrong.
        permission,
        /// The servo is of another version or layout.
        incompatible,
        /// The servo has no such device.
        no_such_device,
        /// Another process holds the device: `holder`.
        device_held,
        /// Parameters are out of range; field, value and range are in the text.
        bad_parameters,
        /// Too many commands at once; nothing was sent.
        channel_full,
        /// The device's state forbids it, or there is no place now.
        refused,
        /// The servo is gone.
        disconnected,
        /// This is the child of a fork: it has no claim.
        after_fork,
        /// The handle's representation was removed, or is of another claim.
        stale_handle,
        /// This process has no descriptor left, or the socket's path is too long.
        exhausted,
    };
    /// `text`: the one line.
    Error(Kind what_kind, const std::string& text, pid_t held_by = 0)
        : std::runtime_error(text), kind(what_kind), holder(held_by) {}

    /// What went wrong.
    Kind kind;
    /// Of device_held: the process that holds the device; else 0.
    pid_t holder;
};

}  // namespace knurl
