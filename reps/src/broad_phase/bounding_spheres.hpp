#pragma once
// Bounding spheres as structure of arrays. Tests which of them contain a point, two at a time, without a
// branch.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

namespace knurl::detail {

struct BoundingSpheres {
    std::vector<double> x, y, z;  // m
    std::vector<double> radius;   // m

    void resize(std::size_t size) {
        for (std::vector<double>* array : {&x, &y, &z, &radius}) array->resize(size);
    }
    void put(std::size_t i, const Eigen::Vector3d& center, double farthest) noexcept {
        x[i] = center.x(), y[i] = center.y(), z[i] = center.z(), radius[i] = farthest;
    }
    void copy(std::size_t from, std::size_t to) noexcept {
        x[to] = x[from], y[to] = y[from], z[to] = z[from], radius[to] = radius[from];
    }
    /// Is p within sphere i, grown by `more` (m)?
    bool within(std::size_t i, const Eigen::Vector3d& p, double more) const noexcept {
        const double dx = x[i] - p.x(), dy = y[i] - p.y(), dz = z[i] - p.z(), far = radius[i] + more;
        return (dx * dx + dy * dy) + dz * dz < far * far;
    }

    /// Calls take(i) for each sphere in begin ... begin + count that contains p.
    template <class Take>
    void for_each_within(std::uint32_t begin, std::uint32_t count, const Eigen::Vector3d& p, double more,
                         Take take) const noexcept {
        for (const std::uint32_t end = begin + count; begin < end; begin += 64) {
            std::uint64_t bits = within_of_64(begin, std::min(end - begin, 64u), p, more);
            for (; bits != 0; bits &= bits - 1)
                take(begin + static_cast<std::uint32_t>(std::countr_zero(bits)));
        }
    }

  private:
    std::uint64_t within_of_64(std::uint32_t begin, std::uint32_t count, const Eigen::Vector3d& p,
                               double more) const noexcept {
        std::uint64_t bits = 0;
        std::uint32_t i = 0;
#if defined(__x86_64__)
        const __m128d px = _mm_set1_pd(p.x()), py = _mm_set1_pd(p.y()), pz = _mm_set1_pd(p.z()),
                      add = _mm_set1_pd(more);
        for (; i + 2 <= count; i += 2) {
            const std::uint32_t at = begin + i;
            const __m128d dx = _mm_sub_pd(_mm_loadu_pd(&x[at]), px),
                          dy = _mm_sub_pd(_mm_loadu_pd(&y[at]), py),
                          dz = _mm_sub_pd(_mm_loadu_pd(&z[at]), pz),
                          far = _mm_add_pd(_mm_loadu_pd(&radius[at]), add);
            const __m128d square =
                _mm_add_pd(_mm_add_pd(_mm_mul_pd(dx, dx), _mm_mul_pd(dy, dy)), _mm_mul_pd(dz, dz));
            const int both = _mm_movemask_pd(_mm_cmplt_pd(square, _mm_mul_pd(far, far)));
            bits |= static_cast<std::uint64_t>(both) << i;
        }
#endif
        for (; i < count; ++i) bits |= std::uint64_t{within(begin + i, p, more)} << i;
        return bits;
    }
};

}  // namespace knurl::detail
