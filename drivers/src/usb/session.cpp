#include "usb/session.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <linux/usbdevice_fs.h>
#include <pthread.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace knurl::drivers::usb {

namespace {

std::string attribute(const std::string& port, const char* name) {
    std::ifstream file("/sys/bus/usb/devices/" + port + "/" + name);
    std::string text;
    std::getline(file, text);
    return text;
}

/// The kernel shows the claim of a program as the interface's driver.
bool claimed(const std::string& port) {
    std::error_code none;
    const std::string interface = port + ":" + attribute(port, "bConfigurationValue") + ".0";
    return std::filesystem::read_symlink("/sys/bus/usb/devices/" + port + "/" + interface + "/driver", none)
               .filename() == "usbfs";
}

/// The port's name in sysfs.
std::string port_name(libusb_device* device) {
    std::array<std::uint8_t, 8> ports{};
    const int n = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
    std::string name = std::to_string(libusb_get_bus_number(device));
    for (int i = 0; i < n; ++i)
        name.append(i == 0 ? "-" : ".").append(std::to_string(ports[static_cast<std::size_t>(i)]));
    return name;
}

std::string node_name(libusb_device* device) {
    char name[32];
    std::snprintf(name, sizeof name, "/dev/bus/usb/%03u/%03u", unsigned{libusb_get_bus_number(device)},
                  unsigned{libusb_get_device_address(device)});
    return name;
}

std::string listed(const std::vector<Found>& found) {
    std::string text;
    for (const Found& one : found) text.append(text.empty() ? "" : ", ").append(one.info.address());
    return text;
}

std::mutex open_here_mutex;
std::set<std::string> open_here;  // nodes

}  // namespace

OpenHere::OpenHere(const UsbDevice& device) : node_(device.node) {
    const std::lock_guard lock(open_here_mutex);
    if (!open_here.insert(node_).second)
        throw std::runtime_error(device.address() + " (" + device.node +
                                 ") is open already under another name; give each hand a device of its own: "
                                 "`knurl devices` lists what is plugged in");
}

OpenHere::~OpenHere() {
    const std::lock_guard lock(open_here_mutex);
    open_here.erase(node_);
}

Context::Context(bool real_time) {
    // libusb starts a thread for hot-plugging, which inherits this thread's priority. A guardian sees a
    // process as dead only after its last thread has run once more, and an ordinary thread may have to wait
    // long for that. The lowest real-time priority is enough. It also keeps the scan of new devices from
    // delaying the I/O of other devices.
    int policy = SCHED_OTHER;
    sched_param before{};
    pthread_getschedparam(pthread_self(), &policy, &before);
    const sched_param lowest{.sched_priority = sched_get_priority_min(SCHED_FIFO)};
    const bool raised = real_time && pthread_setschedparam(pthread_self(), SCHED_FIFO, &lowest) == 0;
    const int code = libusb_init(&context_);
    if (raised) pthread_setschedparam(pthread_self(), policy, &before);
    if (code != 0) throw std::runtime_error(std::string("cannot look at USB: ") + libusb_strerror(code));
    libusb_set_pollfd_notifiers(
        context_, [](int fd, short, void* self) { static_cast<Context*>(self)->newest_descriptor_ = fd; },
        [](int, void*) {}, this);
}

Context::~Context() {
    libusb_set_pollfd_notifiers(context_, nullptr, nullptr, nullptr);
    libusb_exit(context_);
}

