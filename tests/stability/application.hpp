#pragma once
// The slow half of the loop: an application that reads the hand at its own rate, thinks, and answers late.

#include <array>
#include <cstddef>
#include <variant>
#include <vector>

#include <knurl/client/predict.hpp>
#include <knurl/reps/cap.hpp>
#include <knurl/reps/constant_force.hpp>
#include <knurl/reps/plane.hpp>
#include <knurl/reps/scene.hpp>

#include "conditions.hpp"
#include "network.hpp"

namespace stability {

using Representation = std::variant<knurl::Plane, knurl::Cap, knurl::ConstantForce>;
/// The faces of a corner, else one. As in the client library, a face that was sent once and is no longer
/// needed stays, at a place that no hand reaches.
using Answer = std::vector<Representation>;

/// Replaces the last answer: `add` returns the id of a new representation, `update` takes one.
template <class Add, class Update>
void put(const Answer& answer, std::vector<knurl::RepresentationId>& there, Add&& add, Update&& update) {
    for (std::size_t i = 0; i < answer.size(); ++i) {
        if (i < there.size())
            std::visit([&](const auto& params) { update(there[i], params); }, answer[i]);
        else
            there.push_back(std::visit(add, answer[i]));
    }
}

class Application {
  public:
    /// `phase` in 0..1: when in its interval it reads first.
    Application(const Conditions& conditions, double stiffness, double phase, unsigned seed = 1);
    /// Of another surface than the conditions' ridge, by planes or caps.
    Application(const Conditions& conditions, double stiffness, double phase, knurl::SurfaceModel model,
                unsigned seed = 1);

    /// It sees the hand in the device's metres, and answers in its own world's (Conditions::world).
    /// What is there from the start: the answer at a hand that rests in `p`.
    Answer first(const Eigen::Vector3d& p);
    /// A report of the servo: it reads it if it is time to.
    void read(double t, const Eigen::Vector3d& p, const Eigen::Vector3d& slow_velocity);
    /// True if an answer is due by t (s), which `answer` then is.
    bool due(double t);
    const Answer& answer() const { return answer_; }

  private:
    struct Seen {
        double t;  // s, when the servo read it
        Eigen::Vector3d position, slow_velocity;
    };
    struct Sent {
        double seen;  // s, of the report that it was computed from
        Answer answer;
    };

    Answer solve(double t, const Eigen::Vector3d& p, const Eigen::Vector3d& velocity);
    bool arrive(double t, bool ready);
    double latency() const;

    const Conditions& conditions_;
    double stiffness_;
    knurl::SurfaceModel model_;
    knurl::FollowMemory memory_;
    std::size_t most_faces_ = 1;  // that were sent at once
    Answer answer_;
    double next_read_;  // s
    double due_ = 0;    // s, of the answer under way
    bool under_way_ = false;
    // Of a remote one.
    std::uint64_t seed_;
    Newest<Seen> reports_;
    Newest<Sent> answers_;
    Sent thought_;                                // being made
    static constexpr std::size_t remembered = 7;  // as the client library's median
    std::array<double, remembered> ages_{};       // s, of reports at the use of what they led to
    std::size_t aged_ = 0;
};

}  // namespace stability
