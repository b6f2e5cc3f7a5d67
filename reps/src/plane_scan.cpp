#include "plane_scan.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace knurl {
namespace scan {
namespace {

#if defined(__x86_64__)
template <bool Store>
__attribute__((target("avx2"))) double avx2(const PlaneArrays& a, std::uint32_t count,
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
    return rest<Store>(a, i, count, x, one > other ? one : other, out);
}

const bool have_avx2 = __builtin_cpu_supports("avx2") != 0;
#endif

}  // namespace

template <bool Store>
double wide(const PlaneArrays& a, std::uint32_t count, const Eigen::Vector3d& x, double* out) noexcept {
#if defined(__x86_64__)
    if (have_avx2) return avx2<Store>(a, count, x, out);
#endif
    return narrow<Store>(a, count, x, out);
}
template double wide<true>(const PlaneArrays&, std::uint32_t, const Eigen::Vector3d&, double*) noexcept;
template double wide<false>(const PlaneArrays&, std::uint32_t, const Eigen::Vector3d&, double*) noexcept;

}  // namespace scan

double worst_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx) noexcept {
    return scan::planes<false>({planes.nx, planes.ny, planes.nz, planes.s}, planes.count, dx, nullptr);
}

double shift_to_probe(const double* nx, const double* ny, const double* nz, const double* c,
                      std::uint32_t count, const Eigen::Vector3d& p, double* s) noexcept {
    return scan::planes<true>({nx, ny, nz, c}, count, p, s);
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
