#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace knurl::detail {

/// The median of the last seven: one late wake-up says nothing about how late an application is.
class Recent {
  public:
    void add(double value) noexcept { values_[count_++ % values_.size()] = value; }
    bool empty() const noexcept { return count_ == 0; }
    double median() const noexcept {
        auto sorted = values_;
        const std::size_t n = std::min(count_, sorted.size());
        std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n));
        return n == 0 ? 0 : sorted[n / 2];
    }

  private:
    std::array<double, 7> values_{};
    std::size_t count_ = 0;
};

}  // namespace knurl::detail
