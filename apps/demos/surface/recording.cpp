#include "recording.hpp"

#include <stdexcept>

#include <fmt/format.h>

namespace surface {

std::string key_of(Way way) {
    switch (way) {
        case Way::force:
            return "force";
        case Way::planes:
            return "planes";
        case Way::paper:
            return "paper";
        case Way::knurl:
            return "knurl";
        case Way::caps:
            return "caps";
        case Way::mesh:
            return "mesh";
        case Way::field:
            return "field";
    }
    return {};
}

std::string title_of(Way way, double rate) {
    switch (way) {
        case Way::force:
            return fmt::format("force computed in the application, {:g} Hz", rate);
        case Way::planes:
            return fmt::format("planes at {:g} Hz, as they come", rate);
        case Way::paper:
            return fmt::format("planes at {:g} Hz, recovery of the 1996 paper (50 ms)", rate);
        case Way::knurl:
            return fmt::format("planes at {:g} Hz, predicted and cross-faded (Knurl)", rate);
        case Way::caps:
            return fmt::format("caps at {:g} Hz, predicted and cross-faded (Knurl)", rate);
        case Way::mesh:
            return "the relief as a mesh, sent once (Knurl)";
        case Way::field:
            return "the relief as a height field, sent once (Knurl)";
    }
    return {};
}

Way way_of(const std::string& key) {
    for (const Way way : all_ways)
        if (key_of(way) == key) return way;
    throw std::runtime_error("--ways: \"" + key +
                             "\" is none of force, planes, paper, knurl, caps, mesh, "
                             "field");
}

std::vector<double> ages_at_use(const Recording& recording) {
    std::vector<double> ages;
    std::size_t cycle = 0;
    for (std::size_t i = 0; i < recording.updates.size(); ++i) {
        const Update& update = recording.updates[i];
        while (cycle < recording.read_ns.size() && recording.read_ns[cycle] < update.commit_ns) ++cycle;
        if (cycle == recording.read_ns.size()) break;
        const bool overtaken = i + 1 < recording.updates.size() &&
                               recording.updates[i + 1].commit_ns <= recording.read_ns[cycle];
        if (!overtaken)
            ages.push_back(static_cast<double>(recording.write_ns[cycle] - update.report_read_ns) * 1e-9);
    }
    return ages;
}

}  // namespace surface
