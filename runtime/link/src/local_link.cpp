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

#include "conversation.hpp"

namespace knurl::detail {

namespace {

using protocol::MessageType;

class LocalLink final : public Link {
  public:
    LocalLink(const std::string& servo, const std::string& client_name, std::chrono::milliseconds answer_time)
        : with_(servo, answer_time), client_name_(client_name) {
        auto [welcome, fds] = with_.greet(client_name);
        servo_pid_ = static_cast<pid_t>(welcome.servo_pid);
        for (const shm::UniqueFd& fd : fds) open_device(fd.get());
    }

    const std::vector<DeviceDescription>& devices() const override { return devices_; }
    pid_t servo_pid() const override { return servo_pid_; }
    int hang_up() const override { return with_.socket(); }
    std::string why_it_ended() override {
        return detail::format("servo '{}' has gone; start it again", with_.servo());
    }

    Attachment attach(std::uint32_t device, protocol::ClaimRequest request) override {
        request.device = device;
        if (request.observe == protocol::observe_only)
            request.capacity = {.representations = 0, .batch_bytes = 0};
        auto [claimed, segment, wake_fd] = served(request);
        Attachment result{.terms = claimed,
                          .device = devices_[device],
                          .device_index = device,
                          .reports = {},
                          .channel = {},
                          .assets = {}};
        result.reports = local_reports(segments_[device], segment, claimed.capacity, std::move(wake_fd));
        if (request.observe != protocol::observe_only)
            result.channel = local_channel(segment, claimed.capacity);
        if (request.observe == 0) {
            result.assets =
                local_assets(with_.servo(), client_name_, device, claimed.key, with_.answer_time());
        }
        return result;
    }

    void release(const Attachment& attachment) noexcept override {
        try {
            protocol::Release message;
            message.slot = attachment.terms.slot;
            message.device = attachment.device_index;
            with_.send(message);
        } catch (const std::exception&) {
            // The servo is gone, and the claim with it.
        }
    }

  private:
    void open_device(int fd) {
        auto segment = std::make_shared<const shm::Segment>(
            open(fd, protocol::device_layout().total, shm::Segment::Access::read_only));
        protocol::DeviceInfo info;
        std::memcpy(&info, segment->data(), sizeof info);
        if (info.magic != protocol::segment_magic || info.layout_hash != protocol::wire_hash())
            with_.nonsense();
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
                               with_.servo(), reason.what()));
        }
    }

    struct Granted {
        protocol::Claimed terms;
        std::shared_ptr<shm::Segment> segment;
        shm::UniqueFd wake_fd;
    };

    /// A claim that is mapped on both sides, and that the servo serves.
    Granted served(const protocol::ClaimRequest& request) {
        // The kernel itself may take a page away for a moment (swapping, NUMA balancing), which the servo
        // cannot tell from an attack.
        constexpr int attempts = 3;
        for (int attempt = 1;; ++attempt) {
            Granted granted = grant(request);
            protocol::Mapped mapped;
            mapped.key = granted.terms.key;
            with_.send(mapped);
            try {
                with_.receive<protocol::Serving>(MessageType::serving, Error::Kind::refused);
                return granted;
            } catch (const Error& error) {
                if (error.kind != Error::Kind::refused || attempt == attempts) throw;
            }
        }
    }

    Granted grant(const protocol::ClaimRequest& request) {
        with_.send(request);
        auto [claimed, fds] = with_.receive<protocol::Claimed>(MessageType::claimed, Error::Kind::refused);
        if (fds.size() != 2) with_.nonsense();
        // The layout follows from what was granted; the size of the memory is checked against it.
        Granted granted{.terms = claimed,
                        .segment = std::make_shared<shm::Segment>(
                            open(fds[0].get(), protocol::claim_layout(claimed.capacity).total,
                                 shm::Segment::Access::read_write)),
                        .wake_fd = std::move(fds[1])};
        seal(*granted.segment);
        return granted;
    }

    /// The servo serves nothing whose pages could still be taken away.
    void seal(shm::Segment& mapped) const {
        try {
            mapped.seal_against_new_writers();
        } catch (const std::exception& reason) {
            throw Error(Error::Kind::exhausted,
                        detail::format("servo '{}': {}", with_.servo(), reason.what()));
        }
    }

    Conversation with_;
    std::string client_name_;
    pid_t servo_pid_ = 0;
    std::vector<DeviceDescription> devices_;
    std::vector<std::shared_ptr<const shm::Segment>> segments_;
};

}  // namespace

std::unique_ptr<Link> connect_local(const std::string& servo, const std::string& client_name,
                                    std::chrono::milliseconds answer_time) {
    return std::make_unique<LocalLink>(servo, client_name, answer_time);
}

}  // namespace knurl::detail
