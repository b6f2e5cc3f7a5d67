// The other process: peer SOCKET ROLE COUNT. Gets its segments over the socket, plays a client's part, and
// exits with 0 only if everything it saw was right.

#include "peer.hpp"

#include <array>
#include <cstdio>
#include <exception>
#include <string>
#include <thread>

#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

namespace {

using namespace knurl::shm;
using namespace knurl::shm::test;

struct Attached {
    Segment reports, claim;
    UniqueFd wake_fd;
};

Attached attach(const UniqueFd& socket) {
    std::array<std::byte, 16> buffer;
    Received received = receive_message(socket, buffer);
    if (received.fds.size() != 3) throw std::runtime_error("expected three descriptors");
    return {.reports = Segment::open(received.fds[0].get(), report_segment_bytes, Segment::Access::read_only),
            .claim = Segment::open(received.fds[1].get(), claim_segment_bytes, Segment::Access::read_write),
            .wake_fd = std::move(received.fds[2])};
}

/// Sleeps for each report; each must be whole, and the missed counted exactly.
bool read_reports(Attached& at, std::uint64_t count) {
    BroadcastReader reader(at.reports.data(), report_slots, sizeof(Report), 0);
    Waiter waiter(reinterpret_cast<WaiterFlag*>(at.claim.data() + flag_at), at.wake_fd.get(), reader);
    std::uint64_t got = 0;
    while (reader.position() < count) {
        if (!waiter.wait(std::chrono::seconds(20))) return false;
        Report report;
        while (reader.next(&report)) {
            ++got;
            if (!report.is(reader.position() - 1)) return false;
        }
    }
    return got + reader.missed() == count;
}

/// Sends each command back as its reply.
bool echo_commands(Attached& at, std::uint64_t count) {
    SpscConsumer commands(at.claim.data() + commands_at, ring_cells);
    SpscProducer replies(at.claim.data() + replies_at, ring_cells);
    for (std::uint64_t n = 0; n < count;) {
        if (commands.available() == 0) {
            std::this_thread::yield();
            continue;
        }
        Cell cell;
        if (!commands.peek(0, &cell, 1) || !cell.is(n)) return false;
        while (!replies.try_push(&cell, 1)) std::this_thread::yield();
        commands.pop(1);
        ++n;
    }
    return true;
}

bool publish_batches(Attached& at, std::uint64_t count) {
    TripleWriter writer(at.claim.data() + batches_at, sizeof(Batch));
    for (std::uint64_t n = 1; n <= count; ++n) {
        const Batch batch = Batch::numbered(n);
        writer.publish(&batch, sizeof batch, n);
    }
    return !writer.corrupt();
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 4) return 2;
    const UniqueFd socket = connect_to(argv[1]);
    Attached at = attach(socket);
    const std::string role = argv[2];
    const std::uint64_t count = std::stoull(argv[3]);
    const bool right = role == "reports"   ? read_reports(at, count)
                       : role == "echo"    ? echo_commands(at, count)
                       : role == "batches" ? publish_batches(at, count)
                                           : false;
    return right ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "peer: %s\n", error.what());
    return 3;
}
