#pragma once
// The mesh as the eye would see it, the hand's path, the proxy's, and the force over time, as a PNG.

#include <string>
#include <vector>

#include <knurl/meshfile/mesh_file.hpp>

#include "record.hpp"

namespace feel {

/// `metres` of a unit of the file. `title`: one line above, `machine`: one below. Throws std::runtime_error.
void draw(const std::string& path, const knurl::meshfile::MeshFile& file, double metres,
          const std::vector<Cycle>& cycles, const std::string& title, const std::string& machine);

}  // namespace feel
