#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>

#include <grp.h>
#include <poll.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/link/error.hpp>
#include <knurl/link/fork_guard.hpp>
#include <knurl/link/local.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/shm/socket.hpp>

namespace knurl::detail {

namespace {

using protocol::MessageType;
using protocol::put_text;
using protocol::text_of;

/// The socket exists and is not ours to open: whose is it, and what to do.
std::optional<std::string> forbidden(const std::string& path) {
    if (::access(path.c_str(), R_OK | W_OK) == 0 || errno != EACCES) return std::nullopt;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0)
        return detail::format(
            "not allowed to look into the folder of {}; run as its owner, or set KNURL_RUNTIME_DIR to "
            "the folder of your own servo",
            path);
    const passwd* owner = ::getpwuid(status.st_uid);
    const group* owners = ::getgrgid(status.st_gid);
    const std::string group_name = owners != nullptr ? owners->gr_name : std::to_string(status.st_gid);
    return detail::format(
        "not allowed to open {} (owner {}, group {}, mode {:o}); join the group (`sudo usermod -aG {} "
        "$USER`, then log in again) or start a servo of your own",
        path, owner != nullptr ? owner->pw_name : std::to_string(status.st_uid), group_name,
        status.st_mode & 0777u, group_name);
}

class LocalLink final : public Link {
  public:
    LocalLink(shm::UniqueFd socket, std::string servo, std::chrono::milliseconds answer_time)
        : socket_(std::move(socket)),
          lost_in_child_(socket_.get()),
          servo_(std::move(servo)),
          answer_time_(answer_time) {}

    void greet(const std::string& client_name) {
        protocol::Hello hello;
        hello.layout = protocol::wire_hash();
        put_text(hello.client, client_name);
        send(hello);
        auto [welcome, fds] = receive<protocol::Welcome>(MessageType::welcome, Error::Kind::incompatible);
        if (welcome.devices > protocol::max_devices || fds.size() != welcome.devices) nonsense();
        servo_pid_ = static_cast<pid_t>(welcome.servo_pid);
        for (const shm::UniqueFd& fd : fds) open_device(fd.get());
    }

    const std::vector<DeviceDescription>& devices() const override { return devices_; }
    pid_t servo_pid() const override { return servo_pid_; }
    int hang_up() const override { return socket_.get(); }
    std::string why_it_ended() override {
        return detail::format("servo '{}' has gone; start it again", servo_);
    }

    Attachment attach(std::uint32_t device, protocol::ClaimRequest request) override {
        request.device = device;
        if (request.observe != 0) request.capacity = {.representations = 0, .batch_bytes = 0};
        send(request);
        auto [claimed, fds] = receive<protocol::Claimed>(MessageType::claimed, Error::Kind::refused);
        if (fds.size() != 2) nonsense();
        // The layout is computed from what was granted, the size of the memory is checked against it.
        auto segment = std::make_shared<shm::Segment>(open(
            fds[0].get(), protocol::claim_layout(claimed.capacity).total, shm::Segment::Access::read_write));
        Attachment result{.terms = claimed,
                          .device = devices_[device],
                          .device_index = device,
                          .reports = {},
                          .channel = {}};
        result.reports = local_reports(segments_[device], segment, claimed.capacity, std::move(fds[1]));
        if (request.observe == 0) result.channel = local_channel(segment, claimed.capacity);
        return result;
    }

    void release(const Attachment& attachment) noexcept override {
        try {
            protocol::Release message;
            message.slot = attachment.terms.slot;
            message.device = attachment.device_index;
            shm::send_message(socket_, std::as_bytes(std::span(&message, 1)));
        } catch (const std::exception&) {
            // The servo has gone, and the claim with it.
        }
    }

  private:
    template <class Message>
    void send(const Message& message) {
        if (!shm::send_message(socket_, std::as_bytes(std::span(&message, 1)))) gone();
    }

