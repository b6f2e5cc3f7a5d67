// The cost of observation: counters and flight recorder, and a recording.

#include <algorithm>
#include <array>
#include <atomic>
#include <stdexcept>

#include <knurl/reps/plane.hpp>
#include <knurl/servo/input_log.hpp>

#include "goals.hpp"
#include "rig.hpp"

namespace knurl::servo::scaling {

namespace {

constexpr std::size_t sides_size = 4;
constexpr int cycles = 50;  // a sample's; before it the plane changes: 20 updates a second at 1 kHz

/// Repeats all that a cycle writes for observers, on separate memory. There is no servo without counters and
/// flight recorder, but one with two of each: the second costs what the first does.
class Second {
  public:
    Second()
        : memory_(shm::Segment::create("knurl-bench", protocol::device_layout().total)),
          reports_(with_empty_ring(memory_.data()), protocol::report_slots, sizeof(Report)),
          counters_(memory_.data() + protocol::device_layout().counters, protocol::count_names) {}

    void publish(const Report& report) { reports_.publish(&report); }
    void count(std::uint64_t cycle) {
        using protocol::Count;
        for (std::atomic<std::uint64_t>* word : {&row_.commits, &row_.refused, &row_.merged, &row_.age_ns,
                                                 &row_.interval_ns, &row_.gain_ppm, &row_.silent})
            word->store(cycle, std::memory_order_relaxed);
        constexpr auto stamped = static_cast<std::size_t>(Count::stamped_cycles);
        for (std::size_t i = 0; i < stamped; ++i) counters_.set(i, cycle + i);
        if (cycle % 64 != 0) return;  // as often as the servo stamps its parts
        counters_.set(stamped, cycle);
        for (std::size_t i = stamped + 1; i < std::size(protocol::count_names); ++i)
            counters_.set(i, static_cast<std::uint64_t>(clock_.now()));
    }

  private:
    static std::byte* with_empty_ring(std::byte* segment) {
        std::byte* const ring = segment + protocol::device_layout().reports;
        shm::broadcast_init(ring);
        return ring;
    }

    shm::Segment memory_;
    shm::BroadcastWriter reports_;
    shm::Counters counters_;
    protocol::ClientRow row_{};
    MonotonicClock clock_;
};

/// A hand that presses against a plane, which its application changes twenty times a second.
class Pressed {
  public:
    explicit Pressed(double settling) : claim_(rig_.claim(16)), plane_(claim_.add(params_)) {
        rig_.settle(settling);
        if (!rig_.touching()) throw std::logic_error("watching: the hand touches nothing");
    }
    Rig& rig() { return rig_; }
    /// ns a cycle.
    template <class After>
    double sample(After after) {
        params_.offset = params_.offset > 1 ? 1 : 1 + 1e-4;
        claim_.update(plane_, params_);
        claim_.commit();
        const double begin = thread_ns();
        for (int i = 0; i < cycles; ++i) {
            rig_.step();
            after();
        }
        return (thread_ns() - begin) / cycles;
    }

  private:
    Rig rig_;
    OfflineClaim& claim_;
    Plane params_{.offset = 1, .stiffness = 20};
    RepresentationId plane_;
};

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double mean(std::span<const double> of, std::span<const std::size_t> drawn) {
    double sum = 0;
    for (const std::size_t i : drawn) sum += of[i];
    return sum / static_cast<double>(drawn.size());
}

}  // namespace

std::vector<Judged> watching(Lab& lab) {
    // Counters lie in front of the parts' sums, which one cycle in 64 writes.
    static_assert(static_cast<std::size_t>(protocol::Count::stamped_cycles) + 8 ==
                  std::size(protocol::count_names));
    const double settling = lab.options().quick ? 0.05 : 0.5;
    const int samples = lab.options().quick ? 5 : 100;
    std::array<std::vector<double>, sides_size> blocks;
    std::array<std::size_t, sides_size> order = {0, 1, 2, 3};
    for (int block = 0; block < lab.blocks(); ++block) {
        // Created anew for each block, since the placement in memory makes a difference of a per cent.
        Pressed plain(settling), counted(settling), reported(settling), recorded(settling);
        Second second;
        OfflineMemory memory(input_log_bytes);
        InputLog input_log(memory.data(), {});
        recorded.rig().record(&input_log);
        const std::array<std::function<double()>, sides_size> sides = {
            [&] { return plain.sample([] {}); },
            [&] { return counted.sample([&] { second.count(counted.rig().last().cycle); }); },
            [&] { return reported.sample([&] { second.publish(reported.rig().last()); }); },
            [&] { return recorded.sample([] {}); }};
        // Alternates sample by sample, so that the machine's effects in a block reach all of them.
        std::array<std::vector<double>, sides_size> taken;
        for (int i = -2; i < samples; ++i) {
            std::shuffle(order.begin(), order.end(), lab.random());
            for (const std::size_t side : order) {
                const double ns = sides[side]();
                if (i >= 0) taken[side].push_back(ns);
            }
        }
        for (std::size_t side = 0; side < sides_size; ++side) blocks[side].push_back(median(taken[side]));
        if (InputLog::written(memory.data()) < static_cast<std::uint64_t>(samples) * cycles)
            throw std::runtime_error("watching: nothing was recorded");
    }

    /// What the sides together add to a plain cycle.
    const auto share = [&](double limit, const char* name, std::initializer_list<std::size_t> added) {
        return judge({.name = name, .limit = limit, .unit = "%"}, blocks[0].size(),
                     [&](std::span<const std::size_t> drawn, std::span<const std::size_t>) {
                         const double without = mean(blocks[0], drawn);
                         double more = 0;
                         for (const std::size_t side : added) more += mean(blocks[side], drawn) - without;
                         return std::optional(100 * more / without);
                     });
    };
    return {share(3, "counters, of a cycle in contact", {1}),
            share(3, "counters and flight recorder, of a cycle in contact", {1, 2}),
            share(5, "recording, of a cycle in contact", {3})};
}

}  // namespace knurl::servo::scaling
