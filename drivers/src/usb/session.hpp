#pragma once
// Finding a device and holding it: libusb's context, an opened device with its interface claimed, and
// transfers that wait, for opening and starting only.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <libusb.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/usb_list.hpp>

namespace knurl::drivers::usb {

/// Which device somebody wants.
struct Wanted {
    std::string scheme;  // "falcon"
    std::string kind;    // for people: "Novint Falcon"
    std::vector<UsbId> ids;
    std::string serial = {};  // empty: the only one
    std::string port = {};    // "1-1.2"; empty: any
};

/// The device went away, or whoever waits for it wants to stop.
class Unplugged : public std::runtime_error {
  public:
    using runtime_error::runtime_error;
};

struct Found {
    UsbDevice info;
    std::shared_ptr<libusb_device> device;
};

/// One context of libusb. Used by one thread at a time.
class Context {
  public:
    /// `real_time`: libusb's own thread is SCHED_FIFO too, where that is allowed.
    explicit Context(bool real_time = false);
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    libusb_context* get() const { return context_; }
    /// Devices with one of these ids, in order of port; opens none.
    std::vector<Found> list(std::span<const UsbId> ids, std::string_view scheme) const;
    /// The one that is wanted; throws std::runtime_error: there is none, there are several, and which.
    Found find(const Wanted& wanted) const;
    /// Descriptors that libusb's event handling waits for.
    std::vector<libusb_pollfd> descriptors() const;
    /// The newest of them that libusb added: right after libusb_open, the node.
    int newest_descriptor() const { return newest_descriptor_; }

  private:
    libusb_context* context_ = nullptr;
    int newest_descriptor_ = -1;
};

/// That this process has a device open; the kernel could only say that somebody does.
class OpenHere {
  public:
    /// Throws std::runtime_error: it has it open already.
    explicit OpenHere(const UsbDevice& device);
    ~OpenHere();
    OpenHere(const OpenHere&) = delete;
    OpenHere& operator=(const OpenHere&) = delete;

  private:
    std::string node_;
};

class Session {
  public:
    /// Opens the node and claims the interface; a kernel driver that has it is detached, and attached again
    /// at the end. Throws std::runtime_error with the way out: no rights, held by another program. `stop`
    /// ends whatever waits.
    Session(Context& context, Found found, int interface, const std::atomic<bool>& stop);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const UsbDevice& info() const { return found_.info; }
    libusb_device_handle* handle() const { return handle_; }
    /// The node's descriptor: the open file that holds the interface, whichever process has it.
    int node() const { return node_; }
    /// The interface's endpoints, as it describes them; out is 0 if there is none.
    std::uint8_t in() const { return in_; }
    std::uint8_t out() const { return out_; }
    bool interrupt() const { return interrupt_; }  // else bulk

    // These wait; they throw Unplugged, or std::runtime_error for anything else but running out of time.
    using Milliseconds = std::chrono::milliseconds;
    void control(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index);
    /// Returns the number of bytes taken before time ran out.
    std::size_t write(std::span<const std::uint8_t> bytes, Milliseconds timeout);
    std::size_t read(std::span<std::uint8_t> bytes, Milliseconds timeout);
    /// Before it is closed, whoever wants to stop: heard or not.
    void write_last(std::span<const std::uint8_t> bytes, Milliseconds timeout) noexcept;
    /// Throws Unplugged if somebody wants to stop.
    void go_on() const;

  private:
    void find_endpoints();
    void check(int code, const char* doing) const;
    int attempt(std::uint8_t endpoint, std::uint8_t* bytes, std::size_t count, Milliseconds timeout,
                int& moved) noexcept;
    std::size_t transfer(std::uint8_t endpoint, std::uint8_t* bytes, std::size_t count, Milliseconds timeout);

    Found found_;
    OpenHere open_here_{found_.info};
    int interface_;
    const std::atomic<bool>& stop_;
    libusb_device_handle* handle_ = nullptr;
    int node_ = -1;
    std::uint8_t in_ = 0, out_ = 0;
    bool interrupt_ = false;
};

}  // namespace knurl::drivers::usb
