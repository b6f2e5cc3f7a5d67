// Pending changes with a servo that takes at any time. For every interleaving, after a take the servo has to
// the last byte what the application had committed with that batch: nothing lost, torn or stale. The channel
// is the real one; the test plays the servo's side.

#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/client/error.hpp>
#include <knurl/link/local.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/triple_buffer.hpp>

#include "table.hpp"

namespace unit_pending_tests {
namespace {

using namespace knurl;
using detail::Table;
using protocol::ClaimCapacity;

constexpr ClaimCapacity capacity{.representations = 8, .batch_bytes = 4096};

std::span<const std::byte> bytes_of(const Plane& plane) {
    return std::as_bytes(std::span(&plane, 1));
}
// Every fourth has another material than before, so the fields behind the geometry change at times.
Plane plane_at(double offset) {
    Plane plane{.offset = offset, .stiffness = 100};
    plane.friction.dynamic = std::floor(offset / 4);
    return plane;
}

/// The content of a world: generation and offset of the plane in each slot.
using World = std::map<std::uint32_t, std::pair<std::uint32_t, double>>;

/// The servo's command processor, in its simplest form: adds and removals arrive in order and at once.
class ServoSide {
  public:
    explicit ServoSide(std::byte* memory)
        : batches_(memory + layout_.batches, layout_.batch_slot_bytes), slot_(layout_.batch_slot_bytes) {}

    void add(RepresentationId id, double offset) {
        world[id.slot] = {id.generation, offset};
        planes_[id.slot] = plane_at(offset);
        versions_[id.slot] = 0;
    }
    void remove(RepresentationId id) { world.erase(id.slot); }

    /// The sequence of the batch that it took.
    std::optional<std::uint64_t> take() {
        if (!batches_.take()) return std::nullopt;
        batches_.copy(slot_.data(), 0, slot_.size());
        protocol::BatchHeader header;
        std::memcpy(&header, slot_.data(), sizeof header);
        std::size_t at = sizeof header;
        for (std::uint32_t i = 0; i < header.entries; ++i) {
            protocol::EntryHeader entry;
            std::memcpy(&entry, slot_.data() + at, sizeof entry);
            const std::byte* const params = slot_.data() + at + sizeof entry;
            at += sizeof entry + entry.bytes;
            const auto found = world.find(entry.id.slot);
            if (found == world.end() || found->second.first != entry.id.generation) continue;
            if (entry.version <= versions_[entry.id.slot]) continue;
            versions_[entry.id.slot] = entry.version;
            Plane& plane = planes_[entry.id.slot];  // fields that are not sent stay as they are
            std::memcpy(&plane, params, entry.bytes);
            const Plane want = plane_at(plane.offset);
            const bool whole = std::memcmp(&plane, &want, sizeof plane) == 0;
            found->second.second = whole ? plane.offset : std::nan("");
        }
        EXPECT_EQ(at, sizeof header + header.bytes);
        return header.sequence;
    }

    World world;

  private:
    protocol::ClaimLayout layout_ = protocol::claim_layout(capacity);
    shm::TripleReader batches_;
    std::vector<std::byte> slot_;
    std::map<std::uint32_t, std::uint64_t> versions_;
    std::map<std::uint32_t, Plane> planes_;
};

struct Pair {
    std::shared_ptr<shm::Segment> segment = [] {
        const auto layout = protocol::claim_layout(capacity);
        auto made = std::make_shared<shm::Segment>(shm::Segment::create("test", layout.total));
        shm::spsc_init(made->data() + layout.commands);
        shm::spsc_init(made->data() + layout.replies);
        shm::triple_init(made->data() + layout.batches);
        shm::triple_init(made->data() + layout.feedback);
        return made;
    }();
    std::unique_ptr<detail::ClaimChannel> channel = detail::local_channel(segment, capacity);
    ServoSide servo{segment->data()};
    Table table{capacity};
    World world;  // the application's
    std::map<std::uint64_t, World> committed;
    std::uint64_t sequence = 0;

