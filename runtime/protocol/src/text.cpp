#include <knurl/protocol/text.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::protocol {

std::string printable(const std::string& name) {
    return name.empty() ? "unnamed" : words::printable(name);
}

}  // namespace knurl::protocol
