#pragma once
// Finds and holds a device: libusb's context, an opened device with its interface claimed, and blocking
// transfers, which serve only for opening and starting.

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

/// Which device is wanted.
struct Wanted {
    std::string scheme;  // "falcon"
    std::string kind;    // for messages: "Novint Falcon"
    std::vector<UsbId> ids;
    std::string serial = {};  // empty: the only device
    std::string port = {};    // "1-1.2"; empty: any
    bool wait = false;        // absent when it is opened: it is waited for
};

/// The device is gone, or the waiting thread must stop.
class Unplugged : public std::runtime_error {
  public:
    using runtime_error::runtime_error;
};

struct Found {
    UsbDevice info;
    std::shared_ptr<libusb_device> device;
};

/// One libusb context. One thread at a time may use it.
class Context {
  public:
    /// `real_time`: libusb's own thread also gets SCHED_FIFO, where allowed.
    explicit Context(bool real_time = false);
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    libusb_context* get() const { return context_; }
    /// Devices with one of these ids, in order of port; opens none.
    std::vector<Found> list(std::span<const UsbId> ids, std::string_view scheme) const;
    /// The wanted device. Throws std::runtime_error: there is none, or there are several, which it lists.
    Found find(const Wanted& wanted) const;
    /// Descriptors on which libusb's event handling waits.
    std::vector<libusb_pollfd> descriptors() const;
    /// The newest descriptor from libusb: right after libusb_open, the node.
    int newest_descriptor() const { return newest_descriptor_; }

  private:
    libusb_context* context_ = nullptr;
    int newest_descriptor_ = -1;
};

/// Records that this process has a device open; the kernel only knows that some process has.
class OpenHere {
  public:
    /// Throws std::runtime_error: this process already has it open.
    explicit OpenHere(const UsbDevice& device);
    ~OpenHere();
    OpenHere(const OpenHere&) = delete;
    OpenHere& operator=(const OpenHere&) = delete;

  private:
    std::string node_;
};

class Session {
  public:
    /// Opens the node and claims the interface. A kernel driver is detached, and attached again at the end.
    /// Throws std::runtime_error with the remedy: missing rights, or another program holds it. `stop` ends
    /// all waits.
    Session(Context& context, Found found, int interface, const std::atomic<bool>& stop);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const UsbDevice& info() const { return found_.info; }
    libusb_device_handle* handle() const { return handle_; }
    /// The node's descriptor: the open file that holds the interface, in whichever process.
    int node() const { return node_; }
    /// The interface's endpoints from its descriptor; `out` is 0 if there is none.
    std::uint8_t in() const { return in_; }
    std::uint8_t out() const { return out_; }
    bool interrupt() const { return interrupt_; }  // else bulk

    // These block. They throw Unplugged, or std::runtime_error for any failure except a timeout.
    using Milliseconds = std::chrono::milliseconds;
    void control(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index);
    /// Returns the number of bytes sent before the timeout.
    std::size_t write(std::span<const std::uint8_t> bytes, Milliseconds timeout);
    std::size_t read(std::span<std::uint8_t> bytes, Milliseconds timeout);
    /// A last packet before closing: sent even when the thread must stop, and failures are ignored.
    void write_last(std::span<const std::uint8_t> bytes, Milliseconds timeout) noexcept;
    /// Throws Unplugged if the thread must stop.
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
