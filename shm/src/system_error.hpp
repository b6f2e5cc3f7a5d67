#pragma once

#include <cerrno>
#include <cstring>
#include <string>

#include <knurl/shm/error.hpp>

namespace knurl::shm {

/// The remedy for an error with one cause, whoever meets it; for other errors `otherwise`.
inline std::string remedy_for(int error, const std::string& otherwise) {
    switch (error) {
        case EMFILE:
            return "this process has no descriptor left: raise its limit (ulimit -n; of a service: "
                   "LimitNOFILE=)";
        case ENFILE:
            return "the machine has no descriptor left: sudo sysctl fs.file-max=1000000";
        case ENOSPC:
        case EDQUOT:
            return "make room on that disk";
        case EROFS:
            return "choose a folder that can be written to";
        case ENOMEM:
            return "end other programs, or raise the limit of memory";
        default:
            return otherwise;
    }
}

/// "what: why (errno's text); what to do"
[[noreturn]] inline void throw_errno(const std::string& what, const std::string& remedy, int error = errno) {
    throw SystemError(what + ": " + std::strerror(error) + "; " + remedy_for(error, remedy), error);
}

}  // namespace knurl::shm
