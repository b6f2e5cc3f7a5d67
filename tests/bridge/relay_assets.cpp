// Meshes through a real bridge.

#include <cstring>
#include <map>
#include <optional>

#include <generators.hpp>

#include <knurl/protocol/asset.hpp>
#include <knurl/reps/shape.hpp>

#include "../refusal.hpp"
#include "relay_stranger.hpp"

namespace knurl::bridge::test {
namespace {

Triangles triangles_of(const knurl::test::MadeMesh& shape) {
    return {.vertices = shape.vertices, .triangles = shape.triangles, .materials = {}};
}

std::string refused(const auto& act) {
    return knurl::test::refusal_of<Error>(act);
}

/// The bytes that the library sends for that mesh.
std::vector<std::byte> source_of(const knurl::test::MadeMesh& shape) {
    protocol::AssetSource header;
    header.vertices = shape.vertices.size();
    header.triangles = shape.triangles.size();
    const auto layout = *protocol::layout_of(header);
    std::vector<std::byte> bytes(layout.total);
    std::memcpy(bytes.data(), &header, sizeof header);
    std::memcpy(bytes.data() + layout.vertices, shape.vertices.data(), 24 * shape.vertices.size());
    std::memcpy(bytes.data() + layout.triangles, shape.triangles.data(), 12 * shape.triangles.size());
    return bytes;
}

// A local and a remote application hold the device, each with the same ball that rises under the hand. In
// each cycle that both have seen, both have the same feedback, to the last bit.
TEST(Assets, a_mesh_is_felt_as_on_one_box) {
    const ServoUp servo;
    KeyRing ring;
    const std::string key = ring.add("anna", Role::control);
    BridgeProcess bridge({"--keys", ring.file()});
    Client far_client = connect_to(bridge, key), near_client = Client::connect("knurl:default");
    // Silence begins only after minutes. Otherwise a machine that stands still might fade only one of the
    // two.
    Claim far_hand = far_client.claim("", {.shared = true, .update_interval = 60s}),
          near_hand = near_client.claim("", {.shared = true, .update_interval = 60s});
    far_hand.arm();
    const Vec3 at = read_until(far_hand, is_active).position;
    Shape params{.position = {at.x + 0.003, at.y - 0.007, at.z - 0.105}, .stiffness = 200};
    Claim* const hands[] = {&far_hand, &near_hand};
    std::vector<Handle<Shape>> balls;
    for (Claim* hand : hands) {
        params.asset = hand->send(triangles_of(knurl::test::icosphere(5, 0.1))).asset;
        balls.push_back(hand->add(params));
        EXPECT_TRUE(hand->wait_applied(hand->commit(), 10s));
    }
    params.position.z = at.z - 0.0985;
    for (std::size_t i = 0; i < 2; ++i) {
        balls[i].set(params);
        EXPECT_TRUE(hands[i]->wait_applied(hands[i]->commit(), 10s));
    }
    // Some cycles later, when the shapes have come to rest.
    const std::uint64_t from = far_hand.latest()->cycle + 500;
    std::map<std::uint64_t, Vec3> felt[2];
    int both = 0;
    read_until(far_hand, [&](const HandReport&) {
        near_hand.commit();
        for (std::size_t i = 0; i < 2; ++i) {
            const auto now = balls[i].feedback();
            if (now && now->cycle >= from && (now->flags & Feedback::touching) != 0)
                felt[i][now->cycle] = now->force;
        }
        both = 0;
        for (const auto& [cycle, force] : felt[0]) both += felt[1].contains(cycle) ? 1 : 0;
        return both >= 100;
    });
    for (const auto& [cycle, force] : felt[0]) {
        const auto near_force = felt[1].find(cycle);
        if (near_force == felt[1].end()) continue;
        EXPECT_EQ(force.x, near_force->second.x) << cycle;
        EXPECT_EQ(force.y, near_force->second.y) << cycle;
        EXPECT_EQ(force.z, near_force->second.z) << cycle;
    }
}

struct Sent : testing::Test {
    const ServoUp servo;
    BridgeProcess bridge;
};

TEST_F(Sent, whoever_calls_it_off_while_it_travels_has_its_number_free_again) {
    Client client = connect_to(bridge);
    Claim hand = client.claim();
    const knurl::test::MadeMesh large = knurl::test::icosphere(7, 0.1),
                                small = knurl::test::icosphere(1, 0.1);
    for (int i = 0; i < 5; ++i) {
        Sending sending = hand.begin_sending(triangles_of(large));
        for (int reports = 0; reports < 3 * i; ++reports) hand.next_report(1s);
        if (const auto sent = sending.done()) hand.forget(sent->asset);  // if the machine stood still
    }
    // Several at once, more than may be under way: each gets through in its turn.
    std::vector<Sending> sendings;
    for (int i = 0; i < 10; ++i) sendings.push_back(hand.begin_sending(triangles_of(small)));
    for (std::uint32_t i = 0; i < 10; ++i) {
        const auto sent = sendings[i].done(60s);
        ASSERT_TRUE(sent);
        EXPECT_EQ(sent->asset, i + 1);
    }
}

TEST_F(Sent, a_bridge_that_was_killed_gets_it_again) {
    std::optional<BridgeProcess> first(std::in_place);
    const std::string at = first->host_and_port();
    Client client = connect_to(*first);
    Claim hand = client.claim();
    const SentShape sent = hand.send(triangles_of(knurl::test::icosphere(6, 0.1)));
    const Vec3 place = hand.device().workspace_centre;
    auto ball = hand.add(Shape{.asset = sent.asset, .position = {place.x, place.y, place.z - 0.2}});
    Sending cut = hand.begin_sending(triangles_of(knurl::test::icosphere(7, 0.1)));
    first.reset();
    EXPECT_NE(refused([&] {
                  while (!cut.done(60s)) {
                  }
              }),
              "accepted")
        << "who waits for one learns of it";
    const BridgeProcess second({"--anyone"}, at);
    ASSERT_TRUE(eventually([&] { return hand.reattachments() == 1 && hand.connected(); }));
    hand.arm();
    ball.set({.asset = sent.asset, .position = {place.x, place.y, place.z - 0.099}, .stiffness = 200});
    read_until(hand, [&](const HandReport& report) { return is_on(report) && report.scene_force.z > 0.02; });
    EXPECT_EQ(hand.send(triangles_of(knurl::test::icosphere(1, 0.1))).asset, 2u);
}

// 20 MB, nearly all of them vertices without a triangle: this tests the transfer, not the builder.
TEST_F(Sent, a_large_one_costs_nobody_a_report_nor_an_update) {
    constexpr double rate = 250;  // a busy machine's pauses fit into a socket's buffer
    Client client = connect_to(bridge, {}, rate), other = connect_to(bridge, {}, rate);
    Bystander bystander(bridge);
    Claim hand = client.claim("", {.shared = true});
    Observer observer = other.observe();
    knurl::test::MadeMesh large = knurl::test::icosphere(2, 0.1);
    const std::size_t corners = large.vertices.size();
    for (std::size_t i = corners; i < 850'000; ++i) large.vertices.push_back(large.vertices[i % corners]);
    ASSERT_TRUE(hand.next_report(10s) && observer.next_report(10s));
    Sending sending = hand.begin_sending(triangles_of(large));
    bystander.expect_well();
    std::uint64_t reports = 0, seen = 0;
    std::optional<SentShape> sent;
    while (!sent && reports < 60'000) {
        if (hand.next_report(1s)) ++reports;
        while (observer.next_report(0s)) ++seen;
        hand.commit();
        sent = sending.done();
    }
    ASSERT_TRUE(sent);
    EXPECT_EQ(sent->faces, large.triangles.size());
    EXPECT_GT(reports, 10u);
    EXPECT_GT(seen, 10u);
    EXPECT_EQ(hand.missed() + observer.missed(), 0u);
    EXPECT_EQ(hand.network().lost + observer.network().lost, 0u);
    EXPECT_EQ(hand.reattachments() + observer.reattachments(), 0u);
    EXPECT_TRUE(hand.wait_applied(hand.commit(), 10s));
}

/// A peer that speaks the protocol by itself, so that it can break it.
struct Stranger : Sent {
    Bystander bystander{bridge};
    std::optional<FrameStream> stream;

    std::uint32_t attach() {
        stream.emplace(dial(bridge), false);
        greet(*stream);
        Attach message;
        message.request.shared = 1;
        message.request.capacity = {.representations = 8, .batch_bytes = 1024};
        send(*stream, FrameType::attach, message);
        return await<Attached>(*stream, FrameType::attached).stream;
    }
    void offer(std::uint32_t id, std::uint64_t ticket, std::uint32_t number, std::uint64_t bytes) {
        send(*stream, FrameType::asset_offer, AssetOffer{.ticket = ticket, .bytes = bytes, .number = number},
             static_cast<std::uint16_t>(id));
    }
    void pieces(std::uint32_t id, std::uint64_t ticket, std::span<const std::byte> bytes,
                std::size_t begin = 0) {
        for (std::size_t at = begin; at < bytes.size(); at += asset_piece_bytes) {
            const AssetPiece header{.ticket = ticket, .offset = at};
            const std::array parts{bytes_of(header),
                                   bytes.subspan(at, std::min(asset_piece_bytes, bytes.size() - at))};
            while (!stream->send(static_cast<std::uint16_t>(FrameType::asset_piece),
                                 static_cast<std::uint16_t>(id), parts))
                if (await(*stream, FrameType::asset_taken).empty()) return;  // it has hung up
        }
    }
};

TEST_F(Stranger, half_a_mesh_and_no_more_harms_nobody) {
    const auto whole = source_of(knurl::test::icosphere(5, 0.1));
    const std::span<const std::byte> half = std::span(whole).first(4 * asset_piece_bytes);
    std::uint32_t id = attach();
    offer(id, 1, 1, whole.size());
    pieces(id, 1, half);
    bystander.expect_well();  // the stranger sends nothing more for now
    send(*stream, FrameType::asset_cancel, AssetTicket{.ticket = 1}, static_cast<std::uint16_t>(id));
    offer(id, 2, 1, whole.size());
    pieces(id, 2, half);
    stream.reset();  // it hangs up
    id = attach();
    offer(id, 1, 1, whole.size());
    pieces(id, 1, whole);
    EXPECT_EQ(await<AssetReady>(*stream, FrameType::asset_ready).ready.number, 1u);
    offer(id, 2, 1, whole.size());
    const auto why = await<AssetRefused>(*stream, FrameType::asset_refused);
    EXPECT_NE(text_of(why.refused.text).find("taken"), std::string::npos);
    bystander.expect_well();
}

TEST_F(Stranger, bytes_that_are_no_mesh_are_refused_and_the_connection_stays) {
    const std::uint32_t id = attach();
    auto bytes = source_of(knurl::test::icosphere(3, 0.1));
    std::uint64_t ticket = 0;
    const auto answer = [&](std::span<const std::byte> what) {
        offer(id, ++ticket, 1, what.size());
        pieces(id, ticket, what);
        return text_of(await<AssetRefused>(*stream, FrameType::asset_refused).refused.text);
    };
    EXPECT_NE(answer(std::span(bytes).first(40)).find("no mesh"), std::string::npos);
    EXPECT_NE(answer(std::span(bytes).first(bytes.size() - 4)).find("cut off"), std::string::npos);
    bytes[0] = std::byte{0};
    EXPECT_NE(answer(bytes).find("not made by this version"), std::string::npos);
    bystander.expect_well();
}

TEST_F(Stranger, pieces_of_no_sense_end_that_session_alone) {
    for (int which = 0; which < 4; ++which) {
        const std::uint32_t id = attach();
        offer(id, 1, 1, 3 * asset_piece_bytes - 1);  // incomplete before the piece that does not fit
        const std::vector<std::byte> bytes(4 * asset_piece_bytes);
        if (which == 0) pieces(id, 1, bytes);  // one too many
        if (which == 1) pieces(id, 1, bytes, asset_piece_bytes);
        if (which == 2) pieces(id, 2, bytes);
        if (which == 3) offer(id, 1, 2, 100);
        EXPECT_TRUE(ended(*stream)) << which;
        EXPECT_NE(bridge.line_with("out: "), "");
    }
    bystander.expect_well();
}

TEST(AssetRoles, whoever_may_claim_may_send_and_nobody_else) {
    const ServoUp servo;
    KeyRing ring;
    const std::string renders = ring.add("rene", Role::render), observes = ring.add("otto", Role::observe);
    BridgeProcess bridge({"--keys", ring.file()});
    Client client = connect_to(bridge, renders);
    Claim hand = client.claim("", {.shared = true});
    EXPECT_EQ(hand.send(triangles_of(knurl::test::icosphere(1, 0.1))).asset, 1u);
    FrameStream stream(dial(bridge), false,
                       TlsContext::client(read_keys(observes, KeysOf::application).front()));
    while (stream.pump() == FrameStream::State::handshaking) {
    }
    greet(stream);
    const std::uint32_t id = attach_observer(stream).stream;
    send(stream, FrameType::asset_offer, AssetOffer{.ticket = 1, .bytes = 100, .number = 1},
         static_cast<std::uint16_t>(id));
    EXPECT_TRUE(ended(stream));
}

}  // namespace
}  // namespace knurl::bridge::test
