// What a VRPN client sends, by TCP and by datagrams: any bytes. Nothing is read beyond them, each whole message is taken,
// what reaches the hand is what a servo takes, and what is answered is whole and bounded.
//
// The input is a list of pieces: what brings it (0: TCP, 1: a datagram, 2: time passes and reports come), its length, its
// bytes. After TCP pieces a rest waits, as in a connection.

#include <cmath>
#include <cstdint>
#include <vector>

#include <knurl/reps/describe.hpp>

#include "../../fuzz/require.hpp"
#include "../fakes.hpp"

using namespace vrpn_test;
using fuzz::require;

namespace {

void check_told(const Told& told) {
    require(told.items.size() <= 32 + 16 + 3, "what a client adds is bounded");
    for (const auto& [name, item] : told.items) {
        const Verdict verdict = check_added(item.kind, item.params.data(), item.params.size(), {});
        require(!!verdict, (name + ": " + describe(verdict, item.kind, "it")).c_str());
        if (!item.mesh) continue;
        for (const auto& triangle : item.mesh->triangles)
            for (const std::uint32_t vertex : triangle)
                require(vertex < item.mesh->vertices.size(), "a triangle names vertices that are there");
        for (const auto& vertex : item.mesh->vertices)
            for (const double part : vertex) require(std::isfinite(part), "a vertex is finite");
    }
}

void check_answers(FakeAround& around) {
    require(around.too_long == 0, "a datagram fits");
    require(around.got.size() < 100'000, "answers are bounded");
    around.got.clear();
    for (const std::string& line : around.lines) {
        require(!line.empty() && line.size() < 700, "what is said is short");
        for (const char c : line) require(c >= ' ' && c <= '~', "what is said is one line of text");
    }
    around.lines.clear();
    require(around.datagrams_to == 0 || (around.datagrams_to >= 1024 && around.datagrams_to <= 65535),
            "datagrams go to a port above 1023");
}

/// False: the client is dropped.
bool take(FakeClient& client, std::span<const std::byte>& bytes, Service service) {
    Message message;
    Split found = Split::more;
    for (std::size_t before = bytes.size(); (found = split(bytes, message)) == Split::whole;
         before = bytes.size()) {
        require(before - bytes.size() >= header_bytes, "each message takes bytes");
        require(message.payload.size() <= most_payload, "a payload is bounded");
        // Quick ones would be dropped; the service decides that, and no datagram drops a client.
        const std::string why = client.session.receive(message, service, client.now);
        require(service == Service::reliable || why.empty(), "no datagram ends a client");
        if (!why.empty()) return false;
    }
    client.session.received(client.now);
    return service == Service::quick || found != Split::bad;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    FakeClient client;
    require(read_cookie(cookie()).refused.empty(), "its own cookie");
    std::vector<std::byte> stream;
    std::size_t at = 0;
    while (at + 3 <= size) {
        const int way = data[at] % 3;
        const std::size_t length = std::min<std::size_t>(data[at + 1] * 256u + data[at + 2], size - at - 3);
        const std::span<const std::byte> piece = std::as_bytes(std::span(data + at + 3, length));
        at += 3 + length;
        static_cast<void>(requested_port(piece));
        if (way == 0) {
            stream.insert(stream.end(), piece.begin(), piece.end());
            std::span<const std::byte> rest(stream);
            if (!take(client, rest, Service::reliable)) break;
            stream.erase(stream.begin(), stream.end() - static_cast<std::ptrdiff_t>(rest.size()));
        } else if (way == 1) {
            std::span<const std::byte> rest = piece;
            take(client, rest, Service::quick);
        } else {
            client.now += std::chrono::milliseconds(25);
            HandReport report;
            report.read_ns = std::chrono::nanoseconds(client.now.time_since_epoch()).count();
            report.buttons = static_cast<std::uint32_t>(length);
            report.flags = length % 2 == 0 ? report_flags::touching : 0;
            client.session.report(0, std::span(&report, 1), client.now);
            client.session.tick(client.now);
        }
        check_told(client.around.told);
        check_answers(client.around);
    }
    return 0;
}
