#include <fmt/format.h>

#include <knurl/client/client.hpp>
#include <knurl/gateway/inverse.hpp>

#include "inverse_id.hpp"
#include "inverse_service.hpp"

namespace knurl::gateway {

namespace {

/// Reads through the client library, which finds a servo again that has restarted.
class ObservedDevices final : public InverseSource {
  public:
    explicit ObservedDevices(std::string servo) : servo_(std::move(servo)) {}

    void look(TimePoint now) override {
        if (!client_ && now >= try_at_) connect(now);
        if (!client_) return;
        try {
            read();
        } catch (const Error& error) {
            lose(error.what(), now);
        }
    }
    std::span<const InverseDevice> devices() const override { return devices_; }
    const std::string& trouble() const override { return trouble_; }

  private:
    void connect(TimePoint now) {
        try_at_ = now + std::chrono::seconds(1);
        try {
            client_.emplace(Client::connect(
                servo_, {.name = "inverse", .wait = std::chrono::milliseconds(0), .hints = false}));
            list();
            trouble_.clear();
        } catch (const Error& error) {
            lose(error.what(), now);
        }
    }
    void list() {
        std::vector<DeviceDescription> found = client_->devices();
        observers_.clear();
        devices_.clear();
        InverseIds ids;
        for (DeviceDescription& info : found) {
            observers_.push_back(client_->observe(info.name));
            InverseDevice device;
            device.id = ids.of(info.name);
            device.grip_id = ids.of(info.name + "/grip");
            device.info = std::move(info);
            devices_.push_back(std::move(device));
        }
        servos_ = observers_.empty() ? 0 : observers_.front().reattachments();
    }
    void read() {
        // Another servo may have other devices under the same names.
        if (!observers_.empty() && observers_.front().connected() &&
            observers_.front().reattachments() != servos_)
            list();
        for (std::size_t i = 0; i < observers_.size(); ++i) {
            devices_[i].connected = observers_[i].connected();
            if (const auto report = observers_[i].latest()) devices_[i].report = *report;
        }
    }
    /// The devices stay listed, as not connected.
    void lose(const char* why, TimePoint now) {
        trouble_ = why;
        try_at_ = now + std::chrono::seconds(1);
        observers_.clear();
        client_.reset();
        for (InverseDevice& device : devices_) device.connected = false;
    }

    const std::string servo_;
    std::optional<Client> client_;
    std::vector<Observer> observers_;
    std::vector<InverseDevice> devices_;
    std::uint64_t servos_ = 0;
    TimePoint try_at_{};
    std::string trouble_ = "not connected yet";
};

}  // namespace

std::unique_ptr<InverseSource> observed_devices(const std::string& servo) {
    return std::make_unique<ObservedDevices>(servo);
}

Inverse make_inverse(InverseOptions options) {
    if (!options.source) options.source = observed_devices(options.servo);
    if (!options.make_hand)
        options.make_hand = [](PeerOptions peer) { return std::make_unique<PeerHand>(std::move(peer)); };
    return serve_inverse(std::move(options));
}

std::string InverseIds::of(const std::string& name) {
    std::uint32_t hash = 2166136261u;  // FNV-1a
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
    auto id = static_cast<std::uint16_t>(hash ^ hash >> 16);
    while (id == 0 || !taken_.insert(id).second) ++id;
    return fmt::format("{:04X}", id);
}

}  // namespace knurl::gateway
