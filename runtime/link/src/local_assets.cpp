// Assets over a connection of their own (protocol/asset.hpp).

#include <poll.h>

#include <knurl/link/local.hpp>
#include <knurl/shm/deadline.hpp>

#include "conversation.hpp"

namespace knurl::detail {

namespace {

class LocalTransfer final : public AssetTransfer {
  public:
    explicit LocalTransfer(std::unique_ptr<Conversation> with) : with_(std::move(with)) {}
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
        return with_
            ->take<protocol::AssetReady>(protocol::MessageType::asset_ready, Error::Kind::bad_parameters)
            .first;
    }

  private:
    std::unique_ptr<Conversation> with_;
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
        return std::make_unique<LocalTransfer>(std::move(with));
    }
    void forget(std::uint32_t number) override {
        protocol::AssetForget message;
        message.device = device_;
        message.number = number;
        message.key = key_;
        greeted()->send(message);
    }

  private:
    std::unique_ptr<Conversation> greeted() const {
        auto with = std::make_unique<Conversation>(servo_, answer_time_);
        with->greet(client_);
        return with;
    }
    std::string servo_, client_;
    std::uint32_t device_;
    std::uint64_t key_;
    std::chrono::milliseconds answer_time_;  // until the broker says who it is
};

}  // namespace

std::shared_ptr<AssetDoor> local_assets(const std::string& servo, const std::string& client_name,
                                        std::uint32_t device, std::uint64_t key,
                                        std::chrono::milliseconds answer_time) {
    return std::make_shared<LocalAssets>(servo, client_name, device, key, answer_time);
}

}  // namespace knurl::detail
