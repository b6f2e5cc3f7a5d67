#include "stated.hpp"

#include <limits>

#include <knurl/reps/scene.hpp>

namespace surface {

void Stated::say(std::int64_t begin, std::int64_t end, std::vector<Piece> pieces) {
    updates_.push_back({begin, end, std::move(pieces)});
}

std::vector<Eigen::Vector3d> Stated::force(const Recording& recording, const knurl::Limits& limits,
                                           const knurl::Asset* asset) const {
    std::vector<Eigen::Vector3d> forces;
    if (updates_.empty()) return forces;
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    knurl::Scene scene({.representations = 8, .probes = 1}, limits);
    scene.set_asset(1, asset);
    std::uint32_t generation = 0;
    std::vector<knurl::RepresentationId> there;
    auto next = updates_.begin();
    for (std::size_t i = 0; i < recording.cycles.size(); ++i) {
        const Update* newest = nullptr;
        while (next != updates_.end() && next->end <= recording.read_ns[i]) newest = &*next++;
        if (newest != nullptr) {
            for (const knurl::RepresentationId id : there) scene.remove(id);
            there.clear();
            ++generation;
            for (const Piece& piece : newest->pieces) {
                there.push_back({.slot = static_cast<std::uint32_t>(there.size()), .generation = generation});
                std::visit([&](const auto& params) { scene.add(there.back(), params); }, piece);
            }
            scene.settle();
        }
        const knurl::Wrench wrench = scene.evaluate({.position = recording.cycles[i].position}, 1e-3);
        const bool open = next != updates_.end() && next->begin <= recording.write_ns[i];
        forces.push_back(open ? Eigen::Vector3d::Constant(unknown) : wrench.force);
    }
    return forces;
}

}  // namespace surface
