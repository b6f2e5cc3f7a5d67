#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include <knurl/client/asset.hpp>
#include <knurl/link/transport.hpp>

namespace knurl::detail {

class ClaimState;

class SendingState {
  public:
    SendingState(std::shared_ptr<ClaimState> claim, std::uint32_t number,
                 std::unique_ptr<AssetTransfer> transfer);
    ~SendingState();
    SendingState(const SendingState&) = delete;
    SendingState& operator=(const SendingState&) = delete;

    std::optional<SentShape> done(std::chrono::nanoseconds wait);
    int fd() const { return transfer_->event(); }

  private:
    std::shared_ptr<ClaimState> claim_;
    std::uint32_t number_;
    std::unique_ptr<AssetTransfer> transfer_;
    std::optional<SentShape> sent_;
    bool over_ = false;  // sent, or refused
};

}  // namespace knurl::detail
