#include "bus.hpp"

#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <linux/usbdevice_fs.h>
#include <pthread.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace knurl::drivers::usb_emulator {

namespace {

constexpr long frame_ns = 1'000'000;

std::string hex(const std::vector<std::uint8_t>& bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes) {
        char pair[3];
        std::snprintf(pair, sizeof pair, "%02X", byte);
        text += pair;
    }
    return text;
}

void check(GError* error, const char* what) {
    if (error == nullptr) return;
    const std::string why = std::string(what) + ": " + error->message;
    g_error_free(error);
    throw std::runtime_error(why);
}

/// The size of the data behind a call's pointer, by the call's number.
std::size_t argument_bytes(unsigned long request) {
    switch (request) {
        case USBDEVFS_RESET:
        case USBDEVFS_DISCARDURB:
        case USBDEVFS_GET_SPEED:
            return 0;
        case USBDEVFS_SUBMITURB:
            return offsetof(usbdevfs_urb, iso_frame_desc);
        default:
            return _IOC_SIZE(request);
    }
}

UMockdevIoctlData* resolve(UMockdevIoctlData* data, std::size_t offset, std::size_t bytes) {
    GError* error = nullptr;
    UMockdevIoctlData* found =
        bytes == 0 ? nullptr : umockdev_ioctl_data_resolve(data, offset, bytes, &error);
    if (error != nullptr) g_error_free(error);  // the caller has died: its memory is gone
    return found;
}

/// Milliseconds of a synchronous call; 0 is for ever.
std::uint64_t give_up(std::uint64_t frame, unsigned timeout_ms) {
    return timeout_ms == 0 ? 0 : frame + timeout_ms + 1;
}

std::unique_ptr<Urb> synchronous(UsbfsNode::Call& call, std::uint64_t frame) {
    auto urb = std::make_unique<Urb>();
    if (call.request == USBDEVFS_BULK) {
        const auto& bulk = *reinterpret_cast<usbdevfs_bulktransfer*>(call.argument->data);
        urb->type = USBDEVFS_URB_TYPE_BULK;
        urb->endpoint = static_cast<std::uint8_t>(bulk.ep);
        urb->length = bulk.len;
        urb->give_up_at = give_up(frame, bulk.timeout);
        urb->buffer = resolve(call.argument, offsetof(usbdevfs_bulktransfer, data), bulk.len);
    }
    if (urb->buffer == nullptr) return nullptr;
    urb->waiting = UMOCKDEV_IOCTL_CLIENT(g_object_ref(call.client));
    return urb;
}

std::unique_ptr<Urb> submitted(UsbfsNode::Call& call) {
    const auto& block = *reinterpret_cast<usbdevfs_urb*>(call.argument->data);
    auto urb = std::make_unique<Urb>();
    urb->block = umockdev_ioctl_data_ref(call.argument);
    urb->address = call.argument->client_addr;
    urb->type = block.type;
    urb->endpoint = block.endpoint;
    urb->length = static_cast<std::size_t>(block.buffer_length);
    urb->buffer = resolve(call.argument, offsetof(usbdevfs_urb, buffer), urb->length);
    if (urb->length > 0 && urb->buffer == nullptr) return nullptr;
    return urb;
}

}  // namespace

Bus::Bus() : testbed_(umockdev_testbed_new()), handler_(umockdev_ioctl_base_new()) {
    if (umockdev_in_mock_environment() == FALSE)  // caches its answer: not before there is a testbed
        throw std::runtime_error("umockdev's preload is missing: call start_under_umockdev in main()");
    g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
    g_signal_connect(handler_, "client-connected", G_CALLBACK(on_connected), this);
    thread_ = std::thread([this] { run(); });
}

Bus::~Bus() {
    stop_ = true;
    thread_.join();
    while (!sockets_.empty()) unplug(sockets_.begin()->first);
    g_object_unref(handler_);
    g_object_unref(testbed_);  // ends umockdev's worker: no call comes any more
    // GLib has waited for it in a way that ThreadSanitizer does not see.
    const std::lock_guard lock(freed_mutex_);
}

std::string Bus::real_path(const std::string& node) const {
    char* root = umockdev_testbed_get_root_dir(testbed_);
    const std::string path = root + node;
    g_free(root);
    return path;
}

