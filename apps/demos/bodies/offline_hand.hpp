#pragma once
// A servo, its simulated device and hand in this process, on a virtual clock. Its claim has an application's
// interface, so the coupling runs in it as in a program, and results are reproducible to the last bit.

#include <functional>
#include <memory>

#include <knurl/drivers/sim_device.hpp>
#include <knurl/geometry/mesh.hpp>
#include <knurl/servo/offline.hpp>

#include "coupled.hpp"

namespace bodies {

class OfflineHand {
  public:
    /// `address`: a profile with options, as in "sim:premium15,grip=0.5" without the scheme.
    OfflineHand(const std::string& address, const knurl::drivers::Motion& motion, bool clamp = true);

    template <class R>
    struct There {
        OfflineHand* hand;
        knurl::RepresentationId id;
        void set(const R& params) { hand->claim_->update(id, params); }
        std::optional<knurl::HandFeedback> feedback() const { return hand->feedback(id); }
    };
    template <class R>
    There<R> add(const R& params, const knurl::AddOptions& options = {}) {
        return {this, claim_->add(params, options)};
    }
    std::uint32_t send(const Skin& skin);
    void place_probe(std::uint32_t probe, const knurl::ProbePlacement& placement) {
        claim_->place_probe(probe, placement);
    }
    void arm() { claim_->arm(); }
    void commit() { claim_->commit(); }
    /// One cycle of a millisecond.
    const knurl::Report& step();
    double now() const { return static_cast<double>(cycles_) * 1e-3; }  // s
    const knurl::drivers::SimState& truth() const { return device_.state(); }

  private:
    std::optional<knurl::HandFeedback> feedback(knurl::RepresentationId id) const;

    knurl::drivers::SimDevice device_;
    std::vector<std::unique_ptr<knurl::Mesh>> meshes_;
    knurl::servo::Offline servo_;
    knurl::servo::OfflineClaim* claim_;
    const knurl::servo::OfflineClaim::FeedbackSet* feedback_ = nullptr;
    std::uint64_t cycles_ = 0;
};

}  // namespace bodies
