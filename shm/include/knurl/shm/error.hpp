#pragma once

#include <stdexcept>
#include <string>

namespace knurl::shm {

/// A system call failed: the text says what, why and what to do.
class SystemError : public std::runtime_error {
  public:
    /// `reason`: an errno.
    SystemError(const std::string& text, int reason) : std::runtime_error(text), error(reason) {}
    /// The errno, for a caller that treats one reason unlike another.
    int error;
};

}  // namespace knurl::shm
