#include "ways.hpp"

#include <chrono>
#include <cmath>
#include <ctime>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/mesh.hpp>
#include <knurl/reps/constant_force.hpp>

#include "stated.hpp"
#include "terrain_whole.hpp"

namespace surface {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC: the reports' clock

constexpr double slow_hand = 0.1;  // m/s, well below what arming asks for
constexpr auto patience = 8s;      // for a slow hand, and for an active device

std::int64_t now_ns() {
    return Clock::now().time_since_epoch() / 1ns;
}

std::chrono::nanoseconds seconds(double s) {
    return std::chrono::nanoseconds(std::llround(s * 1e9));
}

/// All communication between application and servo in one stroke.
class Session {
  public:
    Session(knurl::Client& client, Way way, const Terrain& terrain, const StrokeRun& run,
            const std::atomic<bool>& stop)
        : terrain_(terrain),
          run_(run),
          stop_(stop),
          // A surface that is sent once needs no updates.
          hand_(client.claim(run.device, {.update_interval = way == Way::mesh || way == Way::field
                                                                 ? std::chrono::nanoseconds(1s)
                                                                 : seconds(1 / run.rate)})) {
        recording_.way = way;
        const knurl::Limits limits = hand_.limits();
        recording_.max_stiffness = limits.max_stiffness;
        recording_.stiffness = std::min(run.stiffness, limits.max_stiffness);
        recording_.greatest_force = std::isfinite(limits.max_force) ? limits.max_force : 0;
    }

    Recording run() {
        wait_until_slow();
        if (newest_.state == knurl::DeviceState::fault) hand_.reset_fault();
        switch (recording_.way) {
            case Way::force: {
                auto push = hand_.add(knurl::ConstantForce{.recovery = 0});
                loop([&] {
                    push.set({.force = knurl::to_plain(force_here()), .recovery = 0});
                    return Pieces{};
                });
                break;
            }
            case Way::planes:
                set_planes({.recovery = 0});
                break;
            case Way::paper:
                set_planes({.recovery = 0.05, .update = knurl::PlaneUpdate::paper});
                break;
            case Way::knurl:
                follow_with(plane_here({}), [&](const knurl::Vec3& near) { return surface_at(near); });
                break;
            case Way::caps:
                follow_with(cap_here(),
                            knurl::curved([&](const knurl::Vec3& near) { return surface_at(near); }));
                break;
            case Way::mesh: {
                const TerrainMesh relief(terrain_);
                feel_whole(hand_.send(relief.triangles()));
                state_whole(knurl::Mesh(relief.triangles()));
                break;
            }
            case Way::field: {
                const TerrainField relief(terrain_);
                feel_whole(hand_.send(knurl::Heights{.grid = relief.grid, .heights = relief.heights}));
                state_whole(knurl::HeightField(relief.heights, relief.grid));
                break;
            }
        }
        // Over a network the time of an update's effect is unknown here.
        if (recording_.own_force.empty() && hand_.network().round_trip == 0ns)
            recording_.own_force = stated_.force(recording_, hand_.limits());
        hand_.release();
        return std::move(recording_);
    }

  private:
    using Pieces = std::vector<Stated::Piece>;  // none: the previous ones stay

    /// The planes that are set. Without recovery each takes effect at once.
    void set_planes(const knurl::Plane& like) {
        auto floor = hand_.add(plane_here(like));
        stated_.say(0, 0, {plane_here({})});
        loop([&]() -> Pieces {
            floor.set(plane_here(like));
            return {plane_here({})};
        });
    }

    template <class Face>
    void follow_with(const Face& first, const knurl::SurfaceModel& model) {
        auto floor = hand_.add(first);
        stated_.say(0, 0, {first});
        loop([&] {
            Pieces pieces;
            const auto followed = floor.follow(model);
            for (const knurl::SurfacePoint& face : followed.faces.all()) {
                Face placed = first;
                knurl::place(placed, face);
                pieces.emplace_back(placed);
            }
            return pieces;
        });
    }

    /// After sending it the application has nothing to update.
    void feel_whole(const knurl::SentShape& sent) {
        const knurl::Shape whole{.asset = sent.asset, .stiffness = recording_.stiffness};
        const auto felt = hand_.add(whole);
        loop([] { return Pieces{}; });
    }
    void state_whole(const knurl::Asset& here) {
        stated_.say(0, 0, {knurl::Shape{.asset = 1, .stiffness = recording_.stiffness}});
        recording_.own_force = stated_.force(recording_, hand_.limits(), &here);
    }

