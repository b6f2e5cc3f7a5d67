#pragma once

#include <knurl/shm/fd.hpp>

namespace knurl::bridge {

/// A non-blocking UDP socket whose datagrams no router cuts in pieces. Empty: errno says why not.
shm::UniqueFd make_datagram_socket(int family);

}  // namespace knurl::bridge
