#pragma once
// Meshes and height fields of the caller, and what was made of them.

#include <vector>

#include <knurl/client/asset.hpp>

#include "call.hpp"

namespace knurl::capi {

/// A mesh of the caller as the client takes it. Valid while the caller's memory is.
class GivenMesh {
  public:
    /// Throws Failed.
    explicit GivenMesh(const knurl_mesh* given);
    GivenMesh(const GivenMesh&) = delete;
    GivenMesh& operator=(const GivenMesh&) = delete;

    const Triangles& triangles() const { return triangles_; }
    const SendOptions& options() const { return options_; }

  private:
    std::vector<Point3> converted_;  // of vertices in single precision
    Triangles triangles_;
    SendOptions options_;
};

/// Throws Failed. Valid while the caller's memory is.
Heights given_heights(const knurl_heights* given);

knurl_sent sent_to_c(const SentShape& sent);

}  // namespace knurl::capi
