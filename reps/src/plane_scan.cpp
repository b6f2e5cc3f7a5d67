// The one kernel of the contact solver: the largest of c_i - n_i . x over all planes. Every version computes
// c - ((nx x + ny y) + nz z) in this order without contraction, and a maximum has no rounding: all give the
// same bits.

#include "plane_scan.hpp"

#include <limits>

#include <knurl/reps/contact_solver.hpp>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace knurl {
namespace {

constexpr double nothing = -std::numeric_limits<double>::infinity();

template <bool Store>
double scan_rest(const PlaneArrays& a, std::uint32_t i, std::uint32_t count, const Eigen::Vector3d& x,
                 double worst, double* out) noexcept {
    for (; i < count; ++i) {
        const double v = a.c[i] - ((a.nx[i] * x.x() + a.ny[i] * x.y()) + a.nz[i] * x.z());
        if constexpr (Store) out[i] = v;
        worst = v > worst ? v : worst;
    }
    return worst;
}

#if defined(__x86_64__)
template <bool Store>
double scan_sse2(const PlaneArrays& a, std::uint32_t count, const Eigen::Vector3d& x, double* out) noexcept {
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
    return scan_rest<Store>(a, i, count, x, one > other ? one : other, out);
}

template <bool Store>
__attribute__((target("avx2"))) double scan_avx2(const PlaneArrays& a, std::uint32_t count,
                                                 const Eigen::Vector3d& x, double* out) noexcept {
    const __m256d px = _mm256_set1_pd(x.x()), py = _mm256_set1_pd(x.y()), pz = _mm256_set1_pd(x.z());
    __m256d worst = _mm256_set1_pd(nothing);
    std::uint32_t i = 0;
    for (; i + 4 <= count; i += 4) {
        const __m256d dot = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(_mm256_loadu_pd(a.nx + i), px),
                                                        _mm256_mul_pd(_mm256_loadu_pd(a.ny + i), py)),
                                          _mm256_mul_pd(_mm256_loadu_pd(a.nz + i), pz));
        const __m256d v = _mm256_sub_pd(_mm256_loadu_pd(a.c + i), dot);
        if constexpr (Store) _mm256_storeu_pd(out + i, v);
        worst = _mm256_max_pd(v, worst);
    }
    const __m128d half = _mm_max_pd(_mm256_castpd256_pd128(worst), _mm256_extractf128_pd(worst, 1));
    const double one = _mm_cvtsd_f64(half), other = _mm_cvtsd_f64(_mm_unpackhi_pd(half, half));
    return scan_rest<Store>(a, i, count, x, one > other ? one : other, out);
}

const bool have_avx2 = __builtin_cpu_supports("avx2") != 0;
constexpr std::uint32_t worth_avx2 = 12;  // below, entering the wide code costs more than it saves
#endif

template <bool Store>
double scan(const PlaneArrays& a, std::uint32_t count, const Eigen::Vector3d& x, double* out) noexcept {
#if defined(__x86_64__)
    if (count >= worth_avx2 && have_avx2) return scan_avx2<Store>(a, count, x, out);
    return scan_sse2<Store>(a, count, x, out);
#else
    return scan_rest<Store>(a, 0, count, x, nothing, out);
#endif
}

}  // namespace

double worst_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx) noexcept {
    return scan<false>({planes.nx, planes.ny, planes.nz, planes.s}, planes.count, dx, nullptr);
}

double shift_to_probe(const double* nx, const double* ny, const double* nz, const double* c,
                      std::uint32_t count, const Eigen::Vector3d& p, double* s) noexcept {
    return scan<true>({nx, ny, nz, c}, count, p, s);
}

std::uint32_t find_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx,
                             double violation) noexcept {
    std::uint32_t i = 0;
    while (i + 1 < planes.count &&
           planes.s[i] - ((planes.nx[i] * dx.x() + planes.ny[i] * dx.y()) + planes.nz[i] * dx.z()) !=
               violation) {
        ++i;
    }
    return i;
}

}  // namespace knurl
