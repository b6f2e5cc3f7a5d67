#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace knurl::detail {

/// The median of the last seven values: one late wake-up says nothing about the usual lateness.
class Recent {
  public:
    void add(double value) noexcept { values_[count_++ % values_.size()] = value; }
    bool empty() const noexcept { return count_ == 0; }
    double median() const noexcept {
        const std::size_t known = std::min(count_, values_.size());
        for (std::size_t i = 0; i < known; ++i) {
            std::size_t before = 0;  // number of values before it in order; of equal values the earlier comes
                                     // first
            for (std::size_t j = 0; j < known; ++j)
                before += values_[j] < values_[i] || (values_[j] == values_[i] && j < i) ? 1 : 0;
            if (before == known / 2) return values_[i];
        }
        return 0;
    }

  private:
    std::array<double, 7> values_{};
    std::size_t count_ = 0;
};

}  // namespace knurl::detail