std::vector<Found> Context::list(std::span<const UsbId> ids, std::string_view scheme) const {
    libusb_device** all = nullptr;
    const ssize_t n = libusb_get_device_list(context_, &all);
    if (n < 0)
        throw std::runtime_error(std::string("cannot list USB devices: ") +
                                 libusb_strerror(static_cast<int>(n)));
    std::vector<Found> found;
    for (libusb_device* device : std::span(all, static_cast<std::size_t>(n))) {
        libusb_device_descriptor descriptor{};
        libusb_get_device_descriptor(device, &descriptor);
        if (std::ranges::none_of(ids, [&](const UsbId& id) {
                return id.vendor == descriptor.idVendor && id.product == descriptor.idProduct;
            }))
            continue;
        const std::string port = port_name(device), node = node_name(device);
        Found& one = found.emplace_back();
        one.info = {.vendor = descriptor.idVendor,
                    .product = descriptor.idProduct,
                    .scheme = std::string(scheme),
                    .name = attribute(port, "product"),
                    .serial = attribute(port, "serial"),
                    .twin = false,
                    .port = port,
                    .node = node,
                    .accessible = access(node.c_str(), R_OK | W_OK) == 0,
                    .claimed = claimed(port)};
        one.device = {libusb_ref_device(device), libusb_unref_device};
    }
    libusb_free_device_list(all, 1);
    for (Found& one : found)
        one.info.twin = std::ranges::count(found, one.info.serial,
                                           [](const Found& other) { return other.info.serial; }) > 1;
    std::ranges::sort(found, {}, [](const Found& one) { return one.info.port; });
    return found;
}

Found Context::find(const Wanted& wanted) const {
    const std::vector<Found> all = list(wanted.ids, wanted.scheme);
    std::vector<Found> fitting = all;
    std::erase_if(fitting, [&](const Found& one) {
        return (!wanted.serial.empty() && one.info.serial != wanted.serial) ||
               (!wanted.port.empty() && one.info.port != wanted.port);
    });
    if (fitting.size() == 1) return fitting.front();
    if (all.empty())
        throw std::runtime_error("no " + wanted.kind +
                                 " is plugged in; is it powered? `knurl devices` shows what is");
    if (fitting.empty())
        throw std::runtime_error("no " + wanted.kind + " \"" + wanted.serial +
                                 (wanted.port.empty() ? "" : "\" in port \"" + wanted.port) +
                                 "\"; plugged in: " + listed(all));
    const bool same = std::ranges::all_of(
        fitting, [&](const Found& one) { return one.info.serial == fitting.front().info.serial; });
    if (same)
        throw std::runtime_error(std::to_string(fitting.size()) + " of " + wanted.kind +
                                 " have the same serial number \"" + fitting.front().info.serial +
                                 "\"; say which by its port: " + listed(fitting));
    throw std::runtime_error(std::to_string(fitting.size()) + " of " + wanted.kind +
                             " are plugged in; say which: " + listed(fitting));
}

std::vector<libusb_pollfd> Context::descriptors() const {
    std::vector<libusb_pollfd> all;
    const libusb_pollfd** list = libusb_get_pollfds(context_);
    for (const libusb_pollfd** one = list; one != nullptr && *one != nullptr; ++one) all.push_back(**one);
    libusb_free_pollfds(list);
    return all;
}

Session::Session(Context& context, Found found, int interface, const std::atomic<bool>& stop)
    : found_(std::move(found)), interface_(interface), stop_(stop) {
    const UsbDevice& device = found_.info;
    if (const int code = libusb_open(found_.device.get(), &handle_); code != 0) {
        if (code == LIBUSB_ERROR_NO_DEVICE) throw Unplugged(device.node + " has just been unplugged");
        if (code == LIBUSB_ERROR_ACCESS) {
            const NoRights why = no_rights(device);
            throw std::runtime_error(device.node + ": " + why.problem + ": " + why.mend);
        }
        throw std::runtime_error("cannot open " + device.node + ": " + libusb_strerror(code));
    }
    node_ = context.newest_descriptor();
    usbdevfs_connectinfo seen{};
    if (ioctl(node_, USBDEVFS_CONNECTINFO, &seen) != 0 ||
        seen.devnum != libusb_get_device_address(found_.device.get())) {
        libusb_close(handle_);
        throw std::runtime_error("this libusb does not say which descriptor it opened for " + device.node +
                                 ", without which the guardian could not make the device safe; use libusb "
                                 "1.0.26 or later on Linux's usbfs");
    }
    libusb_set_auto_detach_kernel_driver(handle_, 1);
    // The guardian of a servo that has just died holds the node until it has saved its data. So the claim is
    // tried again for a while, and nobody who starts the next servo has to wait.
    constexpr Milliseconds patience{2000}, pause{20};
    int code = libusb_claim_interface(handle_, interface_);
    for (Milliseconds waited{0}; code == LIBUSB_ERROR_BUSY && waited < patience && !stop_; waited += pause) {
        std::this_thread::sleep_for(pause);
        code = libusb_claim_interface(handle_, interface_);
    }
    if (code != 0) {
        libusb_close(handle_);
        if (code == LIBUSB_ERROR_NO_DEVICE) throw Unplugged(device.node + " has just been unplugged");
        if (code == LIBUSB_ERROR_BUSY)
            throw std::runtime_error("another program holds " + device.node + " (" + device.address() +
                                     "); end it: sudo fuser -v " + device.node + " says which it is");
        throw std::runtime_error("cannot claim " + device.node + ": " + libusb_strerror(code));
    }
    find_endpoints();
}

