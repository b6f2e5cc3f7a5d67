// Any messages of clients to the broker: greeting, claims, mapping, release, recording. Each request gets
// one answer, or the connection ends with a line. A client never holds more than it was granted, and all of
// it is free again once the client disconnects. A piece (pieces.hpp) is one message; its control byte has
// its type, and which parts are made valid.

#include <algorithm>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/servo/broker.hpp>
#include <knurl/shm/socket.hpp>

#include "../servo/puppet_device.hpp"
#include "pieces.hpp"
#include "refusal.hpp"

using namespace knurl;
using namespace knurl::servo;
using fuzz::require;
using protocol::MessageType;

namespace {

constexpr MessageType types[] = {MessageType::hello,   MessageType::claim,      MessageType::mapped,
                                 MessageType::release, MessageType::record,     MessageType::asset_forget,
                                 MessageType{},        MessageType::asset_offer};
constexpr unsigned type_mask = 7, right = 8, with_descriptor = 16, other_client = 32, unsealed = 64;
// The bits of a control are used up: who watches stands in for who records in every other piece.
constexpr unsigned watches = 128;
constexpr MessageType type_in(unsigned control) {
    const MessageType type = types[control & type_mask];
    if ((control & watches) == 0) return type;
    return type == MessageType::record         ? MessageType::watch
           : type == MessageType::asset_forget ? MessageType::show_asset
                                               : type;
}

/// The client's end of a connection, and what it has received.
struct Client {
    shm::UniqueFd socket;
    std::vector<std::pair<protocol::Claimed, shm::Segment>> claims;
    bool greeted = false, ended = false;
};

/// A servo with two devices and its broker, shared by all inputs.
class Door {
  public:
    Door() {
        address_.sun_family = AF_UNIX;
        const std::string name = "knurl-fuzz-" + std::to_string(::getpid());
        name.copy(address_.sun_path + 1, sizeof address_.sun_path - 2);
        shm::UniqueFd listener(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
        require(::bind(listener.get(), at(), sizeof address_) == 0 && ::listen(listener.get(), 8) == 0);
        sigset_t none;
        sigemptyset(&none);
        std::vector<HostedDevice> hosted;
        for (Station& station : stations_)
            hosted.push_back({.name = "hand",
                              .link = station.device.link(),
                              .servo = station.servo,
                              .segment = station.segment,
                              .rate = 1000,
                              .input_log = {}});
        broker_ = std::make_unique<Broker>(
            BrokerOptions{.servo_name = "fuzz",
                          .listener = std::move(listener),
                          .signals = shm::UniqueFd(::signalfd(-1, &none, SFD_CLOEXEC | SFD_NONBLOCK)),
                          .guardian_pidfd = -1,
                          .closer = closer_,
                          .deaths = deaths_,
                          .builder = "/bin/false"},
            std::move(hosted), waker_);
    }

    Client client() {
        Client made;
        made.socket = shm::UniqueFd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
        require(::connect(made.socket.get(), at(), sizeof address_) == 0, "a client connects");
        turn();
        return made;
    }

    /// Does all work that is due.
    void turn() {
        require(!broker_->turn(0), "the broker goes on");
        for (Station& station : stations_)
            if (station.clients() > 0) station.step();
    }

    /// The servo's own count of the clients of both devices.
    std::uint64_t clients() const {
        std::uint64_t held = 0;
        for (const Station& station : stations_) held += station.clients();
        return held;
    }

  private:
    struct Station {
        testing::PuppetDevice device;
        shm::Segment segment = shm::Segment::create("knurl-fuzz", protocol::device_layout().total);
        VirtualClock clock;
        Servo servo{device, clock, segment.data(), {}};

        void step() {
            clock.time += 1'000'000;
            servo.step(clock.time, clock.time);
        }
        std::uint64_t clients() const {
            const auto* rows = reinterpret_cast<const protocol::ClientRow*>(
                segment.data() + protocol::device_layout().clients);
            std::uint64_t held = 0;
            for (std::size_t i = 0; i < protocol::max_clients; ++i) held += rows[i].pid.load() != 0;
            return held;
        }
    };
    const sockaddr* at() const { return reinterpret_cast<const sockaddr*>(&address_); }

    sockaddr_un address_{};
    Station stations_[2];
    shm::Waker waker_;
    Closer closer_;
    DeathWatch deaths_;
    std::unique_ptr<Broker> broker_;
};

template <class Message>
Message overlaid(std::span<const std::byte> bytes) {
    Message message;
    if (!bytes.empty())
        std::memcpy(static_cast<void*>(&message), bytes.data(), std::min(bytes.size(), sizeof message));
    return message;
}

template <class Message>
std::vector<std::byte> bytes_of(const Message& message) {
    const auto bytes = std::as_bytes(std::span(&message, 1));
    return {bytes.begin(), bytes.end()};
}

/// A valid message of that type, with the values of `bytes` in the fields that a client may choose.
std::vector<std::byte> put_right(MessageType type, std::vector<std::byte> bytes, const Client& client) {
    const auto with = [&]<class Message>(Message message, auto change) {
        message.header = Message{}.header;
        change(message);
        return bytes_of(message);
    };
    switch (type) {
        case MessageType::hello:
            return with(overlaid<protocol::Hello>(bytes), [](protocol::Hello& hello) {
                hello.version = protocol::protocol_version;
                hello.layout = protocol::wire_hash();
            });
        case MessageType::claim:
            return with(overlaid<protocol::ClaimRequest>(bytes), [](protocol::ClaimRequest& claim) {
                claim.device %= 3;
                claim.observe %= 4;
                claim.shared &= 1;
                claim.capacity = {.representations = claim.capacity.representations % 16,
                                  .batch_bytes = claim.capacity.batch_bytes % 2048 / 8 * 8};
            });
        case MessageType::mapped:
            return with(overlaid<protocol::Mapped>(bytes), [&](protocol::Mapped& mapped) {
                if (!client.claims.empty()) mapped.key = client.claims.back().first.key;
            });
        case MessageType::release:
            return with(overlaid<protocol::Release>(bytes), [&](protocol::Release& release) {
                release.device &= 1;
                if (!client.claims.empty()) release.slot = client.claims.front().first.slot;
            });
        case MessageType::record:
            return with(overlaid<protocol::RecordRequest>(bytes),
                        [](protocol::RecordRequest& record) { record.device &= 1; });
        case MessageType::watch:
            return with(overlaid<protocol::WatchRequest>(bytes),
                        [](protocol::WatchRequest& watch) { watch.device &= 1; });
        case MessageType::show_asset:
            return with(overlaid<protocol::ShowAsset>(bytes), [](protocol::ShowAsset& show) {
                show.device &= 1;
                show.row %= 4;
                show.number %= 4;
            });
        case MessageType::asset_forget:
            return with(overlaid<protocol::AssetForget>(bytes), [&](protocol::AssetForget& forget) {
                if (!client.claims.empty()) forget.key = client.claims.back().first.key;
            });
        default:
            return bytes;
    }
}

/// Reads and checks the broker's answers.
void hear(Client& client, bool seals) {
    for (;;) {
        alignas(8) std::array<std::byte, 4096> buffer{};
        const shm::Received received = shm::receive_message(client.socket, buffer, shm::Block::no);
        if (received.nothing) return;
        client.ended = client.ended || received.closed;
        if (received.closed) return;
        const std::span<const std::byte> bytes(buffer.data(), received.bytes);
        std::uint32_t header[2];
        require(bytes.size() >= sizeof header && !received.truncated, "an answer has a head");
        std::memcpy(header, bytes.data(), sizeof header);
        require(header[0] == protocol::attach_magic, "an answer has the magic");
        const auto type = static_cast<MessageType>(header[1]);
        if (type == MessageType::refused) {
            require(bytes.size() == sizeof(protocol::Refused), "a refusal is whole");
            fuzz::check_refusal(protocol::text_of(overlaid<protocol::Refused>(bytes).text), "");
        } else if (type == MessageType::welcome) {
            require(!client.greeted && received.fds.size() == 2, "one welcome, with the devices");
            client.greeted = true;
        } else if (type == MessageType::claimed) {
            require(bytes.size() == sizeof(protocol::Claimed) && received.fds.size() == 2,
                    "a claim has its memory");
            const auto claimed = overlaid<protocol::Claimed>(bytes);
            require(claimed.slot < protocol::max_clients && claimed.frame.scale > 0, "a claim has its terms");
            shm::Segment segment =
                shm::Segment::open(received.fds[0].get(), protocol::claim_layout(claimed.capacity).total,
                                   shm::Segment::Access::read_write);
            if (seals) segment.seal_against_new_writers();
            client.claims.emplace_back(claimed, std::move(segment));
        } else {
            require(type == MessageType::serving || type == MessageType::recording ||
                        type == MessageType::watching,
                    "an answer is of a known type");
        }
        require(client.greeted || type == MessageType::refused, "who has not greeted is told nothing else");
    }
}

void say(Client& client, const fuzz::Pieces::Piece& piece) {
    std::vector<std::byte> bytes = piece.bytes;
    if ((piece.control & right) != 0) bytes = put_right(type_in(piece.control), std::move(bytes), client);
    if (bytes.empty()) return;
    const int descriptor = client.socket.get();
    shm::send_message(client.socket, bytes, {&descriptor, (piece.control & with_descriptor) != 0 ? 1u : 0u});
}

}  // namespace

/// The broker starts this program again as its closer.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    if (*argc > 1 && std::string((*argv)[1]) == close_descriptors_option) ::_exit(close_descriptors_main());
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Door& door = *new Door;
    {
        Client clients[2] = {door.client(), {}};
        fuzz::Pieces pieces({data, size});
        int turns = 0;
        for (fuzz::Pieces::Piece piece; pieces.next(piece) && turns < 32; ++turns) {
            Client& client = clients[(piece.control & other_client) != 0 ? 1 : 0];
            if (!client.socket) client = door.client();
            if (client.ended) continue;
            say(client, piece);
            door.turn();
            hear(client, (piece.control & unsealed) == 0);
        }
    }
    // Both clients have disconnected.
    for (int cycles = 0; cycles < 2000; ++cycles) {
        door.turn();
        if (cycles > 2 && door.clients() == 0) break;
    }
    require(door.clients() == 0, "what was granted comes back");
    return 0;
}
