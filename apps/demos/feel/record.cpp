#include "record.hpp"

#include <fmt/format.h>

#include <knurl/geometry/proxy.hpp>
#include <knurl/measure/output_file.hpp>

namespace feel {

void expect(std::vector<Cycle>& cycles, const knurl::Mesh& mesh, double stiffness, double peak) {
    knurl::Proxy proxy;
    for (Cycle& cycle : cycles) {
        knurl::Foot foot;
        knurl::Work work;
        cycle.touching = knurl::follow(mesh, proxy, cycle.position, 0, foot, work);
        cycle.proxy = cycle.position;
        if (!cycle.touching) continue;
        cycle.proxy = cycle.position + foot.depth * foot.normal;
        const double share =
            foot.material < mesh.materials.size() ? mesh.materials[foot.material].stiffness : 1;
        cycle.expected = std::min(share * stiffness * foot.depth, peak) * foot.normal;
    }
}

Judgement judge(const std::vector<Cycle>& cycles) {
    constexpr double a_jump = 0.5, felt = 1e-6;  // N
    Judgement of{.cycles = cycles.size()};
    for (std::size_t i = 0; i < cycles.size(); ++i) {
        const Cycle& now = cycles[i];
        of.touching += now.touching;
        of.mean_force += now.force.norm();
        of.peak_force = std::max(of.peak_force, now.force.norm());
        if (i == 0) continue;
        const Cycle& before = cycles[i - 1];
        const std::uint64_t gap = now.number - before.number;
        of.missed += gap - 1;
        if (gap != 1) continue;
        of.worst_error = std::max(of.worst_error, (now.force - now.expected).norm());
        of.lost += (now.force.norm() > felt) != (now.expected.norm() > felt);
        const double jump = (now.force - before.force).norm(),
                     expected = (now.expected - before.expected).norm();
        of.jump = std::max(of.jump, jump);
        of.expected_jump = std::max(of.expected_jump, expected);
        of.jumps += jump > a_jump;
        of.expected_jumps += expected > a_jump;
    }
    if (of.cycles > 0) of.mean_force /= static_cast<double>(of.cycles);
    return of;
}

void write_csv(const std::string& path, const std::vector<Cycle>& cycles) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out,
                   "cycle,t,x,y,z,fx,fy,fz,proxy_x,proxy_y,proxy_z,expected_fx,expected_fy,expected_fz\n");
    for (const Cycle& c : cycles)
        fmt::format_to(
            out,
            "{},{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n",
            c.number, c.t, c.position.x(), c.position.y(), c.position.z(), c.force.x(), c.force.y(),
            c.force.z(), c.proxy.x(), c.proxy.y(), c.proxy.z(), c.expected.x(), c.expected.y(),
            c.expected.z());
    knurl::measure::write_file(path, fmt::to_string(text));
}

}  // namespace feel