    template <class Message>
    std::pair<Message, std::vector<shm::UniqueFd>> receive(MessageType expected, Error::Kind refusal) {
        pollfd ready{.fd = socket_.get(), .events = POLLIN, .revents = 0};
        int answers = 0;
        do {
            answers = ::poll(&ready, 1, static_cast<int>(answer_time_.count()));
        } while (answers < 0 && errno == EINTR);
        if (answers <= 0) {
            // A late answer must never be taken for the next request's: this connection is over.
            ::shutdown(socket_.get(), SHUT_RDWR);
            throw Error(Error::Kind::no_servo,
                        detail::format(
                            "servo '{}' does not answer (waited {} ms): is it stopped? `knurl ls` shows its "
                            "process",
                            servo_, answer_time_.count()));
        }
        alignas(8) std::array<std::byte, 4096> buffer{};
        shm::Received received = shm::receive_message(socket_, buffer, shm::Block::no);
        if (received.closed || received.nothing) gone();
        protocol::MessageHeader header;
        if (received.bytes < sizeof header) nonsense();
        std::memcpy(&header, buffer.data(), sizeof header);
        if (header.magic != protocol::attach_magic) nonsense();
        if (header.type == MessageType::refused && received.bytes >= sizeof(protocol::Refused)) {
            protocol::Refused refused;
            std::memcpy(&refused, buffer.data(), sizeof refused);
            throw Error(refused.holder_pid != 0 ? Error::Kind::device_held : refusal, text_of(refused.text),
                        static_cast<pid_t>(refused.holder_pid));
        }
        if (header.type != expected || received.bytes != sizeof(Message)) nonsense();
        Message message;
        std::memcpy(&message, buffer.data(), sizeof message);
        return {message, std::move(received.fds)};
    }

    void open_device(int fd) {
        auto segment = std::make_shared<const shm::Segment>(
            open(fd, protocol::device_layout().total, shm::Segment::Access::read_only));
        protocol::DeviceInfo info;
        std::memcpy(&info, segment->data(), sizeof info);
        if (info.magic != protocol::segment_magic || info.layout_hash != protocol::wire_hash()) nonsense();
        devices_.push_back(describe(info));
        segments_.push_back(std::move(segment));
    }

    shm::Segment open(int fd, std::size_t bytes, shm::Segment::Access access) const {
        try {
            return shm::Segment::open(fd, bytes, access);
        } catch (const std::exception& reason) {
            throw Error(
                Error::Kind::incompatible,
                detail::format("servo '{}': {}; build the application and the servo from the same version",
                               servo_, reason.what()));
        }
    }

    [[noreturn]] void gone() const {
        throw Error(Error::Kind::disconnected,
                    detail::format("servo '{}' has gone while it was asked; start it again", servo_));
    }
    [[noreturn]] void nonsense() const {
        throw Error(
            Error::Kind::incompatible,
            detail::format(
                "what answers as servo '{}' is not of this version (protocol {}, layout {:016x}); build "
                "the application and the servo from the same version",
                servo_, protocol::protocol_version, protocol::wire_hash()));
    }

    shm::UniqueFd socket_;
    LostInChild lost_in_child_;
    std::string servo_;
    std::chrono::milliseconds answer_time_;
    pid_t servo_pid_ = 0;
    std::vector<DeviceDescription> devices_;
    std::vector<std::shared_ptr<const shm::Segment>> segments_;
};

}  // namespace

std::unique_ptr<Link> connect_local(const std::string& servo, const std::string& client_name,
                                    std::chrono::milliseconds answer_time) {
    const std::string path = protocol::servo_socket(servo);
    if (const auto reason = forbidden(path)) throw Error(Error::Kind::permission, *reason);
    shm::UniqueFd socket;
    try {
        socket = shm::connect_to(path);
    } catch (const std::exception&) {
        throw Error(Error::Kind::no_servo,
                    detail::format("no servo '{}' listens at {}; start one with `knurld --name {} --device "
                                   "sim:premium15`, or see with `knurl ls` which ones run",
                                   servo, path, servo));
    }
    auto link = std::make_unique<LocalLink>(std::move(socket), servo, answer_time);
    link->greet(client_name);
    return link;
}

}  // namespace knurl::detail
