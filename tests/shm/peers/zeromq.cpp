#include <cstdio>
#include <stdexcept>

#include <unistd.h>

#include "transport.hpp"

#if KNURL_ZEROMQ
#include <zmq.h>
#endif

namespace knurl::shm::peers {

#if KNURL_ZEROMQ

namespace {

void require(bool good, const std::string& what) {
    if (!good) throw std::runtime_error("ZeroMQ: " + what + ": " + ::zmq_strerror(::zmq_errno()));
}

/// PUB and SUB: the usual choice for reports with any number of readers. With conflation a queue holds only
/// the newest message. (libzmq sets TCP_NODELAY itself.)
class ZeroMq final : public Transport {
  public:
    ZeroMq(const char* scheme, std::string place)
        : Transport(std::string("ZeroMQ ") + scheme,
                    [] {
                        int major = 0, minor = 0, patch = 0;
                        ::zmq_version(&major, &minor, &patch);
                        return "libzmq " + std::to_string(major) + "." + std::to_string(minor) + "." +
                               std::to_string(patch) +
                               ": PUB, SUB, CONFLATE on both, one I/O thread each, blocking zmq_recv()";
                    }()),
          place_(std::move(place)) {}
    ~ZeroMq() override {
        if (socket_ != nullptr) ::zmq_close(socket_);
        if (context_ != nullptr) ::zmq_ctx_term(context_);
    }
    void receive(Inbox& inbox) override {
        open(ZMQ_SUB);
        require(::zmq_setsockopt(socket_, ZMQ_SUBSCRIBE, "", 0) == 0, "subscribe");
        require(::zmq_bind(socket_, place_.c_str()) == 0, place_);
        char address[256];
        std::size_t bytes = sizeof address;
        require(::zmq_getsockopt(socket_, ZMQ_LAST_ENDPOINT, address, &bytes) == 0, "address");
        inbox.announce(address);
        for (Message message;;)
            if (::zmq_recv(socket_, &message, sizeof message, 0) == sizeof message) inbox.had(message);
    }
    void connect(const Inbox& inbox) override {
        open(ZMQ_PUB);
        require(::zmq_connect(socket_, inbox.announced().c_str()) == 0, inbox.announced());
    }
    void send(const Message& message) override {
        ::zmq_send(socket_, &message, sizeof message, ZMQ_DONTWAIT);
    }

  private:
    void open(int type) {
        context_ = ::zmq_ctx_new();
        require(context_ != nullptr, "context");
        socket_ = ::zmq_socket(context_, type);
        require(socket_ != nullptr, "socket");
        const int one = 1, none = 0;
        require(::zmq_setsockopt(socket_, ZMQ_CONFLATE, &one, sizeof one) == 0, "CONFLATE");
        require(::zmq_setsockopt(socket_, ZMQ_LINGER, &none, sizeof none) == 0, "LINGER");
    }

    std::string place_;
    void* context_ = nullptr;
    void* socket_ = nullptr;
};

}  // namespace

void add_zeromq(Transports& all) {
    // "@": a name without a file.
    all.push_back(std::make_unique<ZeroMq>("ipc", "ipc://@knurl-bench-peers-" + std::to_string(::getpid())));
    all.push_back(std::make_unique<ZeroMq>("tcp", "tcp://127.0.0.1:*"));
}

#else

void add_zeromq(Transports&) {
    std::fputs("knurl_bench_peers: ZeroMQ is left out: built without libzmq3-dev (scripts/setup --bench)\n",
               stderr);
}

#endif

}  // namespace knurl::shm::peers
