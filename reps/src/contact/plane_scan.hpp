#pragma once
// The only kernel of the contact solver: c_i - n_i . x over all planes; the largest value, or whether any
// exceeds a limit. Every version computes c - ((nx x + ny y) + nz z) in this order without contraction, and a
// maximum has no rounding. So all versions give the same bits.

#include <limits>

#include <knurl/reps/contact_solver.hpp>

#if defined(__x86_64__)
#include <immintrin.h>
#define KNURL_AVX2 __attribute__((target("avx2")))
#endif

namespace knurl {

struct PlaneArrays {
    const double* nx;
    const double* ny;
    const double* nz;
    const double* c;
};

namespace scan {

inline constexpr double nothing = -std::numeric_limits<double>::infinity();
inline constexpr std::uint32_t many = 12;  // with fewer planes, entering the AVX2 code costs more than it
                                           // saves

inline double at(const PlaneArrays& a, std::uint32_t i, double x, double y, double z) noexcept {
    return a.c[i] - ((a.nx[i] * x + a.ny[i] * y) + a.nz[i] * z);
}

#if defined(__x86_64__)
inline __m128d at(const PlaneArrays& a, std::uint32_t i, __m128d x, __m128d y, __m128d z) noexcept {
    const __m128d dot =
        _mm_add_pd(_mm_add_pd(_mm_mul_pd(_mm_loadu_pd(a.nx + i), x), _mm_mul_pd(_mm_loadu_pd(a.ny + i), y)),
                   _mm_mul_pd(_mm_loadu_pd(a.nz + i), z));
    return _mm_sub_pd(_mm_loadu_pd(a.c + i), dot);
}

KNURL_AVX2 inline __m256d at(const PlaneArrays& a, std::uint32_t i, __m256d x, __m256d y,
                             __m256d z) noexcept {
    const __m256d dot = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(_mm256_loadu_pd(a.nx + i), x),
                                                    _mm256_mul_pd(_mm256_loadu_pd(a.ny + i), y)),
                                      _mm256_mul_pd(_mm256_loadu_pd(a.nz + i), z));
    return _mm256_sub_pd(_mm256_loadu_pd(a.c + i), dot);
}
#endif

template <bool Store>
inline double rest(const PlaneArrays& a, std::uint32_t i, std::uint32_t count, const Eigen::Vector3d& x,
                   double worst, double* out) noexcept {
    for (; i < count; ++i) {
        const double v = at(a, i, x.x(), x.y(), x.z());
        if constexpr (Store) out[i] = v;
        worst = v > worst ? v : worst;
    }
    return worst;
}

// Returns the largest value and, with Store, writes each value to `out`.
template <bool Store>
[[gnu::always_inline]] inline double narrow(const PlaneArrays& a, std::uint32_t count,
                                            const Eigen::Vector3d& x, double* out) noexcept {
    double worst = nothing;
    std::uint32_t i = 0;
#if defined(__x86_64__)
    if (count >= 2) {
        const __m128d px = _mm_set1_pd(x.x()), py = _mm_set1_pd(x.y()), pz = _mm_set1_pd(x.z());
        __m128d both = _mm_set1_pd(nothing);
        for (; i + 2 <= count; i += 2) {
            const __m128d v = at(a, i, px, py, pz);
            if constexpr (Store) _mm_storeu_pd(out + i, v);
            both = _mm_max_pd(v, both);
        }
        const double one = _mm_cvtsd_f64(both), other = _mm_cvtsd_f64(_mm_unpackhi_pd(both, both));
        worst = one > other ? one : other;
    }
#endif
    return rest<Store>(a, i, count, x, worst, out);
}

// Is no value above the limit? Cheaper than the search for the largest.
[[gnu::always_inline]] inline bool none_above(const PlaneArrays& a, std::uint32_t count, double x, double y,
                                              double z, double limit) noexcept {
    std::uint32_t i = 0;
    bool above = false;
#if defined(__x86_64__)
    if (count >= 2) {
        const __m128d px = _mm_set1_pd(x), py = _mm_set1_pd(y), pz = _mm_set1_pd(z),
                      bound = _mm_set1_pd(limit);
        __m128d either = _mm_cmpgt_pd(at(a, 0, px, py, pz), bound);
        for (i = 2; i + 2 <= count; i += 2)
            either = _mm_or_pd(either, _mm_cmpgt_pd(at(a, i, px, py, pz), bound));
        above = _mm_movemask_pd(either) != 0;
    }
#endif
    for (; i < count; ++i) above |= at(a, i, x, y, z) > limit;
    return !above;
}
bool none_of_many_above(PlaneArrays a, std::uint32_t count, double x, double y, double z,
                        double limit) noexcept;

}  // namespace scan

/// The first plane whose violation at dx is exactly `violation`, as worst_violation returned it.
std::uint32_t find_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx,
                             double violation) noexcept;

}  // namespace knurl
