// Any frames of a peer, admitted or not: greeting, attach, release, at the servo's end. Each valid attach
// gets one answer, no missing device is attached, all is released, and a peer that is closed is closed for a
// reason. Each frame has a control byte (what is corrected, its type) and two of length.

#include <cmath>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include <knurl/link/local.hpp>
#include <knurl/shm/waiter.hpp>

#include "../../fuzz/pieces.hpp"
#include "fake_claim.hpp"
#include "peer.hpp"

using namespace knurl;
using namespace knurl::bridge;

namespace {

constexpr unsigned good_hello = 1, good_device = 2, type_shift = 4;
constexpr FrameType types[] = {FrameType::hello,       FrameType::attach,       FrameType::release,
                               FrameType::commands,    FrameType::batch,        FrameType::welcome,
                               FrameType{0},           FrameType{999},          FrameType::asset_offer,
                               FrameType::asset_piece, FrameType::asset_cancel, FrameType::asset_forget,
                               FrameType::asset_taken, FrameType::asset_ready,  FrameType::asset_refused,
                               FrameType::asset_piece};
constexpr std::uint32_t device_count = 2;
std::size_t attached = 0;  // claims at the servo, of all connections

struct NoReports final : detail::ReportSource {
    bool next(Report&) noexcept override { return false; }
    std::size_t next_some(std::byte*, std::size_t, std::size_t) noexcept override { return 0; }
    bool latest(Report&) noexcept override { return false; }
    bool newest(Report&) const noexcept override { return false; }
    bool fresh() const noexcept override { return false; }
    std::uint64_t unread() const noexcept override { return 0; }
    std::uint64_t missed() const noexcept override { return 0; }
    void wait(std::chrono::nanoseconds) noexcept override {}
    void wait_cycle(std::chrono::nanoseconds) noexcept override {}
    int event() override { return -1; }
    void rearm() noexcept override {}
};

/// Takes assets, checks that they are whole and sealed, and never completes them.
struct FakeDoor final : detail::AssetDoor {
    struct Transfer final : detail::AssetTransfer {
        int event() const override { return never.get(); }
        std::optional<protocol::AssetReady> answer(std::chrono::nanoseconds) override { return std::nullopt; }
        shm::UniqueFd never = shm::make_event();
    };
    std::unique_ptr<detail::AssetTransfer> offer(std::uint32_t number, const shm::UniqueFd& source,
                                                 std::uint64_t bytes) override {
        fuzz::require(number >= 1 && number <= max_assets && bytes <= protocol::max_asset_bytes);
        constexpr int sealed = F_SEAL_WRITE | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
        fuzz::require(::fcntl(source.get(), F_GET_SEALS) == sealed &&
                      static_cast<std::uint64_t>(::lseek(source.get(), 0, SEEK_END)) == bytes);
        return std::make_unique<Transfer>();
    }
    void forget(std::uint32_t) override { fuzz::require(false); }
};

/// A servo that checks what a broker relies on, and refuses as a broker does.
struct FakeServo final : detail::Link {
    const std::vector<DeviceDescription> rows{device_count};
    const std::vector<DeviceDescription>& devices() const override { return rows; }
    pid_t servo_pid() const override { return 1; }
    int hang_up() const override { return -1; }
    std::string why_it_ended() override { return ""; }
    detail::Attachment attach(std::uint32_t device, protocol::ClaimRequest request) override {
        fuzz::require(device < device_count);
        const protocol::ClaimCapacity& asked = request.capacity;
        if (request.observe == 0 && (asked.representations < 1 || asked.representations > 1024 ||
                                     asked.batch_bytes > fuzz::batch_capacity))
            throw Error(Error::Kind::refused, "capacity");
        ++attached;
        detail::Attachment result;
        result.device_index = device;
        result.reports = std::make_shared<NoReports>();
        if (request.observe != 0) {
            result.terms.capacity = {.representations = 0, .batch_bytes = 0};
        } else {
            result.terms.capacity = asked;
            result.channel = std::make_unique<fuzz::FakeChannel>();
            result.assets = std::make_shared<FakeDoor>();
        }
        return result;
    }
    void release(const detail::Attachment&) noexcept override { --attached; }
};

struct Heard {
    std::size_t welcomed = 0, attached = 0, refused = 0;
};

/// What the peer received: whole frames of known types.
Heard listen(const shm::UniqueFd& theirs) {
    Heard heard;
    static std::vector<std::byte> all(1 << 20);
    std::size_t size = 0;
    for (ssize_t got = 0;
         (got = ::recv(theirs.get(), all.data() + size, all.size() - size, MSG_DONTWAIT)) > 0;)
        size += static_cast<std::size_t>(got);
    std::span<const std::byte> rest(all.data(), size);
    for (FrameHeader header; take(rest, header);) {
        fuzz::require(header.bytes > 0 && header.bytes <= rest.size());
        const auto type = static_cast<FrameType>(header.type);
        if (type == FrameType::welcome) ++heard.welcomed;
        if (type == FrameType::attached) ++heard.attached;
        if (type == FrameType::refused) {
            Refused refused;
            auto body = rest;
            fuzz::require(take(body, refused) && refused.text[0] != '\0');
            fuzz::require(std::strpbrk(text_of(refused.text).c_str(), "\n\r\x1b") == nullptr);
            ++heard.refused;
        }
        rest = rest.subspan(header.bytes);
    }
    return heard;
}

}  // namespace

