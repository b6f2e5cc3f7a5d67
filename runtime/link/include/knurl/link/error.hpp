#pragma once

#include <stdexcept>
#include <string>

#include <sys/types.h>

namespace knurl {

/// Everything that can go wrong outside the cycle: one line that says what, where, and what to do.
class Error : public std::runtime_error {
  public:
    enum class Kind {
        no_servo,      // nobody listens under that name
        permission,    // the socket is not ours to open
        incompatible,  // another version or layout
        no_such_device,
        device_held,     // by `holder`
        bad_parameters,  // field, value and range are in the text
        channel_full,    // too many commands at once; nothing was sent
        refused,         // the device's state forbids it, or there is no place now
        disconnected,    // the servo is gone
        after_fork,      // this is the child of a fork: it has no claim
        stale_handle,    // removed, or of another claim
        exhausted,       // this process has no descriptor left, or the socket's path is too long
    };
    Error(Kind what_kind, const std::string& text, pid_t held_by = 0)
        : std::runtime_error(text), kind(what_kind), holder(held_by) {}

    Kind kind;
    pid_t holder;
};

}  // namespace knurl
