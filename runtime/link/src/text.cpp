#include <fmt/format.h>

#include <knurl/link/text.hpp>

namespace knurl::detail {

std::string format_text(fmt::string_view pattern, fmt::format_args arguments) {
    return fmt::vformat(pattern, arguments);
}

}  // namespace knurl::detail
