// follow(): applies the pure function of predict.hpp to the claim's reports and pending changes.

#include <algorithm>
#include <cstring>

#include <knurl/client/error.hpp>
#include <knurl/link/clock.hpp>
#include <knurl/link/text.hpp>
#include <knurl/reps/all.hpp>

#include "claim_state.hpp"
#include "validate.hpp"

namespace knurl::detail {

namespace {

/// A place that no hand reaches. It is not removed: so a corner that comes and goes changes within one batch.
template <class R>
R parked(R params, double far) {
    const double length = to_eigen(params.normal).norm();
    const Eigen::Vector3d normal = to_eigen(params.normal) / length;
    Eigen::Vector3d foot;
    if constexpr (std::is_same_v<R, Cap>)
        foot = to_eigen(params.foot);
    else
        foot = params.offset / length * normal;
    place(params, {.foot = to_plain(foot - far * normal), .normal = to_plain(normal)});
    return params;
}

double rim_of(const Plane&) {
    return 0;
}
double rim_of(const Cap& cap) {
    return cap.rim;
}

}  // namespace

Followed ClaimState::follow(RepresentationId id, Kind kind, const SurfaceModel& model) {
    if (kind != kind_of<Cap> && kind != kind_of<Plane>)
        throw Error(Error::Kind::bad_parameters,
                    detail::format("{}: only a plane or a cap follows a surface", kinds()[kind].name));
    return kind == kind_of<Cap> ? follow_with<Cap>(id, model) : follow_with<Plane>(id, model);
}

template <class R>
Followed ClaimState::follow_with(RepresentationId id, const SurfaceModel& model) {
    Lock lock = enter();
    R params;
    std::memcpy(&params, entry(id).params.data(), sizeof params);
    FollowMemory memory = entry(id).followed;
    // The newest report, even if the application read an older one before a long computation.
    const std::optional<Report> report = peek(lock);
    if (!report) return {};
    // The application may commit more often than it follows. The life of this update is what counts.
    Entry& followed = entry(id);
    const std::int64_t now = monotonic_ns();
    if (followed.last_follow_ns != 0)
        followed.follow_intervals.add(static_cast<double>(now - followed.last_follow_ns) * 1e-9);
    followed.last_follow_ns = now;
    Lateness late = lateness();
    if (!ages_.empty() && !followed.follow_intervals.empty())
        late.interval = followed.follow_intervals.median();
    const Follower follower{.stiffness = std::min(params.stiffness, limits_.max_stiffness),
                            .rim = rim_of(params),
                            .metre = limits_.metre,
                            .newton = limits_.newton};
    lock.unlock();  // the model belongs to the application and may call the library
    const Followed result = follow_surface(model,
                                           {.time = static_cast<double>(report->read_ns) * 1e-9,
                                            .position = report->position,
                                            .velocity = report->slow_velocity},
                                           late, follower, memory);
    lock = enter();

    send_faces(id, params, result.faces);
    entry(id).followed = memory;
    if (result.undersampled) ++undersampled_;
    note_basis(report->cycle);
    return result;
}

template <class R>
void ClaimState::send_faces(RepresentationId id, R params, const Faces& faces) {
    for (const SurfacePoint& face : faces.all()) {
        place(params, face);
        validate(kind_of<R>, &params, sizeof params);
    }
    // A new side comes with the batch, like the others.
    std::vector<RepresentationId>& others = entry(id).sides;
    for (std::size_t i = 0; i + 1 < faces.count; ++i) {
        if (i < others.size() && table_.find(others[i]) != nullptr) continue;
        place(params, faces.face[i + 1]);
        const R apart = parked(params, far());
        const RepresentationId side = add_now(kind_of<R>, &apart, sizeof apart, entry(id).options);
        if (i < others.size())
            others[i] = side;
        else
            others.push_back(side);
    }
    park_sides(id, faces.count - 1);
    for (std::uint32_t i = 0; i < faces.count; ++i) {
        place(params, faces.face[i]);
        table_.set(i == 0 ? id : others[i - 1], std::as_bytes(std::span(&params, 1)));
    }
    entry(id).sides_used = faces.count - 1;
}

template <class R>
void ClaimState::park(RepresentationId side) {
    const Entry* found = table_.find(side);
    if (found == nullptr) return;  // a group has taken it back
    R params;
    std::memcpy(&params, found->params.data(), sizeof params);
    params = parked(params, far());
    table_.set(side, std::as_bytes(std::span(&params, 1)));
}

void ClaimState::park_sides(RepresentationId id, std::uint32_t first) {
    Entry& main = entry(id);
    for (std::uint32_t i = first; i < main.sides_used; ++i) {
        if (main.kind == kind_of<Cap>)
            park<Cap>(main.sides[i]);
        else
            park<Plane>(main.sides[i]);
    }
    main.sides_used = std::min(main.sides_used, first);
}

double ClaimState::far() const {
    return std::max(1e3, 1e2 * request().workspace_radius);
}

}  // namespace knurl::detail
