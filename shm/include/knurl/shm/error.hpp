#pragma once

#include <stdexcept>
#include <string>

namespace knurl::shm {

/// What the kernel refused: the text says what, why and what to do; `error` is its errno, for who treats one
/// reason unlike another.
class SystemError : public std::runtime_error {
  public:
    SystemError(const std::string& text, int reason) : std::runtime_error(text), error(reason) {}
    int error;
};

}  // namespace knurl::shm