std::unique_ptr<detail::Link> detail::connect_local(const std::string&, const std::string& name,
                                                    std::chrono::milliseconds) {
    fuzz::require(!name.empty() && name.size() < protocol::name_bytes);
    return std::make_unique<FakeServo>();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string servo = "default";
    ReportNotifier notifier;
    ServoErrands errands(0);
    auto out = std::make_unique<OutQueue>(-1);
    PeerContext context{.servo = servo, .keys = {}, .notifier = notifier, .out = *out, .errands = errands};
    notifier.open(ReportNotifier::attach(servo));
    const std::size_t before = attached;
    fuzz::Ends ends = fuzz::connected();
    Peer peer(std::move(ends.ours), {}, 7, {}, 0);
    std::size_t asked = 0;
    bool open = true;
    Heard heard;
    fuzz::Pieces frames({data, size});
    for (fuzz::Pieces::Piece piece; open && frames.next(piece);) {
        const FrameType type = types[piece.control >> type_shift & 15];
        std::vector<std::byte>& bytes = piece.bytes;
        if (type == FrameType::hello && (piece.control & good_hello) && bytes.size() >= sizeof(Hello)) {
            Hello hello;
            hello.layout = wire_hash();
            std::memcpy(bytes.data(), &hello, offsetof(Hello, client));
        }
        if (type == FrameType::attach && (piece.control & good_device) && bytes.size() >= sizeof(Attach)) {
            Attach attach;
            std::memcpy(static_cast<void*>(&attach), bytes.data(), sizeof attach);
            attach.request.device %= device_count;
            attach.report_rate = 0;
            std::memcpy(bytes.data(), &attach, sizeof attach);
        }
        const bool greeted = peer.greeted();
        const FrameHeader header{.bytes = static_cast<std::uint32_t>(bytes.size()),
                                 .type = static_cast<std::uint16_t>(type),
                                 .stream = static_cast<std::uint16_t>(piece.control >> 2 & 3)};
        ::send(ends.theirs.get(), &header, sizeof header, MSG_NOSIGNAL);
        ::send(ends.theirs.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
        open = peer.serve(context, 0);
        while (open && peer.servo_answered()) open = peer.go_on(context, 0);
        fuzz::require(open || !peer.why().empty());
        if (type == FrameType::attach && greeted && open) ++asked;
        const Heard more = listen(ends.theirs);
        heard.welcomed += more.welcomed;
        heard.attached += more.attached;
        heard.refused += more.refused;
        fuzz::require(attached - before <= max_streams);
        if (open) fuzz::require(heard.attached + heard.refused == asked && heard.welcomed == peer.greeted());
    }
    if (!open) fuzz::require(heard.welcomed <= 1);
    peer.close(context, Error::Kind::refused, peer.why());
    fuzz::require(attached == before);
    attached = 0;
    return 0;
}
