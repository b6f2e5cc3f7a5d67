// Applications and readers of one device.

#include <stdexcept>

#include <knurl/reps/plane.hpp>
#include <knurl/shm/broadcast_ring.hpp>

#include "lab.hpp"
#include "rig.hpp"

namespace knurl::servo::scaling {

namespace {

constexpr std::uint32_t room = 16;  // for representations, of a claim
constexpr Plane floor_below{.offset = -0.1, .stiffness = 20};
constexpr AddOptions kept{.on_silence = OnSilence::hold};

/// Some applications; each with a plane out of reach, or with nothing.
struct Crowd {
    Rig rig;
    std::vector<RepresentationId> planes;
    double offset = 0;
    std::uint64_t commits = 0;

    Crowd(double applications, bool with_planes, double settling) {
        for (int i = 0; i < static_cast<int>(applications); ++i) {
            OfflineClaim& claim = rig.claim(room);
            if (with_planes) planes.push_back(claim.add(floor_below, kept));
        }
        rig.settle(settling);
    }
    void commit() {
        for (const auto& claim : rig.claims()) claim->commit();
        commits += rig.claims().size();
    }
    void change() {
        Plane plane = floor_below;
        plane.offset += offset;
        offset = offset > 0 ? 0 : 1e-4;
        for (std::size_t i = 0; i < planes.size(); ++i) rig.claims()[i]->update(planes[i], plane);
        commit();
    }
};

using Crowds = std::vector<std::shared_ptr<Crowd>>;
using Sampler = std::function<std::function<double()>(const std::shared_ptr<Crowd>&)>;

Series crowd_series(Lab& lab, Crowds& crowds, const char* name, const char* why, bool with_planes,
                    int samples, const Sampler& sampler) {
    Series series{
        .name = name, .axis = "clients", .design = measure::Growth::linear, .why = why, .points = {}};
    const auto add = [&](double n) {
        const auto& crowd = crowds.emplace_back(std::make_shared<Crowd>(n, with_planes, lab.settling()));
        series.points.push_back({.n = n, .sample = sampler(crowd), .samples = samples});
    };
    add(0);
    for (const double n : geometric(1, 128, 2)) add(n);
    return series;
}

}  // namespace

std::vector<Series> clients(Lab& lab) {
    const bool quick = lab.options().quick;
    const int rows = 5, alone = quick ? 12 : 40, cycles = quick ? 50 : 200;
    const Sampler in_a_row = [&](const auto& crowd) {
        return lab.in_a_row([crowd] { crowd->rig.step(); }, cycles);
    };
    const Sampler cold = [&](const auto& crowd) {
        return lab.alone_and_cold([crowd] { crowd->rig.step(); });
    };
    const auto sending = [&](bool planes, bool flushed) -> Sampler {
        return [&lab, planes, flushed](const auto& crowd) {
            const auto clients =
                lab.elsewhere([crowd, planes] { planes ? crowd->change() : crowd->commit(); });
            const auto cycle = [crowd] { crowd->rig.step(); };
            return flushed ? lab.alone_and_cold(cycle, clients) : lab.alone(cycle, clients);
        };
    };
    const char* look = "the servo looks at each claim's two rings";
    const char* ask = "the servo looks at each claim's two rings and asks its scene";
    const char* take = "the servo takes one batch of each claim, and asks its scene";
    std::vector<Series> axis;
    Crowds crowds;
    const auto add = [&](const char* name, const char* why, bool planes, int samples,
                         const Sampler& sampler) {
        axis.push_back(crowd_series(lab, crowds, name, why, planes, samples, sampler));
    };
    add("clients.idle.warm", look, false, rows, in_a_row);
    add("clients.idle.cold", look, false, alone, cold);
    add("clients.silent.warm", ask, true, rows, in_a_row);
    add("clients.silent.cold", ask, true, alone, cold);
    // The reference for batches: cycles timed in the same way.
    add("clients.silent.alone", ask, true, alone,
        [&](const auto& crowd) { return lab.alone([crowd] { crowd->rig.step(); }, lab.elsewhere([] {})); });
    add("clients.empty_batch.warm", take, true, alone, sending(false, false));
    add("clients.sending.warm", take, true, alone, sending(true, false));
    add("clients.sending.cold", take, true, alone, sending(true, true));
    lab.measure(axis);
    for (const auto& crowd : crowds)
        if (crowd->rig.batches_taken() != crowd->commits)
            throw std::runtime_error("clients: a batch was not taken in its cycle");
    return axis;
}

std::vector<Series> readers(Lab& lab) {
    /// Readers with a mapping each, all of which read every report, on another CPU.
    struct Readers {
        Rig rig;
        std::vector<shm::Segment> mappings;
        std::vector<shm::BroadcastReader> readers;
        std::uint64_t read = 0;

        Readers(double n, bool in_the_table, double settling) {
            rig.claim(room).add(floor_below, kept);
            for (int i = 0; i < static_cast<int>(n); ++i) {
                if (in_the_table) rig.observer();
                mappings.push_back(shm::Segment::open(rig.memory().fd(), rig.memory().size(),
                                                      shm::Segment::Access::read_only));
                readers.emplace_back(mappings.back().data() + protocol::device_layout().reports,
                                     protocol::report_slots, sizeof(Report));
            }
            rig.settle(settling);
        }
        void read_all() {
            Report report;
            for (shm::BroadcastReader& reader : readers)
                while (reader.next(&report)) ++read;
        }
    };
    std::vector<Series> axis = {{.name = "readers.of_the_ring",
                                 .axis = "report readers",
                                 .design = measure::Growth::constant,
                                 .why = "one ring for all, in which a reader writes nothing",
                                 .points = {}},
                                {.name = "readers.in_the_table",
                                 .axis = "report readers",
                                 .design = measure::Growth::linear,
                                 .why = "of each the servo asks whether it sleeps, and states what it missed",
                                 .points = {}}};
    std::vector<double> values = {0};
    // Of 128 clients one is the application.
    for (const double n : geometric(1, 127, 2)) values.push_back(n);
    values.push_back(127);
    for (Series& series : axis)
        for (const double n : values) {
            const auto all = std::make_shared<Readers>(n, &series == &axis[1], lab.settling());
            series.points.push_back(
                {.n = n,
                 .sample = lab.alone([all] { all->rig.step(); }, lab.elsewhere([all] { all->read_all(); })),
                 .samples = lab.options().quick ? 12 : 40});
        }
    lab.measure(axis);
    return axis;
}

}  // namespace knurl::servo::scaling
