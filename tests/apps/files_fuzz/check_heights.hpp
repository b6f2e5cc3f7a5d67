#pragma once
// The property of any bytes as an elevation model.

#include <cmath>
#include <stdexcept>
#include <string_view>

#include "../../fuzz/refusal.hpp"
#include "elevation.hpp"

namespace knurl::fuzz {

/// They are refused in one line, or become finite heights.
inline void check_heights(std::string_view bytes) {
    try {
        const surface::ElevationModel model = surface::read_elevation(bytes, "file");
        require(model.rows >= surface::smallest_side && model.columns >= surface::smallest_side &&
                    model.counts.size() ==
                        static_cast<std::size_t>(model.rows) * static_cast<std::size_t>(model.columns),
                "each cell has a height");
        for (const double count : model.counts) require(std::isfinite(count), "a height is a number");
        for (const auto& scale : {model.metres_per_cell, model.metres_per_count})
            require(!scale || (std::isfinite(*scale) && *scale > 0), "a scale is a number above 0");
        for (const std::string& note : model.notes) check_refusal(note, "");
    } catch (const std::runtime_error& error) {
        check_refusal(error.what(), "file");
    }
}

}  // namespace knurl::fuzz
