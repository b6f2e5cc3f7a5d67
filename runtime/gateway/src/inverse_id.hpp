#pragma once
// Private to this module.

#include <cstdint>
#include <set>
#include <string>

namespace knurl::gateway {

/// Four hexadecimal digits for a name, the same ones whenever the names before it are the same.
class InverseIds {
  public:
    std::string of(const std::string& name);

  private:
    std::set<std::uint16_t> taken_;
};

}  // namespace knurl::gateway
