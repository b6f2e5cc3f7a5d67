#include <cstdio>
#include <cstring>
#include <stdexcept>

#include <unistd.h>

#include "transport.hpp"

#if KNURL_CYCLONE
#include <dds/dds.h>
#include <dds/version.h>

#include "report.h"
#endif

namespace knurl::shm::peers {

#if KNURL_CYCLONE

namespace {

static_assert(sizeof(knurl_bench_Report) == sizeof(Message));

// Loopback alone, no multicast. Data is delivered by the thread that receives it, which is the default.
constexpr const char* configuration =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>20</"
    "MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>";

dds_entity_t require(dds_entity_t entity, const char* what) {
    if (entity < 0)
        throw std::runtime_error(std::string("Cyclone DDS: ") + what + ": " + ::dds_strretcode(-entity));
    return entity;
}

/// This process's, made when it is first asked for.
dds_entity_t participant(dds_domainid_t domain) {
    static const dds_entity_t made = [domain] {
        require(::dds_create_domain(domain, configuration), "domain");
        return require(::dds_create_participant(domain, nullptr, nullptr), "participant");
    }();
    return made;
}

class Cyclone final : public Transport {
  public:
    /// A wait set wakes a thread of the application's; a listener is called by the library's own.
    enum class By { waitset, listener };
    explicit Cyclone(By by)
        : Transport(by == By::waitset ? "Cyclone DDS, waitset" : "Cyclone DDS, listener",
                    "Cyclone DDS " DDS_VERSION
                    ": best effort, keep last 1, 127.0.0.1, no multicast, shared memory (a daemon's) off; " +
                        std::string(by == By::waitset ? "dds_waitset_wait()" : "data-available listener")),
          by_(by),
          // Not another program's; one of those whose ports are below the ephemeral ones.
          domain_(static_cast<dds_domainid_t>(1 + ::getpid() % 90)) {}

    void receive(Inbox& inbox) override {
        const dds_entity_t topic = this->topic();
        dds_qos_t* const qos = quality();
        dds_listener_t* const listener = ::dds_create_listener(&inbox);
        if (by_ == By::listener)
            ::dds_lset_data_available(
                listener, [](dds_entity_t reader, void* to) { take(reader, *static_cast<Inbox*>(to)); });
        const dds_entity_t reader =
            require(::dds_create_reader(participant(domain_), topic, qos, listener), "reader");
        ::dds_delete_listener(listener);
        ::dds_delete_qos(qos);
        if (by_ == By::listener)
            for (;;) ::pause();
        const dds_entity_t waitset = require(::dds_create_waitset(participant(domain_)), "wait set");
        const dds_entity_t anything = require(::dds_create_readcondition(reader, DDS_ANY_STATE), "condition");
        require(::dds_waitset_attach(waitset, anything, 0), "wait set");
        for (;;)
            if (::dds_waitset_wait(waitset, nullptr, 0, DDS_INFINITY) >= 0) take(reader, inbox);
    }
    void connect(const Inbox&) override {
        dds_qos_t* const qos = quality();
        writer_ = require(::dds_create_writer(participant(domain_), topic(), qos, nullptr), "writer");
        ::dds_delete_qos(qos);
    }
    void send(const Message& message) override { ::dds_write(writer_, &message); }

  private:
    static dds_qos_t* quality() {
        dds_qos_t* const qos = ::dds_create_qos();
        ::dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
        ::dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
        return qos;
    }
    dds_entity_t topic() const {
        const std::string name = by_ == By::waitset ? "knurl_waitset" : "knurl_listener";
        return require(::dds_create_topic(participant(domain_), &knurl_bench_Report_desc, name.c_str(),
                                          nullptr, nullptr),
                       "topic");
    }
    static void take(dds_entity_t reader, Inbox& inbox) {
        Message message;
        void* samples[] = {&message};
        dds_sample_info_t info[1];
        while (::dds_take(reader, samples, info, 1, 1) == 1)
            if (info[0].valid_data) inbox.had(message);
    }

    By by_;
    dds_domainid_t domain_;
    dds_entity_t writer_ = 0;
};

}  // namespace

void add_cyclone(Transports& all) {
    all.push_back(std::make_unique<Cyclone>(Cyclone::By::waitset));
    all.push_back(std::make_unique<Cyclone>(Cyclone::By::listener));
}

#else

void add_cyclone(Transports&) {
    std::fputs(
        "knurl_bench_peers: Cyclone DDS is left out: built without cyclonedds-dev and cyclonedds-tools "
        "(scripts/setup --bench)\n",
        stderr);
}

#endif

}  // namespace knurl::shm::peers