    /// `forgetful`: a deliberately wrong library, which assumes that every batch was taken.
    void commit(bool forgetful = false) {
        const auto entries = table.batch();
        const protocol::BatchHeader header{.sequence = ++sequence,
                                           .commands_before = 0,
                                           .report_cycle = 0,
                                           .commit_ns = 0,
                                           .entries = table.batch_entries(),
                                           .bytes = static_cast<std::uint32_t>(entries.size())};
        const bool taken = channel->publish(header, entries);
        table.published(taken || forgetful);
        committed[sequence] = world;
    }
};

/// One random run. Returns how many of its takes left the servo with other parameters than the application
/// had committed.
int wrong_takes(std::uint32_t seed, bool forgetful) {
    std::mt19937 random(seed);
    Pair pair;
    std::vector<RepresentationId> ids;
    double value = 0;
    int wrong = 0;
    for (int step = 0; step < 400; ++step) {
        switch (random() % 8) {
            case 0:
                if (ids.size() < capacity.representations) {
                    const RepresentationId id =
                        pair.table.add(kind_of<Plane>, bytes_of(plane_at(++value)), {});
                    ids.push_back(id);
                    pair.world[id.slot] = {id.generation, value};
                    pair.servo.add(id, value);
                    for (auto& [sequence, world] : pair.committed) world[id.slot] = pair.world[id.slot];
                }
                break;
            case 1:
                if (!ids.empty() && random() % 2 == 0) {
                    const std::size_t which = random() % ids.size();
                    const RepresentationId id = ids[which];
                    ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(which));
                    pair.table.remove(id);
                    pair.servo.remove(id);
                    pair.world.erase(id.slot);
                    for (auto& [sequence, world] : pair.committed) world.erase(id.slot);
                }
                break;
            case 2:
            case 3:
            case 4:
                if (!ids.empty()) {
                    const RepresentationId id = ids[random() % ids.size()];
                    pair.table.set(id, bytes_of(plane_at(++value)));
                    pair.world[id.slot].second = value;
                }
                break;
            case 5:
            case 6:
                pair.commit(forgetful);
                break;
            default:
                if (const auto sequence = pair.servo.take())
                    wrong += pair.servo.world == pair.committed[*sequence] ? 0 : 1;
        }
    }
    return wrong;
}

TEST(Pending, whatever_the_servo_takes_is_what_was_committed_with_that_batch) {
    for (std::uint32_t seed = 1; seed <= 600; ++seed)
        ASSERT_EQ(wrong_takes(seed, false), 0) << "seed " << seed;
}

TEST(Pending, this_test_would_see_a_library_that_forgets_what_was_not_taken) {
    int wrong = 0;
    for (std::uint32_t seed = 1; seed <= 30; ++seed) wrong += wrong_takes(seed, true);
    EXPECT_GT(wrong, 100);
}

TEST(Pending, shrinks_to_the_last_change_once_the_batch_before_was_taken) {
    Pair pair;
    const RepresentationId a = pair.table.add(kind_of<Plane>, bytes_of(plane_at(1)), {});
    const RepresentationId b = pair.table.add(kind_of<Plane>, bytes_of(plane_at(2)), {});
    pair.table.set(a, bytes_of(plane_at(3)));
    pair.commit();
    pair.table.set(b, bytes_of(plane_at(4)));
    pair.commit();
    pair.table.batch();
    EXPECT_EQ(pair.table.batch_entries(), 2u) << "the first batch was not taken: both are still pending";
    pair.servo.take();
    pair.commit();  // learns of the take one publish late, so it carries both once more
    pair.servo.take();
    pair.commit();
    EXPECT_EQ(pair.table.batch_entries(), 0u);
}

TEST(Pending, a_batch_that_changes_everything_always_fits) {
    // Capacity is checked when something is added, so commit can never fail for lack of room.
    const ClaimCapacity small{.representations = 8, .batch_bytes = 900};
    Table table(small);
    std::vector<RepresentationId> ids;
    try {
        for (;;) ids.push_back(table.add(kind_of<Plane>, bytes_of(plane_at(0)), {}));
    } catch (const Error& error) {
        EXPECT_EQ(error.kind, Error::Kind::bad_parameters);
        EXPECT_NE(std::string(error.what()).find("ClaimOptions::representations"), std::string::npos)
            << error.what();
    }
    ASSERT_FALSE(ids.empty());
    for (const RepresentationId id : ids) table.set(id, bytes_of(plane_at(1)));
    EXPECT_LE(table.batch().size(), small.batch_bytes);
}

TEST(Pending, slots_run_out_with_a_line_that_says_what_to_ask_for) {
    Table table({.representations = 2, .batch_bytes = 4096});
    table.add(kind_of<Plane>, bytes_of(plane_at(0)), {});
    table.add(kind_of<Plane>, bytes_of(plane_at(0)), {});
    try {
        table.add(kind_of<Plane>, bytes_of(plane_at(0)), {});
        FAIL() << "a third one fitted two places";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("ClaimOptions::representations"), std::string::npos)
            << error.what();
    }
}

