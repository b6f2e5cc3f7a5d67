#include "usbfs_node.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <linux/usb/ch9.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace knurl::drivers::usb_emulator {

namespace {

constexpr std::size_t setup_bytes = 8;

Result done(long value = 0) {
    return {.value = value};
}
Result failed(int error) {
    return {.value = -1, .error = error};
}

template <class T>
T& as(UMockdevIoctlData* data) {
    return *reinterpret_cast<T*>(data->data);
}

}  // namespace

Urb::~Urb() {
    if (block != nullptr) g_object_unref(block);
    if (buffer != nullptr) g_object_unref(buffer);
    if (waiting != nullptr) g_object_unref(waiting);
}

UsbfsNode::UsbfsNode(std::shared_ptr<Model> model, int address, const std::string& fifo_path)
    : model_(std::move(model)), address_(address), kernel_driver_(model_->identity().kernel_driver) {
    unlink(fifo_path.c_str());
    if (mkfifo(fifo_path.c_str(), 0600) != 0 || (fifo_ = open(fifo_path.c_str(), O_RDWR | O_NONBLOCK)) < 0 ||
        fcntl(fifo_, F_SETPIPE_SZ, 4096) < 0)
        throw std::runtime_error("cannot make the node " + fifo_path + ": " + std::strerror(errno));
    show_readiness();
}

UsbfsNode::~UsbfsNode() {
    close(fifo_);
}

// A pipe of one page: with one byte in it nothing more goes in without merging, and poll() says so; empty it
// is writable. libusb asks for POLLOUT.
void UsbfsNode::show_readiness() {
    const bool ready = !plugged_ || std::ranges::any_of(openers_, [](const auto& opener) {
        return !opener.second.done.empty();
    });
    char byte = 0;
    if (ready) {
        while (read(fifo_, &byte, 1) > 0) {
        }
    } else {
        [[maybe_unused]] const ssize_t n = write(fifo_, &byte, 1);
    }
}

int UsbfsNode::claims() const {
    int n = 0;
    for (const auto& [client, opener] : openers_) n += opener.claimed != 0 ? 1 : 0;
    return n;
}

std::size_t UsbfsNode::in_flight(std::uint8_t endpoint) const {
    return static_cast<std::size_t>(std::ranges::count_if(
        pending_, [endpoint](const Flying& flying) { return flying.urb->endpoint == endpoint; }));
}

bool UsbfsNode::held_elsewhere(const Opener& opener, unsigned interface) const {
    return held_by_another_ || std::ranges::any_of(openers_, [&](const auto& other) {
               return &other.second != &opener && (other.second.claimed >> interface & 1U) != 0;
           });
}

Result UsbfsNode::claim(Opener& opener, unsigned interface) {
    if (interface != 0) return failed(ENOENT);
    if ((opener.claimed >> interface & 1U) != 0) return done();
    if (held_elsewhere(opener, interface) || !kernel_driver_.empty()) return failed(EBUSY);
    opener.claimed |= 1U << interface;
    return done();
}

Result UsbfsNode::detach_and_claim(Opener& opener, UMockdevIoctlData* argument) {
    const auto& wanted = as<usbdevfs_disconnect_claim>(argument);
    const std::string bound = held_elsewhere(opener, wanted.interface) ? "usbfs" : kernel_driver_;
    if (!bound.empty()) {
        if ((wanted.flags & USBDEVFS_DISCONNECT_CLAIM_IF_DRIVER) != 0 && bound != wanted.driver)
            return failed(EBUSY);
        if ((wanted.flags & USBDEVFS_DISCONNECT_CLAIM_EXCEPT_DRIVER) != 0 && bound == wanted.driver)
            return failed(EBUSY);
        kernel_driver_.clear();
    }
    return claim(opener, wanted.interface);
}

Result UsbfsNode::driver_call(UMockdevIoctlData* argument) {
    const auto& wanted = as<usbdevfs_ioctl>(argument);
    if (wanted.ioctl_code == static_cast<int>(USBDEVFS_DISCONNECT)) {
        if (kernel_driver_.empty()) return failed(ENODATA);
        kernel_driver_.clear();
        return done();
    }
    if (wanted.ioctl_code == static_cast<int>(USBDEVFS_CONNECT)) {
        if (claims() > 0 || held_by_another_) return failed(EBUSY);
        kernel_driver_ = model_->identity().kernel_driver;
        return done(1);
    }
    return failed(ENOTTY);
}

