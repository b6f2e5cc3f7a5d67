#include "validate.hpp"

#include <string_view>

#include <knurl/client/error.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/reps/check.hpp>
#include <knurl/reps/describe.hpp>

namespace knurl::detail {

namespace {

void require(const Verdict& verdict, Kind kind, std::string_view where) {
    if (!verdict) throw Error(Error::Kind::bad_parameters, describe(verdict, kind, where));
}

}  // namespace

void validate(Kind kind, const void* params, std::size_t bytes) {
    require(check_parameters(kind, params, bytes), kind, "");
}

void validate(Kind kind, const void* params, std::size_t bytes, const AddOptions& options) {
    require(check_added(kind, params, bytes, options), kind, "");
}

void validate(std::uint32_t probe, const ProbePlacement& placement) {
    require(check_placement(probe, placement), Representations::size, "place_probe");
}

}  // namespace knurl::detail