std::string Bus::plug(std::shared_ptr<Model> model, const Plug& plug) {
    int address = 0;
    {
        const std::lock_guard lock(mutex_);
        if (sockets_.contains(plug.port)) throw std::runtime_error("there is something in port " + plug.port);
        address = next_address_;
        next_address_ = next_address_ % 120 + 1;
        model->power_on();
    }
    const Identity& identity = model->identity();
    char name[32];
    std::snprintf(name, sizeof name, "bus/usb/001/%03d", address);
    const std::string node = std::string("/dev/") + name;
    std::ostringstream text;
    text << "P: /devices/usb1/" << plug.port << "\nN: " << name
         << "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\n"
         << "E: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM=" << name + 12 << "\nE: DEVNAME=" << node << "\n"
         << "A: busnum=1\\n\nA: devnum=" << address << "\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\n"
         << "A: product=" << identity.name << "\\n\n";
    if (!plug.serial.empty()) text << "A: serial=" << plug.serial << "\\n\n";
    text << "H: descriptors=" << hex(descriptors(identity)) << "\n";

    GError* error = nullptr;
    // The handler first: an opener that finds the node without one would talk to the FIFO. It stays after
    // unplugging: else the preload ends a program that is just opening the node.
    if (attached_.insert(node).second)
        umockdev_testbed_attach_ioctl(testbed_, node.c_str(), handler_, &error);
    check(error, "attach_ioctl");
    umockdev_testbed_add_from_string(testbed_, text.str().c_str(), &error);
    check(error, "add_from_string");
    auto usbfs = std::make_unique<UsbfsNode>(std::move(model), address, real_path(node));
    const std::string syspath = "/sys/devices/usb1/" + plug.port;
    {
        const std::lock_guard lock(mutex_);
        sockets_[plug.port] = {node, syspath, std::move(usbfs)};
    }
    umockdev_testbed_uevent(testbed_, syspath.c_str(), "add");
    return node;
}

Bus::Socket& Bus::at(const std::string& port) {
    const auto found = sockets_.find(port);
    if (found == sockets_.end()) throw std::runtime_error("nothing is in port " + port);
    return found->second;
}

void Bus::unplug(const std::string& port) {
    Socket socket;
    {
        const std::lock_guard lock(mutex_);
        const auto found = sockets_.find(port);
        if (found == sockets_.end()) return;
        socket = std::move(found->second);
        sockets_.erase(found);
        socket.usbfs->unplug();
        pulled_.push_back(std::move(socket.usbfs));
    }
    umockdev_testbed_uevent(testbed_, socket.syspath.c_str(), "remove");
    ::unlink(real_path(socket.node).c_str());
    umockdev_testbed_remove_device(testbed_, socket.syspath.c_str());
}

void Bus::unplug_soon(const std::string& port) {
    unplug_soon_.push_back(port);
}

void Bus::freeze(bool frozen) {
    const std::lock_guard lock(mutex_);
    frozen_ = frozen;
    for (auto& [port, socket] : sockets_)
        if (!frozen) socket.usbfs->serve(frame());
}

void Bus::hold_clock(bool held) {
    const std::lock_guard lock(mutex_);
    held_ = held;
}

void Bus::tick() {
    {
        const std::lock_guard lock(mutex_);
        pass_frame();
    }
    frame_passed_.notify_all();
}

bool Bus::settles(const std::function<bool()>& true_now) {
    constexpr std::chrono::seconds patience{30};
    std::unique_lock lock(mutex_);
    return frame_passed_.wait_for(lock, patience, true_now);
}

std::size_t Bus::waiting_at(const std::string& port, std::uint8_t endpoint) {
    return at(port).usbfs->in_flight(endpoint);
}

void Bus::wait_until_quiet() {
    constexpr timespec pause{.tv_sec = 0, .tv_nsec = 20 * frame_ns};
    for (std::uint64_t before = calls() - 1; before != calls();) {
        before = calls();
        nanosleep(&pause, nullptr);
    }
}

void Bus::hold_by_another(const std::string& port, bool held) {
    const std::lock_guard lock(mutex_);
    at(port).usbfs->hold_by_another(held);
    const std::filesystem::path interface = real_path("/sys/devices/usb1/" + port + "/" + port + ":1.0");
    std::filesystem::create_directory(interface);
    if (held)
        std::filesystem::create_symlink("../../../../bus/usb/drivers/usbfs", interface / "driver");
    else
        std::filesystem::remove(interface / "driver");
}

std::string Bus::bound_driver(const std::string& port) {
    const std::lock_guard lock(mutex_);
    return at(port).usbfs->bound_driver();
}

int Bus::claims(const std::string& port) {
    const std::lock_guard lock(mutex_);
    return at(port).usbfs->claims();
}

std::size_t Bus::in_flight(const std::string& port) {
    const std::lock_guard lock(mutex_);
    return at(port).usbfs->in_flight();
}

bool Bus::wait(std::uint64_t frames, const std::function<bool()>& true_now) {
    std::unique_lock lock(mutex_);
    const std::uint64_t end = frame() + frames;
    frame_passed_.wait(lock, [&] { return frame() >= end || true_now(); });
    return true_now();
}

gboolean Bus::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer bus) {
    static_cast<Bus*>(bus)->handle(client);
    return TRUE;
}

void Bus::on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer bus) {
    g_signal_connect(client, "notify::connected", G_CALLBACK(on_gone), bus);
    g_object_weak_ref(G_OBJECT(client), on_freed, bus);
}

