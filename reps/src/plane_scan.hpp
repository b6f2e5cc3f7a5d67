#pragma once
// The one kernel of the contact solver: the largest of c_i - n_i . x over all planes. Every version computes
// c - ((nx x + ny y) + nz z) in this order without contraction, and a maximum has no rounding: all give the
// same bits.

#include <limits>

#include <knurl/reps/contact_solver.hpp>

#if defined(__x86_64__)
#include <emmintrin.h>
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
inline constexpr std::uint32_t worth_avx2 = 12;  // below, entering the wide code costs more than it saves

template <bool Store>
double rest(const PlaneArrays& a, std::uint32_t i, std::uint32_t count, const Eigen::Vector3d& x,
            double worst, double* out) noexcept {
    for (; i < count; ++i) {
        const double v = a.c[i] - ((a.nx[i] * x.x() + a.ny[i] * x.y()) + a.nz[i] * x.z());
        if constexpr (Store) out[i] = v;
        worst = v > worst ? v : worst;
    }
    return worst;
}

// As wide as the processor allows (AVX2 is asked for at run time); for many planes.
template <bool Store>
double wide(const PlaneArrays& a, std::uint32_t count, const Eigen::Vector3d& x, double* out) noexcept;

template <bool Store>
double narrow(const PlaneArrays& a, std::uint32_t count, const Eigen::Vector3d& x, double* out) noexcept {
#if defined(__x86_64__)
    if (count < 2) return rest<Store>(a, 0, count, x, nothing, out);
    const __m128d px = _mm_set1_pd(x.x()), py = _mm_set1_pd(x.y()), pz = _mm_set1_pd(x.z());
    __m128d worst = _mm_set1_pd(nothing);
    std::uint32_t i = 0;
    for (; i + 2 <= count; i += 2) {
        const __m128d dot = _mm_add_pd(
            _mm_add_pd(_mm_mul_pd(_mm_loadu_pd(a.nx + i), px), _mm_mul_pd(_mm_loadu_pd(a.ny + i), py)),
            _mm_mul_pd(_mm_loadu_pd(a.nz + i), pz));
        const __m128d v = _mm_sub_pd(_mm_loadu_pd(a.c + i), dot);
        if constexpr (Store) _mm_storeu_pd(out + i, v);
        worst = _mm_max_pd(v, worst);
    }
    const double one = _mm_cvtsd_f64(worst), other = _mm_cvtsd_f64(_mm_unpackhi_pd(worst, worst));
    return rest<Store>(a, i, count, x, one > other ? one : other, out);
#else
    return rest<Store>(a, 0, count, x, nothing, out);
#endif
}

template <bool Store>
double planes(const PlaneArrays& a, std::uint32_t count, const Eigen::Vector3d& x, double* out) noexcept {
    return count < worth_avx2 ? narrow<Store>(a, count, x, out) : wide<Store>(a, count, x, out);
}

}  // namespace scan

/// The first plane whose violation at dx is exactly `violation`, as worst_violation returned it.
std::uint32_t find_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx,
                             double violation) noexcept;

}  // namespace knurl