Result UsbfsNode::reap(Opener& opener, UMockdevIoctlData* argument) {
    if (opener.done.empty()) return failed(plugged_ ? EAGAIN : ENODEV);
    const std::unique_ptr<Urb> urb = std::move(opener.done.front());
    opener.done.pop_front();
    auto& block = as<usbdevfs_urb>(urb->block);
    block.status = urb->status;
    block.actual_length = urb->actual;
    umockdev_ioctl_data_set_ptr(argument, 0, urb->block);
    show_readiness();
    return done();
}

Result UsbfsNode::discard(std::uint64_t address, UMockdevIoctlClient* client) {
    const auto found = std::ranges::find_if(pending_, [&](const Flying& flying) {
        return flying.client == client && flying.urb->block != nullptr && flying.urb->address == address;
    });
    if (found == pending_.end()) return failed(EINVAL);
    Flying flying = std::move(*found);
    pending_.erase(found);
    flying.urb->status = -ENOENT;
    finish(std::move(flying));
    return done();
}

Result UsbfsNode::take_urb(Opener& opener, Call& call, std::uint64_t frame, bool frozen) {
    Urb& urb = *call.urb;
    // Traffic on an interface that nobody has claimed claims it, as devio.c's checkintf does.
    if (urb.type != USBDEVFS_URB_TYPE_CONTROL) {
        if (std::ranges::find(model_->identity().endpoints, urb.endpoint) ==
            model_->identity().endpoints.end())
            return failed(ENOENT);
        if (const Result claimed = claim(opener, 0); claimed.value < 0) return claimed;
    }
    const bool waits = urb.waiting != nullptr;
    pending_.push_back({call.client, std::move(call.urb)});
    if (!frozen) serve(frame);
    return waits ? Result{.later = true} : done();
}

Result UsbfsNode::call(Call& call, std::uint64_t frame, bool frozen) {
    Opener& opener = openers_[call.client];
    if (call.request == USBDEVFS_REAPURB || call.request == USBDEVFS_REAPURBNDELAY)
        return reap(opener, call.argument);
    if (!plugged_) return failed(ENODEV);
    switch (call.request) {
        case USBDEVFS_GET_CAPABILITIES:
            as<std::uint32_t>(call.argument) = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
                                               USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                               USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
            return done();
        case USBDEVFS_CLAIMINTERFACE:
            return claim(opener, as<unsigned>(call.argument));
        case USBDEVFS_RELEASEINTERFACE: {
            const unsigned bit = 1U << as<unsigned>(call.argument);
            if ((opener.claimed & bit) == 0) return failed(EINVAL);
            opener.claimed &= ~bit;
            return done();
        }
        case USBDEVFS_GETDRIVER: {
            auto& wanted = as<usbdevfs_getdriver>(call.argument);
            const std::string bound = claims() > 0 || held_by_another_ ? "usbfs" : kernel_driver_;
            if (bound.empty()) return failed(ENODATA);
            std::strncpy(wanted.driver, bound.c_str(), sizeof(wanted.driver) - 1);
            return done();
        }
        case USBDEVFS_DISCONNECT_CLAIM:
            return detach_and_claim(opener, call.argument);
        case USBDEVFS_IOCTL:
            return driver_call(call.argument);
        case USBDEVFS_CONNECTINFO:
            as<usbdevfs_connectinfo>(call.argument) = {.devnum = static_cast<unsigned>(address_), .slow = 0};
            return done();
        case USBDEVFS_GET_SPEED:
            return done(USB_SPEED_FULL);
        case USBDEVFS_SETCONFIGURATION:
        case USBDEVFS_SETINTERFACE:
        case USBDEVFS_RESETEP:
            return done();
        case USBDEVFS_CLEAR_HALT:
            halted_.erase(static_cast<std::uint8_t>(as<unsigned>(call.argument)));
            return done();
        case USBDEVFS_RESET:
            model_->power_on();
            return done();
        case USBDEVFS_SUBMITURB:
        case USBDEVFS_BULK:
            return take_urb(opener, call, frame, frozen);
        case USBDEVFS_DISCARDURB:
            return discard(call.value, call.client);
        default:
            return failed(ENOTTY);
    }
}

