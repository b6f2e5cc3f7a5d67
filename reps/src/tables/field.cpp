#include "tables/field_check.hpp"

namespace knurl {

Verdict validate_fields(std::span<const Field> fields, const void* params) noexcept {
    for (std::uint32_t index = 0; index < fields.size(); ++index) {
        const Verdict verdict = check_field(fields[index], index, static_cast<const unsigned char*>(params));
        if (!verdict) return verdict;
    }
    return {};
}

}  // namespace knurl