void Session::find_endpoints() {
    libusb_config_descriptor* configuration = nullptr;
    if (libusb_get_active_config_descriptor(found_.device.get(), &configuration) != 0) return;
    if (interface_ < configuration->bNumInterfaces) {
        const libusb_interface_descriptor& first = configuration->interface[interface_].altsetting[0];
        for (const libusb_endpoint_descriptor& one : std::span(first.endpoint, first.bNumEndpoints)) {
            std::uint8_t& which = (one.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0 ? in_ : out_;
            if (which == 0) which = one.bEndpointAddress;
            interrupt_ = (one.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_INTERRUPT;
        }
    }
    libusb_free_config_descriptor(configuration);
}

Session::~Session() {
    libusb_release_interface(handle_, interface_);
    libusb_close(handle_);
}

void Session::go_on() const {
    if (stop_.load(std::memory_order_relaxed)) throw Unplugged("asked to stop");
}

void Session::check(int code, const char* doing) const {
    if (code >= 0) return;
    if (code == LIBUSB_ERROR_NO_DEVICE) throw Unplugged(found_.info.node + " was unplugged");
    throw std::runtime_error(std::string("cannot ") + doing + " " + found_.info.node + ": " +
                             libusb_strerror(code));
}

void Session::control(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index) {
    constexpr unsigned timeout_ms = 1000;
    go_on();
    check(libusb_control_transfer(handle_, type, request, value, index, nullptr, 0, timeout_ms), "set up");
}

/// libusb's code.
int Session::attempt(std::uint8_t endpoint, std::uint8_t* bytes, std::size_t count, Milliseconds timeout,
                     int& moved) noexcept {
    const auto call = interrupt_ ? libusb_interrupt_transfer : libusb_bulk_transfer;
    const auto once = [&] {
        return call(handle_, endpoint, bytes, static_cast<int>(count), &moved,
                    static_cast<unsigned>(std::max<std::int64_t>(timeout.count(), 1)));
    };
    const int code = once();
    // The last user may have left the endpoint halted, which must be cleared.
    return code == LIBUSB_ERROR_PIPE && libusb_clear_halt(handle_, endpoint) == 0 ? once() : code;
}

std::size_t Session::transfer(std::uint8_t endpoint, std::uint8_t* bytes, std::size_t count,
                              Milliseconds timeout) {
    go_on();
    int moved = 0;
    const int code = attempt(endpoint, bytes, count, timeout, moved);
    if (code != LIBUSB_ERROR_TIMEOUT) check(code, "talk to");
    return static_cast<std::size_t>(moved);
}

void Session::write_last(std::span<const std::uint8_t> bytes, Milliseconds timeout) noexcept {
    int moved = 0;
    attempt(out_, const_cast<std::uint8_t*>(bytes.data()), bytes.size(), timeout, moved);  // only read
}

std::size_t Session::write(std::span<const std::uint8_t> bytes, Milliseconds timeout) {
    return transfer(out_, const_cast<std::uint8_t*>(bytes.data()), bytes.size(), timeout);  // only read
}

std::size_t Session::read(std::span<std::uint8_t> bytes, Milliseconds timeout) {
    return transfer(in_, bytes.data(), bytes.size(), timeout);
}

}  // namespace knurl::drivers::usb