/// As the device's own halt does it, which only CLEAR_FEATURE(ENDPOINT_HALT) ends (USB 2.0, 9.4.5).
bool UsbfsNode::stalls(std::uint8_t endpoint) {
    if (halted_.contains(endpoint)) return true;
    int& left = (endpoint & USB_DIR_IN) != 0 ? model_->stalls_in : model_->stalls_out;
    if (left == 0) return false;
    --left;
    halted_.insert(endpoint);
    return true;
}

/// False: not now.
bool UsbfsNode::move(Urb& urb) {
    int moved = 0;
    if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
        const std::uint8_t* raw = urb.bytes();
        if (raw == nullptr || urb.length < setup_bytes) {
            urb.status = -EINVAL;
            return true;
        }
        const auto word = [raw](std::size_t at) {
            return static_cast<std::uint16_t>(raw[at] | raw[at + 1] << 8);
        };
        const Setup setup{raw[0], raw[1], word(2), word(4), word(6)};
        moved = model_->control(setup, {urb.bytes() + setup_bytes, urb.length - setup_bytes});
    } else if (stalls(urb.endpoint)) {
        moved = -EPIPE;
    } else if ((urb.endpoint & USB_DIR_IN) != 0) {
        moved = model_->in(urb.endpoint, {urb.bytes(), urb.length});
    } else {
        moved = model_->out(urb.endpoint, {urb.bytes(), urb.length});
    }
    if (moved == nak) return false;
    urb.status = std::min(moved, 0);
    urb.actual = std::max(moved, 0);
    return true;
}

void UsbfsNode::finish(Flying flying) {
    Urb& urb = *flying.urb;
    if (urb.waiting != nullptr) {
        const int error = urb.status == -ENOENT ? ETIMEDOUT : -urb.status;
        umockdev_ioctl_client_complete(urb.waiting, error != 0 ? -1 : urb.actual, error);
        return;
    }
    if (const auto opener = openers_.find(flying.client); opener != openers_.end())
        opener->second.done.push_back(std::move(flying.urb));
    show_readiness();
}

// A queue per endpoint, and out before in, whoever was submitted first: what a device answers to the one may
// go with the other in the same frame.
void UsbfsNode::serve(std::uint64_t frame) {
    const auto serve_all = [&](unsigned direction) {
        bool moved = false;
        std::set<std::uint8_t> waiting;  // endpoints whose first request has to wait: so do those behind it
        for (auto at = pending_.begin(); at != pending_.end();) {
            Urb& urb = *at->urb;
            const bool over = urb.give_up_at != 0 && frame >= urb.give_up_at;
            if (over) urb.status = -ENOENT;
            if ((urb.endpoint & USB_DIR_IN) != direction ||
                (!over && (waiting.contains(urb.endpoint) || !move(urb)))) {
                waiting.insert(urb.endpoint);
                ++at;
                continue;
            }
            Flying flying = std::move(*at);
            at = pending_.erase(at);
            finish(std::move(flying));
            moved = true;
        }
        return moved;
    };
    for (bool moved = plugged_; moved;) {
        moved = serve_all(USB_DIR_OUT);
        moved = serve_all(USB_DIR_IN) || moved;
    }
}

void UsbfsNode::closed(UMockdevIoctlClient* client) {
    std::erase_if(pending_, [client](const Flying& flying) { return flying.client == client; });
    openers_.erase(client);
    show_readiness();
}

void UsbfsNode::unplug() {
    plugged_ = false;
    while (!pending_.empty()) {
        Flying flying = std::move(pending_.front());
        pending_.pop_front();
        flying.urb->status = -ESHUTDOWN;
        finish(std::move(flying));
    }
    kernel_driver_.clear();
    show_readiness();
}

}  // namespace knurl::drivers::usb_emulator
