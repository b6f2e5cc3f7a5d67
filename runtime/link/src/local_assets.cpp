// Assets use a connection of their own (protocol/asset.hpp).

#include <array>

#include <poll.h>
#include <sys/socket.h>

#include <knurl/link/fork_guard.hpp>
#include <knurl/link/local.hpp>
#include <knurl/shm/deadline.hpp>

#include "conversation.hpp"

namespace knurl::detail {

namespace {

class LocalTransfer final : public AssetTransfer {
  public:
    LocalTransfer(std::unique_ptr<Conversation> with, const protocol::AssetForget& undo)
        : with_(std::move(with)), undo_(undo) {}
    /// Cancels the transfer, unless it is answered. The servo may be answering "ready" at this moment. So it
    /// is told on the same connection to forget the asset, and then the connection closes. Arrived messages
    /// are read first, since closing with unread data would discard what was sent.
    ~LocalTransfer() override {
        if (answered_ || fork_generation() != made_in_) return;
        try {
            with_->send(undo_);
            ::shutdown(with_->socket(), SHUT_RDWR);
            std::array<std::byte, 4096> unread;
            while (::recv(with_->socket(), unread.data(), unread.size(), MSG_DONTWAIT) > 0) {
            }
        } catch (const std::exception&) {  // the servo has closed it first
        }
    }
    int event() const override { return with_->socket(); }
    std::optional<protocol::AssetReady> answer(std::chrono::nanoseconds timeout) override {
        const auto deadline = shm::deadline_after(timeout);
        pollfd ready{.fd = with_->socket(), .events = POLLIN, .revents = 0};
        for (;;) {
            const auto left = deadline - std::chrono::steady_clock::now();
            const auto ms = std::chrono::ceil<std::chrono::milliseconds>(std::clamp<std::chrono::nanoseconds>(
                left, std::chrono::nanoseconds(0), std::chrono::hours(1)));
            const int answers = ::poll(&ready, 1, static_cast<int>(ms.count()));
            if (answers > 0) break;
            if (left <= std::chrono::nanoseconds(0)) return std::nullopt;
        }
        answered_ = true;
        return with_
            ->take<protocol::AssetReady>(protocol::MessageType::asset_ready, Error::Kind::bad_parameters)
            .first;
    }

  private:
    const std::uint64_t made_in_ = fork_generation();
    std::unique_ptr<Conversation> with_;
    const protocol::AssetForget undo_;
    bool answered_ = false;
};

class LocalAssets final : public AssetDoor {
  public:
    LocalAssets(std::string servo, std::string client, std::uint32_t device, std::uint64_t key,
                std::chrono::milliseconds answer_time)
        : servo_(std::move(servo)),
          client_(std::move(client)),
          device_(device),
          key_(key),
          answer_time_(answer_time) {}

    std::unique_ptr<AssetTransfer> offer(std::uint32_t number, const shm::UniqueFd& source,
                                         std::uint64_t bytes) override {
        auto with = greeted();
        protocol::AssetOffer message;
        message.device = device_;
        message.number = number;
        message.key = key_;
        message.bytes = bytes;
        const int fd = source.get();
        with->send(message, {&fd, 1});
        return std::make_unique<LocalTransfer>(std::move(with), forgetting(number));
    }
    void forget(std::uint32_t number) override { greeted()->send(forgetting(number)); }

  private:
    protocol::AssetForget forgetting(std::uint32_t number) const {
        protocol::AssetForget message;
        message.device = device_;
        message.number = number;
        message.key = key_;
        return message;
    }
    std::unique_ptr<Conversation> greeted() const {
        auto with = std::make_unique<Conversation>(servo_, answer_time_);
        with->greet(client_);
        return with;
    }
    std::string servo_, client_;
    std::uint32_t device_;
    std::uint64_t key_;
    std::chrono::milliseconds answer_time_;  // for the broker's greeting
};

}  // namespace

std::shared_ptr<AssetDoor> local_assets(const std::string& servo, const std::string& client_name,
                                        std::uint32_t device, std::uint64_t key,
                                        std::chrono::milliseconds answer_time) {
    return std::make_shared<LocalAssets>(servo, client_name, device, key, answer_time);
}

}  // namespace knurl::detail
