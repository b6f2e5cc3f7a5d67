#include "contact/plane_scan.hpp"

namespace knurl {
namespace scan {

namespace {

#if defined(__x86_64__)
const bool have_avx2 = __builtin_cpu_supports("avx2") != 0;

template <bool Store>
KNURL_AVX2 double largest_avx2(const PlaneArrays& a, std::uint32_t count, const Eigen::Vector3d& x,
                               double* out) noexcept {
    const __m256d px = _mm256_set1_pd(x.x()), py = _mm256_set1_pd(x.y()), pz = _mm256_set1_pd(x.z());
    __m256d worst = _mm256_set1_pd(nothing), other = worst;
    std::uint32_t i = 0;
    for (; i + 8 <= count; i += 8) {  // two independent chains, since each maximum depends on the one before
        const __m256d v = at(a, i, px, py, pz), w = at(a, i + 4, px, py, pz);
        if constexpr (Store) _mm256_storeu_pd(out + i, v), _mm256_storeu_pd(out + i + 4, w);
        worst = _mm256_max_pd(v, worst);
        other = _mm256_max_pd(w, other);
    }
    worst = _mm256_max_pd(worst, other);
    const __m128d half = _mm_max_pd(_mm256_castpd256_pd128(worst), _mm256_extractf128_pd(worst, 1));
    const double first = _mm_cvtsd_f64(half), second = _mm_cvtsd_f64(_mm_unpackhi_pd(half, half));
    return rest<Store>(a, i, count, x, first > second ? first : second, out);
}

KNURL_AVX2 bool none_above_avx2(const PlaneArrays& a, std::uint32_t count, double x, double y, double z,
                                double limit) noexcept {
    const __m256d px = _mm256_set1_pd(x), py = _mm256_set1_pd(y), pz = _mm256_set1_pd(z),
                  bound = _mm256_set1_pd(limit);
    __m256d any = _mm256_setzero_pd();
    std::uint32_t i = 0;
    for (; i + 4 <= count; i += 4)
        any = _mm256_or_pd(any, _mm256_cmp_pd(at(a, i, px, py, pz), bound, _CMP_GT_OQ));
    bool above = _mm256_movemask_pd(any) != 0;
    for (; i < count; ++i) above |= at(a, i, x, y, z) > limit;
    return !above;
}
#endif

template <bool Store>
[[gnu::noinline]] double largest_of_many(PlaneArrays a, std::uint32_t count, const Eigen::Vector3d& x,
                                         double* out) noexcept {
#if defined(__x86_64__)
    if (have_avx2) return largest_avx2<Store>(a, count, x, out);
#endif
    return narrow<Store>(a, count, x, out);
}

// Two copies of the narrow code: the compiler unrolls the one in which it knows that there are few planes.
template <bool Store>
[[gnu::always_inline]] inline double largest(const PlaneArrays& a, std::uint32_t count,
                                             const Eigen::Vector3d& x, double* out) noexcept {
    return count < many ? narrow<Store>(a, count, x, out) : largest_of_many<Store>(a, count, x, out);
}

}  // namespace

bool none_of_many_above(PlaneArrays a, std::uint32_t count, double x, double y, double z,
                        double limit) noexcept {
#if defined(__x86_64__)
    if (have_avx2) return none_above_avx2(a, count, x, y, z, limit);
#endif
    return none_above(a, count, x, y, z, limit);
}

}  // namespace scan

double worst_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx) noexcept {
    return scan::largest<false>({planes.nx, planes.ny, planes.nz, planes.s}, planes.count, dx, nullptr);
}

double shift_to_probe(const double* nx, const double* ny, const double* nz, const double* c,
                      std::uint32_t count, const Eigen::Vector3d& p, double* s) noexcept {
    return scan::largest<true>({nx, ny, nz, c}, count, p, s);
}

std::uint32_t find_violation(const ContactPlanes& planes, const Eigen::Vector3d& dx,
                             double violation) noexcept {
    const PlaneArrays a{planes.nx, planes.ny, planes.nz, planes.s};
    std::uint32_t i = 0;
    while (i + 1 < planes.count && scan::at(a, i, dx.x(), dx.y(), dx.z()) != violation) ++i;
    return i;
}

}  // namespace knurl