    /// An application's loop: at fixed times read the hand, think, answer; nothing runs at 1 kHz.
    template <class Answer>
    void loop(Answer&& answer) {
        hand_.arm();
        const auto deadline = Clock::now() + patience;
        const auto period = seconds(1 / run_.rate);
        for (auto tick = Clock::now();; tick += period) {
            if (tick + period < Clock::now())
                tick = Clock::now();  // behind schedule: updates are skipped, not bunched
            std::this_thread::sleep_until(tick);
            take_reports();
            if (over()) break;
            if (begun_ == 0 && Clock::now() > deadline)
                throw std::runtime_error(
                    "the device did not become active; look at `knurl devices` and the servo's log");
            const Update read{.report_cycle = newest_.cycle, .report_read_ns = newest_.read_ns};
            Pieces pieces = answer();
            std::this_thread::sleep_until(tick + seconds(run_.think));
            const std::int64_t begin_ns = now_ns();
            hand_.commit();
            Update update = read;
            update.commit_ns = now_ns();
            if (!pieces.empty()) stated_.say(begin_ns, update.commit_ns, std::move(pieces));
            if (begun_ != 0) recording_.updates.push_back(update);
        }
        recording_.unread = hand_.missed();
    }

    bool over() {
        if (stop_) recording_.interrupted = true;
        if (recording_.interrupted) return true;
        if (!hand_.connected()) {
            hand_.device();  // throws with the reason
            throw std::runtime_error("the servo was away for a moment; run it again");
        }
        return !recording_.cycles.empty() &&
               (recording_.cycles.back().faults != 0 || recording_.cycles.back().t > run_.span.end);
    }

    /// Every report since the last call, in order; the last is the newest.
    void take_reports() {
        while (auto report = hand_.next_report(0ns)) {
            newest_ = *report;
            const bool lives = report->state == knurl::DeviceState::active;
            if (begun_ == 0 && lives) begun_ = report->deadline_ns;
            if (begun_ == 0) continue;
            recording_.cycles.push_back({
                .number = report->cycle,
                .t = static_cast<double>(report->deadline_ns - begun_) * 1e-9,
                .position = knurl::to_eigen(report->position),
                .velocity = knurl::to_eigen(report->velocity),
                .force = knurl::to_eigen(report->scene_force),
                .faults = report->faults,
                .active = lives,
                .gap = recording_.read_ns.empty()
                           ? 0
                           : static_cast<double>(report->read_ns - recording_.read_ns.back()) * 1e-9,
                .late_count = report->late_count,
            });
            recording_.read_ns.push_back(report->read_ns);
            recording_.write_ns.push_back(report->write_ns);
        }
    }

    void wait_until_slow() {
        const auto deadline = Clock::now() + patience;
        for (int slow = 0; slow < 300;) {  // cycles in a row
            const auto report = hand_.next_report(100ms);
            if (stop_) return;
            if (Clock::now() > deadline)
                throw std::runtime_error(
                    "the hand does not come to rest, so the device is not armed; hold it still");
            if (!report) continue;
            newest_ = *report;
            slow = knurl::to_eigen(report->velocity).norm() < slow_hand ? slow + 1 : 0;
        }
    }

    Eigen::Vector3d force_here() const {
        return true_force(terrain_.foot(knurl::to_eigen(newest_.position)),
                          {.stiffness = recording_.stiffness, .greatest_force = recording_.greatest_force});
    }

    knurl::SurfacePoint surface_at(const knurl::Vec3& near) const {
        const auto foot = terrain_.foot(knurl::to_eigen(near));
        return {knurl::to_plain(foot.point), knurl::to_plain(foot.normal)};
    }

    /// The surface's tangent plane at the hand, with the other values of `plane`.
    knurl::Plane plane_here(knurl::Plane plane) const {
        const auto foot = terrain_.foot(knurl::to_eigen(newest_.position));
        plane.normal = knurl::to_plain(foot.normal);
        plane.offset = foot.normal.dot(foot.point);
        plane.stiffness = recording_.stiffness;
        return plane;
    }

    knurl::Cap cap_here() const {
        const auto foot = terrain_.foot(knurl::to_eigen(newest_.position));
        return {.foot = knurl::to_plain(foot.point),
                .normal = knurl::to_plain(foot.normal),
                .stiffness = recording_.stiffness};
    }

    const Terrain& terrain_;
    const StrokeRun& run_;
    const std::atomic<bool>& stop_;
    knurl::Claim hand_;
    Recording recording_;
    Stated stated_;
    knurl::HandReport newest_;
    std::int64_t begun_ = 0;  // deadline of the first active cycle
};

}  // namespace

Recording stroke(knurl::Client& client, Way way, const Terrain& terrain, const StrokeRun& run,
                 const std::atomic<bool>& stop) {
    return Session(client, way, terrain, run, stop).run();
}

}  // namespace surface
