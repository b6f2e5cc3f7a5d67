#pragma once
// Gives the walk the surface of an asset, by the asset's kind.

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>

#include "height_surface.hpp"
#include "mesh_surface.hpp"

namespace knurl::detail {

/// Calls f(surface, origin) with the asset's surface.
template <class Call>
auto on_surface(const Asset& asset, Call&& f) noexcept {
    if (asset.kind == AssetKind::height_field) {
        const HeightData& data = static_cast<const HeightField&>(asset).data();
        return f(HeightSurface(data), to_vec(data.origin));
    }
    const MeshData& data = static_cast<const Mesh&>(asset).data();
    if (data.exact)
        return f(MeshSurface<ExactFace>(data, data.exact_faces.data(), data.exact_faces.size()),
                 to_vec(data.origin));
    return f(MeshSurface<Face>(data, data.faces.data(), data.faces.size()), to_vec(data.origin));
}

}  // namespace knurl::detail
