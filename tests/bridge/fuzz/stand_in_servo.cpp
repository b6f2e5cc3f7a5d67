// For targets without a servo.

#include <cstdlib>

#include <knurl/link/local.hpp>

std::unique_ptr<knurl::detail::Link> knurl::detail::connect_local(const std::string&, const std::string&,
                                                                  std::chrono::milliseconds) {
    std::abort();
}
