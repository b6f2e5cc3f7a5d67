#pragma once

#include <knurl/shm/fd.hpp>

namespace knurl::bridge {

/// A non-blocking UDP socket whose datagrams routers do not fragment. Empty: see errno.
shm::UniqueFd make_datagram_socket(int family);

}  // namespace knurl::bridge
