// Any bytes as PNG, PGM or ESRI ASCII grid. They are refused in one line, or become finite heights.

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "elevation.hpp"
#include "refusal.hpp"

using knurl::fuzz::check_refusal;
using knurl::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const surface::ElevationModel model =
            surface::read_elevation({reinterpret_cast<const char*>(data), size}, "file");
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
    return 0;
}
