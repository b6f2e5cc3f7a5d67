// Anything that an application may write into its claim's memory while the servo reads it: bytes anywhere,
// commands and batches, raw or well-formed. Reports stay finite, forces are within the device's limits, and
// the claim can be taken back. A piece (pieces.hpp) is one action of the application, before each cycle.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include <knurl/reps/all.hpp>
#include <knurl/servo/offline.hpp>

#include "../servo/puppet_device.hpp"
#include "pieces.hpp"
#include "require.hpp"

using namespace knurl;
using namespace knurl::servo;
using fuzz::require;

namespace {

constexpr protocol::ClaimCapacity capacity{.representations = 8, .batch_bytes = 1024};
constexpr Nanoseconds period = 1'000'000;
enum Act : unsigned { spoil, raw_command, command, raw_batch, batch, idle, listen, arm };

/// Takes values from the front of a piece, and zeros after its end.
class Values {
  public:
    explicit Values(std::span<const std::byte> bytes) : rest_(bytes) {}
    template <class T>
    T next() {
        T value{};
        take(&value, sizeof value);
        return value;
    }
    void take(void* to, std::size_t bytes) {
        const std::size_t there = std::min(bytes, rest_.size());
        if (there > 0) std::memcpy(to, rest_.data(), there);
        rest_ = rest_.subspan(there);
    }
    std::span<const std::byte> rest() const { return rest_; }

  private:
    std::span<const std::byte> rest_;
};

/// One servo for all inputs; each input has claims of its own.
struct Rig {
    testing::PuppetDevice device;
    OfflineMemory segment{protocol::device_layout().total};
    VirtualClock clock;
    Servo servo{device, clock, segment.data(), {}};

    const Report& step() {
        clock.time += period;
        servo.step(clock.time, clock.time);
        const Report& report = servo.last();
        for (const Vec3& v : {report.scene_force, report.sent_force, report.sent_torque, report.position})
            require(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z), "a report is finite");
        require(to_eigen(report.sent_force).norm() <= device.link().peak_force * (1 + 1e-12),
                "the force is within the device's limit");
        return report;
    }
};

class Application {
  public:
    Application(OfflineClaim& claim, Rig& rig)
        : claim_(claim),
          rig_(rig),
          commands_(claim.memory() + claim.layout().commands, claim.layout().command_cells),
          batches_(claim.memory() + claim.layout().batches, claim.layout().batch_slot_bytes) {}

    void act(const fuzz::Pieces::Piece& piece) {
        Values values(piece.bytes);
        switch (piece.control & 7) {
            case spoil: {
                const std::size_t at = values.next<std::uint32_t>() % claim_.layout().total;
                const auto bytes =
                    values.rest().first(std::min(values.rest().size(), claim_.layout().total - at));
                if (!bytes.empty()) std::memcpy(claim_.memory() + at, bytes.data(), bytes.size());
                break;
            }
            case raw_command: {
                std::vector<std::byte> cells((piece.bytes.size() / shm::cell_bytes + 1) * shm::cell_bytes);
                values.take(cells.data(), cells.size());
                commands_.try_push(cells.data(), static_cast<std::uint32_t>(cells.size() / shm::cell_bytes));
                break;
            }
            case command:
                push(piece.control, values);
                break;
            case raw_batch:
                batches_.publish(piece.bytes.data(),
                                 std::min(piece.bytes.size() / 8 * 8, claim_.layout().batch_slot_bytes));
                break;
            case batch:
                publish(values);
                break;
            case listen:
                hear();
                break;
            case arm:
                claim_.arm();
                break;
            default:
                for (unsigned cycles = piece.control >> 3; cycles > 0; --cycles) rig_.step();
        }
    }

