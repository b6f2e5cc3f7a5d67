#include "validate.hpp"

#include <cmath>

#include <knurl/client/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/bounds.hpp>
#include <knurl/reps/describe.hpp>

namespace knurl::detail {

namespace {

void require(const Verdict& verdict, Kind kind) {
    if (!verdict) throw Error(Error::Kind::bad_parameters, describe(verdict, kind, ""));
}

Verdict refuse(Verdict::Code code, double value) {
    return {.code = code, .field = Verdict::no_field, .value = value};
}

}  // namespace

void validate(Kind kind, const void* params, std::size_t bytes) {
    if (kind >= kinds().size()) require(refuse(Verdict::Code::unknown_kind, kind), kind);
    if (bytes != kinds()[kind].size)
        require(refuse(Verdict::Code::wrong_size, static_cast<double>(bytes)), kind);
    require(kinds()[kind].validate(params), kind);
}

void validate(Kind kind, const Use& use) {
    const auto on_silence = static_cast<std::uint32_t>(use.on_silence);
    if (use.probe >= protocol::max_probes) require(refuse(Verdict::Code::no_such_probe, use.probe), kind);
    if (on_silence > static_cast<std::uint32_t>(OnSilence::move))
        require(refuse(Verdict::Code::no_such_choice, on_silence), kind);
    if (!std::isfinite(use.silence_time) || use.silence_time < 0)
        require(refuse(Verdict::Code::out_of_range, use.silence_time), kind);
}

void validate(std::uint32_t probe, const ProbePlacement& placement) {
    const auto bad = [](const std::string& text) { throw Error(Error::Kind::bad_parameters, text); };
    if (probe >= protocol::max_probes)
        bad(detail::format("place_probe: probe {}; give 0 to {}", probe, protocol::max_probes - 1));
    constexpr double farthest = 1e9;  // m, as the scene has it
    if (!(to_eigen(placement.offset).cwiseAbs().maxCoeff() <= farthest) ||
        !to_eigen(placement.offset).allFinite())
        bad(detail::format("place_probe: offset ({}, {}, {}) m; give finite numbers, at most 1e9 m",
                           placement.offset.x, placement.offset.y, placement.offset.z));
    if (!(placement.radius >= 0 && placement.radius <= farthest))
        bad(detail::format("place_probe: radius {} m; give 0 to 1e9 m", placement.radius));
}

}  // namespace knurl::detail
