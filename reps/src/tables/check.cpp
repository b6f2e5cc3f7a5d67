#include <iterator>

#include <knurl/reps/check.hpp>

namespace knurl {

using Code = Verdict::Code;

namespace {

/// Rows count from `first`.
template <class T>
Verdict check_table(const T& value, std::uint32_t first) noexcept {
    Verdict verdict = validate_fields(Describe<T>::fields, &value);
    if (!verdict) verdict.field += first;
    return verdict;
}

Verdict no_such_probe(std::uint32_t field, std::uint32_t probe, std::uint32_t probes) noexcept {
    return {.code = Code::no_such_probe,
            .field = field,
            .value = static_cast<double>(probe),
            .against = static_cast<double>(probes - 1)};
}

}  // namespace

Verdict check_parameters(Kind kind, const void* params, std::size_t bytes) noexcept {
    if (kind >= kinds().size()) return {Code::unknown_kind, Verdict::no_field, static_cast<double>(kind)};
    if (bytes != kinds()[kind].size) return {Code::wrong_size, Verdict::no_field, static_cast<double>(bytes)};
    return kinds()[kind].validate(params);
}

Verdict check_options(const AddOptions& options, std::uint32_t probes) noexcept {
    if (options.probe >= probes) return no_such_probe(Verdict::of_options, options.probe, probes);
    return check_table(options, Verdict::of_options);
}

Verdict check_placement(std::uint32_t probe, const ProbePlacement& placement, std::uint32_t probes) noexcept {
    // The table has no row for `probe`: the probe is not part of its own placement.
    constexpr auto rows = static_cast<std::uint32_t>(std::size(Describe<ProbePlacement>::fields));
    if (probe >= probes) return no_such_probe(Verdict::of_placement + rows, probe, probes);
    return check_table(placement, Verdict::of_placement);
}

Verdict check_added(Kind kind, const void* params, std::size_t bytes, const AddOptions& options,
                    std::uint32_t probes) noexcept {
    const Verdict verdict = check_options(options, probes);
    return verdict ? check_parameters(kind, params, bytes) : verdict;
}

}  // namespace knurl