  private:
    /// A well-formed command: valid length and number, a kind and a slot that exist.
    void push(unsigned control, Values& values) {
        using protocol::CommandType;
        const auto type = static_cast<CommandType>(1 + (control >> 3) % 6);
        std::array<std::byte, 2048> bytes{};
        std::size_t size = sizeof(protocol::CommandHeader), params = 0;
        const auto put = [&](const auto& part) {
            std::memcpy(bytes.data() + size, &part, sizeof part);
            size += sizeof part;
        };
        if (type == CommandType::add) {
            auto body = values.next<protocol::AddBody>();
            body.kind %= static_cast<Kind>(Representations::size);
            body.id.slot %= capacity.representations;
            put(body);
            params = kinds()[body.kind].size;
            values.take(bytes.data() + size, params);
        } else if (type == CommandType::remove) {
            auto body = values.next<protocol::RemoveBody>();
            body.id.slot %= capacity.representations;
            put(body);
        } else if (type == CommandType::place_probe) {
            put(values.next<protocol::PlaceProbeBody>());
        }
        const auto cells =
            static_cast<std::uint32_t>((size + params + shm::cell_bytes - 1) / shm::cell_bytes);
        const protocol::CommandHeader header{.cells = cells,
                                             .type = type,
                                             .number = ++number_,
                                             .flags = control >> 6 & protocol::command_flags::all,
                                             .bytes = static_cast<std::uint32_t>(params)};
        std::memcpy(bytes.data(), &header, sizeof header);
        commands_.try_push(bytes.data(), cells);
    }

    /// A batch of well-formed entries.
    void publish(Values& values) {
        std::vector<std::byte> bytes(sizeof(protocol::BatchHeader));
        protocol::BatchHeader header{.sequence = ++sequence_};
        while (!values.rest().empty()) {
            protocol::EntryHeader entry{
                .id = values.next<RepresentationId>(),
                .kind = static_cast<Kind>(values.next<std::uint8_t>() % Representations::size),
                .version = ++version_};
            entry.id.slot %= capacity.representations;
            entry.bytes = static_cast<std::uint32_t>(kinds()[entry.kind].size);
            const std::size_t at = bytes.size();
            if (at + sizeof entry + entry.bytes + 8 > claim_.layout().batch_slot_bytes) break;
            bytes.resize(at + sizeof entry + (entry.bytes + 7u) / 8 * 8);
            std::memcpy(bytes.data() + at, &entry, sizeof entry);
            values.take(bytes.data() + at + sizeof entry, entry.bytes);
            ++header.entries;
        }
        header.bytes = static_cast<std::uint32_t>(bytes.size() - sizeof header);
        std::memcpy(bytes.data(), &header, sizeof header);
        batches_.publish(bytes.data(), bytes.size());
    }

    /// Reads as the library does, which trusts the servo but none of the memory.
    void hear() {
        shm::SpscConsumer replies(claim_.memory() + claim_.layout().replies, protocol::reply_cells);
        protocol::Reply reply;
        for (std::uint32_t left = replies.available(); left > 0; --left) {
            replies.peek(0, &reply, 1);
            replies.pop(1);
        }
        shm::TripleReader feedback(claim_.memory() + claim_.layout().feedback,
                                   claim_.layout().feedback_slot_bytes);
        if (!feedback.take()) return;
        protocol::FeedbackHeader header;
        feedback.copy(&header, 0, sizeof header);
    }

    OfflineClaim& claim_;
    Rig& rig_;
    shm::SpscProducer commands_;
    shm::TripleWriter batches_;
    std::uint64_t number_ = 0, sequence_ = 0, version_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Rig& rig = *new Rig;
    static OfflineMemory& memory = *new OfflineMemory(protocol::claim_layout(capacity).total);
    ClaimTerms terms;
    terms.capacity = capacity;
    terms.limits = limits_for(rig.device.link(), 1000, terms.frame);
    OfflineClaim claim(terms, memory.data(), nullptr);
    require(rig.servo.adopt(&claim.servo_side()), "the servo takes a claim");
    Application application(claim, rig);
    fuzz::Pieces pieces({data, size});
    int turn = 0;
    for (fuzz::Pieces::Piece piece; pieces.next(piece) && turn < 64; ++turn) {
        application.act(piece);
        rig.device.tip = 0.02 * Eigen::Vector3d(std::sin(turn), std::cos(turn), std::sin(2 * turn));
        rig.step();
    }
    require(rig.servo.drop(&claim.servo_side()), "the servo is asked for a claim");
    const Claim* back = nullptr;
    for (int cycles = 0; back == nullptr && cycles < 2000; ++cycles) {
        rig.step();
        back = rig.servo.released();
    }
    require(back == &claim.servo_side(), "a claim comes back");
    return 0;
}
