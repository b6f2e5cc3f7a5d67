// The three classes of the link interface, over a Connection and its streams.

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <poll.h>

#include <knurl/bridge/remote.hpp>
#include <knurl/link/fork_guard.hpp>
#include <knurl/link/text.hpp>
#include <knurl/shm/waiter.hpp>

#include "connection.hpp"
#include "stream.hpp"

namespace knurl::bridge {

namespace {

class RemoteReports final : public detail::ReportSource {
  public:
    explicit RemoteReports(std::shared_ptr<Stream> stream) : stream_(std::move(stream)) {}

    bool next(Report& out) noexcept override { return stream_->next(out); }
    std::size_t next_some(std::byte* out, std::size_t, std::size_t most) noexcept override {
        // One by one, since any of them may have a gap before it.
        Report report;
        if (most == 0 || !stream_->next(report)) return 0;
        std::memcpy(out, &report, sizeof report);
        return 1;
    }
    bool latest(Report& out) noexcept override { return stream_->latest(out); }
    bool newest(Report& out) const noexcept override { return stream_->newest(out); }
    bool fresh() const noexcept override { return stream_->fresh(); }
    std::uint64_t unread() const noexcept override { return stream_->unread(); }
    std::uint64_t missed() const noexcept override { return stream_->missed(); }
    void wait(std::chrono::nanoseconds timeout) noexcept override { stream_->wait(timeout, false); }
    void wait_cycle(std::chrono::nanoseconds timeout) noexcept override { stream_->wait(timeout, true); }
    int event() override { return stream_->event(); }
    void rearm() noexcept override { stream_->rearm(); }
    Network network() const noexcept override { return stream_->network(); }

    std::uint32_t stream() const { return stream_->id(); }

  private:
    std::shared_ptr<Stream> stream_;
};

class RemoteChannel final : public detail::ClaimChannel {
  public:
    explicit RemoteChannel(std::shared_ptr<Stream> stream) : stream_(std::move(stream)) {}

    bool push(const void* commands, std::uint32_t cells) noexcept override {
        return stream_->push(commands, cells);
    }
    std::uint32_t command_cells() const noexcept override { return stream_->command_cells(); }
    bool reply(protocol::Reply& out) noexcept override { return stream_->reply(out); }
    bool publish(const protocol::BatchHeader& header, std::span<const std::byte> entries) noexcept override {
        return stream_->publish(header, entries);
    }
    bool feedback(protocol::FeedbackHeader& header, std::vector<protocol::FeedbackEntry>& entries) override {
        return stream_->feedback(header, entries);
    }

  private:
    std::shared_ptr<Stream> stream_;
};

class RemoteTransfer final : public detail::AssetTransfer {
  public:
    RemoteTransfer(std::shared_ptr<Connection> connection, std::shared_ptr<Connection::Parcel> parcel)
        : connection_(std::move(connection)), parcel_(std::move(parcel)) {}
    ~RemoteTransfer() override {
        if (detail::fork_generation() == made_in_) connection_->withdraw_asset(*parcel_);
    }
    int event() const override { return parcel_->event.get(); }
    std::optional<protocol::AssetReady> answer(std::chrono::nanoseconds timeout) override {
        detail::require_own(made_in_);
        pollfd raised{.fd = event(), .events = POLLIN, .revents = 0};
        shm::poll_until({&raised, 1}, shm::deadline_after(timeout));
        return connection_->asset_answer(*parcel_);
    }

  private:
    const std::uint64_t made_in_ = detail::fork_generation();
    std::shared_ptr<Connection> connection_;
    std::shared_ptr<Connection::Parcel> parcel_;
};

class RemoteAssets final : public detail::AssetDoor {
  public:
    RemoteAssets(std::shared_ptr<Connection> connection, std::uint32_t stream)
        : connection_(std::move(connection)), stream_(stream) {}
    std::unique_ptr<detail::AssetTransfer> offer(std::uint32_t number, const shm::UniqueFd& source,
                                                 std::uint64_t bytes) override {
        return std::make_unique<RemoteTransfer>(connection_,
                                                connection_->offer_asset(stream_, number, source, bytes));
    }
    void forget(std::uint32_t number) override { connection_->forget_asset(stream_, number); }

  private:
    std::shared_ptr<Connection> connection_;
    std::uint32_t stream_;
};

class RemoteLink final : public detail::Link {
  public:
    RemoteLink(const Endpoint& bridge, const RemoteOptions& options)
        : connection_(std::make_shared<Connection>(bridge, options)) {
        connection_->start();
    }
    ~RemoteLink() override { connection_->stop(); }

    const std::vector<DeviceDescription>& devices() const override { return connection_->devices(); }
    pid_t servo_pid() const override { return connection_->servo_pid(); }
    int hang_up() const override { return connection_->hang_up(); }
    std::string why_it_ended() override { return connection_->why_it_ended(); }

    detail::Attachment attach(std::uint32_t device, protocol::ClaimRequest request) override {
        if (request.observe == protocol::observe_and_reset)
            throw Error(
                Error::Kind::refused,
                "a fault is reset on the servo's own host: run `knurl reset` there, or claim the device "
                "with a key of role control and call Claim::reset_fault()");
        if (request.observe != 0) request.capacity = {.representations = 0, .batch_bytes = 0};
        const auto [stream, terms] = connection_->attach(device, request);
        detail::Attachment result{.terms = terms,
                                  .device = connection_->devices()[device],
                                  .device_index = device,
                                  .reports = std::make_shared<RemoteReports>(stream),
                                  .channel = {},
                                  .assets = {}};
        if (request.observe == 0) {
            result.channel = std::make_unique<RemoteChannel>(stream);
            result.assets = std::make_shared<RemoteAssets>(connection_, stream->id());
        }
        return result;
    }

    void release(const detail::Attachment& attachment) noexcept override {
        connection_->release(static_cast<const RemoteReports&>(*attachment.reports).stream());
    }

  private:
    std::shared_ptr<Connection> connection_;
};

}  // namespace

std::unique_ptr<detail::Link> connect_remote(std::span<const Endpoint> bridge, const RemoteOptions& options) {
    std::vector<std::string> reasons, tried;
    std::optional<Error::Kind> kind;
    for (const Endpoint& each : bridge) {
        try {
            return std::make_unique<RemoteLink>(each, options);
        } catch (const Error& error) {
            if (bridge.size() == 1 || error.kind == Error::Kind::permission) throw;
            // Trying again is worthwhile while a bridge may appear at one of these addresses.
            const bool passes =
                error.kind == Error::Kind::no_servo || error.kind == Error::Kind::disconnected;
            if (!kind || passes) kind = error.kind;
            tried.push_back(numeric(each.address));
            if (std::find(reasons.begin(), reasons.end(), error.what()) == reasons.end())
                reasons.emplace_back(error.what());
        }
    }
    throw Error(kind.value_or(Error::Kind::no_servo),
                detail::format("{} (tried {} addresses: {})", fmt::join(reasons, "; and "), tried.size(),
                               fmt::join(tried, ", ")));
}

}  // namespace knurl::bridge
