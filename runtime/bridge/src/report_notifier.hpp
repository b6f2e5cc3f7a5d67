#pragma once
// The bridge's own observer of each device. The servo wakes only this one, whatever the number of peers, and
// only while a stream is open.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <knurl/link/local.hpp>

namespace knurl::bridge {

inline constexpr std::chrono::milliseconds servo_answer_time{500};

class ReportNotifier {
  public:
    /// One that is attached to each device.
    struct Observers {
        std::unique_ptr<detail::Link> link;
        std::vector<detail::Attachment> devices;
    };
    /// Waits for the servo's answers; throws Error.
    static Observers attach(const std::string& servo);

    /// Only while it is not open. Then its descriptors must be watched.
    void open(Observers observers);
    void close() noexcept { devices_.clear(), link_.reset(); }
    bool is_open() const noexcept { return link_ != nullptr; }

    int hang_up() const noexcept { return link_->hang_up(); }
    std::size_t devices() const noexcept { return devices_.size(); }
    int event(std::size_t device) const { return devices_[device].attachment.reports->event(); }

    /// One more stream, or one less, needs this device's reports.
    void join(std::size_t device) noexcept;
    void leave(std::size_t device) noexcept;
    /// The next report in order. `unseen`: number of earlier reports that were overwritten unread.
    bool next(std::size_t device, Report& report, std::uint64_t& unseen) noexcept;
    void rearm(std::size_t device) noexcept;
    /// The last report from next(), or the newest one when the first stream came; later reports follow it.
    /// Null: none yet.
    const Report* last(std::size_t device) const noexcept;

  private:
    struct Device {
        detail::Attachment attachment;
        std::size_t streams = 0;
        Report last{};
        bool any = false;
    };
    std::unique_ptr<detail::Link> link_;
    std::vector<Device> devices_;
};

}  // namespace knurl::bridge
