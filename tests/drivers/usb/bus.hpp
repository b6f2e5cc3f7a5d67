#pragma once
// An emulated USB bus: umockdev's sysfs, uevents and ioctl hand-over for unmodified libusb, a node of usbfs
// per device behind them, and a separate clock.
//
//   libusb -- ioctl --> preload -- socket --> umockdev's worker --> UsbfsNode --> Model
//                                                                      ^
//                                              a frame per millisecond |  (the bus's thread)
//
// Frames count milliseconds of the bus's own time, which a stopped machine does not advance.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include <umockdev.h>

#include "model.hpp"
#include "usbfs_node.hpp"

namespace knurl::drivers::usb_emulator {

/// umockdev works through LD_PRELOAD, which must be set when the program starts: restarts it with that. First
/// thing in main(), before any thread, since the preload's waits use the timer slack of their thread.
void start_under_umockdev(int argc, char** argv);

struct Plug {
    std::string port = "1-1";  // as sysfs names it
    std::string serial;        // empty: has none
};

class Bus {
  public:
    Bus();
    ~Bus();
    Bus(const Bus&) = delete;
    Bus& operator=(const Bus&) = delete;

    /// Plugs it in; returns the node's path ("/dev/bus/usb/001/004"). A model may be plugged in again.
    std::string plug(std::shared_ptr<Model> model, const Plug& plug);
    /// Unplugs it: requests in flight end, the node answers ENODEV, then udev is notified.
    void unplug(const std::string& port);
    /// The same from inside a Model's call (the lock is held): done at the end of this frame.
    void unplug_soon(const std::string& port);

    /// Nothing moves while frozen: requests stay in flight, frames do not pass.
    void freeze(bool frozen);
    /// While held, only tick() advances the clock, one frame each: a test that paces it is independent of the
    /// machine's speed. Requests are served meanwhile.
    void hold_clock(bool held);
    void tick();
    /// With the clock held: waits until the bus's users have reached the state `true_now` (called with the
    /// lock held, after every call). False: not within half a minute.
    bool settles(const std::function<bool()>& true_now);
    /// Requests that wait at an endpoint. With the lock held: inside locked() or a condition.
    std::size_t waiting_at(const std::string& port, std::uint8_t endpoint);

    /// Waits until no call has come for some frames' worth of time: then the bus's users are waiting for it.
    void wait_until_quiet();

    /// Another program holds the interface of the device at that port.
    void hold_by_another(const std::string& port, bool held);
    /// The driver that the kernel has bound to it; empty: none.
    std::string bound_driver(const std::string& port);
    /// How many openers hold an interface.
    int claims(const std::string& port);
    /// Requests that somebody waits for.
    std::size_t in_flight(const std::string& port);
    /// The node's real path, in the mocked tree.
    std::string real_path(const std::string& node) const;

    std::uint64_t frame() const { return frame_.load(std::memory_order_acquire); }
    std::uint64_t calls() const { return calls_.load(std::memory_order_acquire); }

    /// Runs `what` with the bus's lock held, to read a model.
    template <class F>
    auto locked(F&& what) {
        const std::lock_guard lock(mutex_);
        return what();
    }
    /// Waits until `true_now` (called with the lock held, after every frame) says so; false after `frames`.
    bool wait(std::uint64_t frames, const std::function<bool()>& true_now);

  private:
    struct Socket {
        std::string node, syspath;
        std::unique_ptr<UsbfsNode> usbfs;
    };

    static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer bus);
    static void on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer bus);
    static void on_gone(UMockdevIoctlClient* client, GParamSpec*, gpointer bus);
    static void on_freed(gpointer bus, GObject* client);
    void forget(UMockdevIoctlClient* client);
    void forget_freed();
    void handle(UMockdevIoctlClient* client);
    UsbfsNode* node_of(UMockdevIoctlClient* client);
    Socket& at(const std::string& port);
    void run();
    void pass_frame();

    UMockdevTestbed* testbed_ = nullptr;
    UMockdevIoctlBase* handler_ = nullptr;
    std::mutex mutex_;
    std::condition_variable frame_passed_;
    std::map<std::string, Socket> sockets_;           // by port
    std::vector<std::unique_ptr<UsbfsNode>> pulled_;  // openers may still ask them
    std::map<UMockdevIoctlClient*, UsbfsNode*> clients_;
    std::mutex freed_mutex_;  // innermost
    std::vector<UMockdevIoctlClient*> freed_;
    std::vector<std::string> unplug_soon_;
    std::set<std::string> attached_;  // nodes that have had a handler
    int next_address_ = 2;
    bool frozen_ = false, held_ = false;
    std::atomic<std::uint64_t> frame_ = 0, calls_ = 0;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

}  // namespace knurl::drivers::usb_emulator
