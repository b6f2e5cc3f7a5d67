#pragma once

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace knurl::shm {

/// "what: why (errno's text); what to do"
[[noreturn]] inline void throw_errno(const std::string& what, const std::string& remedy, int error = errno) {
    throw std::runtime_error(what + ": " + std::strerror(error) + "; " + remedy);
}

}  // namespace knurl::shm