void Bus::on_gone(UMockdevIoctlClient* client, GParamSpec*, gpointer bus) {
    const std::lock_guard lock(static_cast<Bus*>(bus)->mutex_);
    static_cast<Bus*>(bus)->forget(client);
}

// A client may be freed without a close, and the next one may have the same address. The thread that frees it
// may be inside serve() with the bus locked. So it is only noted here, and forgotten before the next service.
void Bus::on_freed(gpointer bus, GObject* client) {
    const std::lock_guard lock(static_cast<Bus*>(bus)->freed_mutex_);
    static_cast<Bus*>(bus)->freed_.push_back(reinterpret_cast<UMockdevIoctlClient*>(client));
}

/// With the lock held.
void Bus::forget_freed() {
    std::vector<UMockdevIoctlClient*> freed;
    {
        const std::lock_guard lock(freed_mutex_);
        freed.swap(freed_);
    }
    for (UMockdevIoctlClient* const client : freed) forget(client);
}

/// With the lock held.
void Bus::forget(UMockdevIoctlClient* client) {
    const auto found = clients_.find(client);
    if (found == clients_.end()) return;
    UsbfsNode* const node = found->second;
    node->closed(client);
    clients_.erase(found);
    for (const auto& [other, of] : clients_)
        if (of == node) return;
    std::erase_if(pulled_, [node](const auto& pulled) { return pulled.get() == node; });
}

UsbfsNode* Bus::node_of(UMockdevIoctlClient* client) {
    if (const auto known = clients_.find(client); known != clients_.end()) return known->second;
    const std::string node = umockdev_ioctl_client_get_devnode(client);
    for (auto& [port, socket] : sockets_)
        if (socket.node == node) return clients_[client] = socket.usbfs.get();
    return nullptr;
}

void Bus::handle(UMockdevIoctlClient* client) {
    // umockdev's worker represents the kernel, which a busy machine does not delay either: real-time
    // priority, if allowed.
    thread_local const int promoted = [] {
        const sched_param real_time{.sched_priority = 60};
        return pthread_setschedparam(pthread_self(), SCHED_FIFO, &real_time);
    }();
    static_cast<void>(promoted);
    UsbfsNode::Call call;
    call.client = client;
    call.request = umockdev_ioctl_client_get_request(client);
    UMockdevIoctlData* pointer = umockdev_ioctl_client_get_arg(client);
    std::memcpy(&call.value, pointer->data, sizeof call.value);
    const std::size_t bytes = argument_bytes(call.request);
    call.argument = resolve(pointer, 0, bytes);
    Result result{.value = -1, .error = EFAULT};
    if (bytes == 0 || call.argument != nullptr) {
        if (call.request == USBDEVFS_SUBMITURB) call.urb = submitted(call);
        if (call.request == USBDEVFS_BULK) call.urb = synchronous(call, frame());
        const bool whole =
            call.urb != nullptr || (call.request != USBDEVFS_SUBMITURB && call.request != USBDEVFS_BULK);
        const std::lock_guard lock(mutex_);
        calls_.fetch_add(1, std::memory_order_acq_rel);
        forget_freed();
        UsbfsNode* node = node_of(client);
        if (whole)
            result =
                node == nullptr ? Result{.value = -1, .error = ENODEV} : node->call(call, frame(), frozen_);
        if (held_) frame_passed_.notify_all();
    }
    if (!result.later) umockdev_ioctl_client_complete(client, result.value, result.error);
    if (call.argument != nullptr) g_object_unref(call.argument);
}

void Bus::pass_frame() {
    const std::uint64_t frame = frame_.fetch_add(1, std::memory_order_acq_rel) + 1;
    for (auto& [port, socket] : sockets_) {
        socket.usbfs->model().frame(frame);
        socket.usbfs->serve(frame);
    }
}

void Bus::run() {
    timespec due{};
    clock_gettime(CLOCK_MONOTONIC, &due);
    while (!stop_) {
        // No catching up: a frame that a busy machine missed never existed.
        timespec now{};
        clock_gettime(CLOCK_MONOTONIC, &now);
        due.tv_nsec += frame_ns;
        if (due.tv_nsec >= 1'000'000'000) {
            due.tv_nsec -= 1'000'000'000;
            ++due.tv_sec;
        }
        if (now.tv_sec > due.tv_sec || (now.tv_sec == due.tv_sec && now.tv_nsec > due.tv_nsec)) due = now;
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
        std::vector<std::string> pull;
        {
            const std::lock_guard lock(mutex_);
            forget_freed();
            if (!frozen_ && !held_) pass_frame();
            pull.swap(unplug_soon_);
        }
        frame_passed_.notify_all();
        for (const std::string& port : pull) unplug(port);
    }
}

}  // namespace knurl::drivers::usb_emulator
