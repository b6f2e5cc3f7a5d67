#include "relief.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace surface {

Relief make_relief(const ElevationModel& model, const ReliefOptions& options) {
    const auto per_count = options.metres_per_count ? options.metres_per_count : model.metres_per_count;
    const auto per_cell = options.metres_per_cell ? options.metres_per_cell : model.metres_per_cell;
    const auto [low, high] = std::minmax_element(model.counts.begin(), model.counts.end());
    const double range = *high - *low;
    if (!(range > 0))
        throw std::runtime_error(model.name +
                                 ": all heights are the same, there is nothing to feel; give another model");

    double scale;  // m in the hand's world per count
    std::string statement;
    if (per_count && per_cell) {
        if (!(*per_count > 0) || !(*per_cell > 0))
            throw std::runtime_error(model.name +
                                     ": metres per count and per cell must be above 0; give "
                                     "--metres-per-count and --metres-per-cell");
        scale = *per_count * (options.cell / *per_cell) * options.exaggeration;
        statement =
            fmt::format("{:g} mm per cell of {:.4g} m (1 : {:.0f}), heights \u00d7 {:g}", options.cell * 1e3,
                        *per_cell, *per_cell / options.cell, options.exaggeration);
    } else {
        scale = options.default_range / range;
        statement =
            fmt::format("{:g} mm per cell; the file states no scale, its heights are stretched to {:g} mm",
                        options.cell * 1e3, options.default_range * 1e3);
    }
    if (range * scale > greatest_range)
        throw std::runtime_error(
            fmt::format("{}: the relief would be {:.0f} mm high, at most {:.0f} mm fit under a hand; "
                        "lower --exaggeration or --cell",
                        model.name, range * scale * 1e3, greatest_range * 1e3));

    Relief relief;
    relief.grid = {
        .rows = model.rows, .columns = model.columns, .cell = options.cell, .heights = model.counts};
    relief.grid = smoothed(std::move(relief.grid), options.smoothing / options.cell);
    const auto [bottom, top] = std::minmax_element(relief.grid.heights.begin(), relief.grid.heights.end());
    const double middle = 0.5 * (*bottom + *top);
    const double felt = (*top - *bottom) * scale;
    for (double& h : relief.grid.heights) h = (h - middle) * scale;
    if (options.smoothing > 0)
        statement += fmt::format(", smoothed over {:g} mm (1 \u03c3)", options.smoothing * 1e3);
    statement +=
        fmt::format("; {:.0f} \u00d7 {:.0f} mm, {:.1f} mm high", (model.columns - 1) * options.cell * 1e3,
                    (model.rows - 1) * options.cell * 1e3, felt * 1e3);
    relief.statement = statement;
    return relief;
}

}  // namespace surface
