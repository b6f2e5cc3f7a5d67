#pragma once
// One node of usbfs (/dev/bus/usb/001/004) with the behaviour of the kernel's drivers/usb/core/devio.c: who
// holds which interface, requests in flight and done, and what remains of them after unplugging.

#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <umockdev.h>

#include "model.hpp"

namespace knurl::drivers::usb_emulator {

/// A request block that somebody submitted. The memory is the caller's, reached through umockdev, so the
/// caller may be another process.
struct Urb {
    UMockdevIoctlData* block = nullptr;      // struct usbdevfs_urb; null for a synchronous transfer
    UMockdevIoctlData* buffer = nullptr;     // may be null if empty
    UMockdevIoctlClient* waiting = nullptr;  // a synchronous transfer: answer this one
    std::uint64_t address = 0;               // of the block, in the caller's memory
    std::uint8_t type = 0, endpoint = 0;
    std::size_t length = 0;
    std::uint64_t give_up_at = 0;  // frame; 0: never
    int status = 0, actual = 0;

    Urb() = default;
    Urb(const Urb&) = delete;
    Urb& operator=(const Urb&) = delete;
    ~Urb();
    std::uint8_t* bytes() const { return buffer != nullptr ? buffer->data : nullptr; }
};

/// The result of a call: what ioctl returns, and errno. Not done: it is answered later.
struct Result {
    long value = 0;
    int error = 0;
    bool later = false;
};

class UsbfsNode {
  public:
    /// `fifo_path` stands for the node in poll(): full while there is nothing to reap.
    UsbfsNode(std::shared_ptr<Model> model, int address, const std::string& fifo_path);
    ~UsbfsNode();
    UsbfsNode(const UsbfsNode&) = delete;
    UsbfsNode& operator=(const UsbfsNode&) = delete;

    /// A call's arguments, fetched from the caller before the bus is locked (that may block on the caller).
    struct Call {
        UMockdevIoctlClient* client = nullptr;
        unsigned long request = 0;
        UMockdevIoctlData* argument = nullptr;  // what the pointer points to; null if there is none
        std::uint64_t value = 0;                // the argument as a number
        std::unique_ptr<Urb> urb;               // SUBMITURB, BULK
    };

    Result call(Call& call, std::uint64_t frame, bool frozen);
    void closed(UMockdevIoctlClient* client);
    /// Moves what can be moved between requests and model.
    void serve(std::uint64_t frame);
    void unplug();

    Model& model() { return *model_; }
    /// Another program claims the interface, or lets it go.
    void hold_by_another(bool held) { held_by_another_ = held; }
    const std::string& bound_driver() const { return kernel_driver_; }
    int claims() const;
    std::size_t in_flight() const { return pending_.size(); }
    std::size_t in_flight(std::uint8_t endpoint) const;

  private:
    struct Opener {
        std::uint32_t claimed = 0;  // bit per interface
        std::deque<std::unique_ptr<Urb>> done;
    };
    struct Flying {
        UMockdevIoctlClient* client;
        std::unique_ptr<Urb> urb;
    };

    Result claim(Opener& opener, unsigned interface);
    Result detach_and_claim(Opener& opener, UMockdevIoctlData* argument);
    Result driver_call(UMockdevIoctlData* argument);
    Result reap(Opener& opener, UMockdevIoctlData* argument);
    Result discard(std::uint64_t address, UMockdevIoctlClient* client);
    Result take_urb(Opener& opener, Call& call, std::uint64_t frame, bool frozen);
    bool held_elsewhere(const Opener& opener, unsigned interface) const;
    bool stalls(std::uint8_t endpoint);
    bool move(Urb& urb);
    void finish(Flying flying);
    void show_readiness();

    std::shared_ptr<Model> model_;
    int address_;
    int fifo_ = -1;
    bool plugged_ = true;
    bool held_by_another_ = false;
    std::string kernel_driver_;
    std::set<std::uint8_t> halted_;  // endpoints
    std::map<UMockdevIoctlClient*, Opener> openers_;
    std::list<Flying> pending_;  // in order of submission
};

}  // namespace knurl::drivers::usb_emulator
