#pragma once
// What one page adds to a device: a claim of its own, which ends with it.

#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <knurl/client/client.hpp>
#include <knurl/gateway/live_page.hpp>
#include <knurl/json/json.hpp>
#include <knurl/meshfile/mesh_file.hpp>

namespace knurl::gateway {

class Playground {
  public:
    /// `name`: what `knurl ls` shows of it. Claims the device. Throws std::runtime_error.
    Playground(const std::string& servo, const std::string& device, const std::string& name);

    /// All throw std::runtime_error, one line.
    RepresentationId add(const Json& request);
    void set(std::uint32_t slot, const Json& params);
    void remove(std::uint32_t slot);
    void clear();
    void arm() { claim_.arm(); }
    void disarm() { claim_.disarm(); }
    void reset() { claim_.reset_fault(); }

    /// Begins to read a mesh file and to send it. One at a time.
    void begin_mesh(const std::string& name, const std::string& unit, std::string bytes);
    /// What became of it, once: the members of `asset` (README.md). None: nothing yet, or none was begun.
    std::optional<Json> mesh();

    /// "I am alive", and what has changed. Throws std::runtime_error: the servo refused something.
    void commit() { claim_.commit(); }

  private:
    struct Read {
        meshfile::MeshFile file;
        double metre = 1;
        std::string notes;
    };
    static Read read_mesh(const std::string& bytes, const std::string& name, const std::string& unit);
    AnyHandle& handle(std::uint32_t slot);

    Client client_;
    Claim claim_;
    std::map<std::uint32_t, AnyHandle> handles_;  // by slot
    std::string mesh_name_, mesh_notes_;
    std::uint64_t mesh_triangles_ = 0;
    std::future<Read> reading_;
    std::optional<Sending> sending_;
};

}  // namespace knurl::gateway
