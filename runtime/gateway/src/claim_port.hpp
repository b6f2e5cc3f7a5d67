#pragma once
// The claim of a PeerHand: a connection, one force, one spring, and what the peer has named. Private to this module.

#include <map>
#include <optional>
#include <string>

#include <knurl/client/client.hpp>
#include <knurl/reps/constant_force.hpp>
#include <knurl/reps/spring.hpp>

#include "peer_life.hpp"

namespace knurl::gateway {

class ClaimPort final : public PeerPort {
  public:
    explicit ClaimPort(const PeerOptions& options) : options_(options) {}

    void open() override;
    void close() noexcept override;
    Seen look() override;
    void arm() override;
    void push(const Push& push, double fade) override;
    void pull(const Vec3& from, const Vec3& to, double duration) override;
    void let_go() override;
    void change(const ItemChange& change) override;
    bool busy() const override { return !meshes_.empty(); }
    bool progress() override;
    void commit() override;
    std::map<std::string, PeerFeedback> feedback() override;

  private:
    /// A mesh on its way, and the shape that it will be.
    struct Arriving {
        Sending sending;
        ItemChange change;
    };

    void place(const ItemChange& change);
    void take_away(const std::string& name);

    const PeerOptions& options_;
    std::optional<Client> client_;
    std::optional<Claim> claim_;
    std::optional<Handle<ConstantForce>> force_;
    std::optional<Handle<Spring>> spring_;
    std::map<std::string, AnyHandle> items_;
    std::map<std::string, std::uint32_t> assets_;  // of what is a mesh
    std::map<std::string, Arriving> meshes_;
};

}  // namespace knurl::gateway