TEST(Pending, a_handle_of_an_earlier_generation_names_nothing) {
    Table table(capacity);
    const RepresentationId old = table.add(kind_of<Plane>, bytes_of(plane_at(1)), {});
    table.remove(old);
    const RepresentationId young = table.add(kind_of<Plane>, bytes_of(plane_at(2)), {});
    EXPECT_EQ(young.slot, old.slot) << "the case that matters";
    EXPECT_EQ(table.find(old), nullptr);
    EXPECT_NE(table.find(young), nullptr);
}

/// Bytes of parameters of the first entry of the next batch.
std::uint32_t next_bytes(Pair& pair) {
    protocol::EntryHeader entry;
    std::memcpy(&entry, pair.table.batch().data(), sizeof entry);
    return entry.bytes;
}

/// The parameters with one bit of a mantissa changed.
template <class R>
std::span<const std::byte> bytes_of(R& params, std::size_t changed) {
    const auto bytes = std::as_writable_bytes(std::span(&params, 1));
    bytes[changed] ^= std::byte{1};
    return bytes;
}

template <class R>
void moves_and_changes() {
    SCOPED_TRACE(Describe<R>::name);
    constexpr std::size_t geometry = geometry_bytes<R>(), whole = sizeof(R);
    Pair pair;
    R params{};
    const auto changed_geometry = [&] { return bytes_of(params, 0); };
    const auto changed_material = [&] { return bytes_of(params, whole - 1); };
    const RepresentationId id = pair.table.add(kind_of<R>, std::as_bytes(std::span(&params, 1)), {});
    pair.table.set(id, changed_geometry());
    EXPECT_EQ(next_bytes(pair), geometry);
    pair.table.set(id, changed_material());
    pair.table.set(id, changed_geometry());
    EXPECT_EQ(next_bytes(pair), whole);
    pair.commit();
    pair.table.set(id, changed_geometry());
    EXPECT_EQ(next_bytes(pair), whole) << "the batch before is not known to have been taken";
    pair.servo.take();
    pair.commit();
    pair.table.set(id, changed_geometry());
    EXPECT_EQ(next_bytes(pair), geometry) << "the servo has the rest";
    pair.table.refused();
    EXPECT_EQ(next_bytes(pair), whole) << "the servo has refused the rest";
}

template <class... R>
void every_kind_moves_and_changes(TypeList<R...>) {
    (moves_and_changes<R>(), ...);
}

TEST(Pending, of_any_kind_the_geometry_is_sent_alone_where_the_servo_has_the_rest) {
    every_kind_moves_and_changes(Representations{});
}

TEST(Pending, a_new_servo_gets_what_was_committed_and_keeps_what_was_not) {
    Table table(capacity);
    const RepresentationId id = table.add(kind_of<Plane>, bytes_of(plane_at(1)), {});
    table.find(id)->issued = true;
    table.set(id, bytes_of(plane_at(2)));
    table.committed_for_replay();
    table.set(id, bytes_of(plane_at(3)));
    table.restarted();
    ASSERT_EQ(table.issued(), std::vector{id});
    Plane replayed;
    std::memcpy(&replayed, table.find(id)->committed.data(), sizeof replayed);
    EXPECT_EQ(replayed.offset, 2);
    table.batch();
    EXPECT_EQ(table.batch_entries(), 1u) << "the change that no commit has covered yet is still to come";
}

}  // namespace

}  // namespace unit_pending_tests
