#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <knurl/dds/domain.hpp>
#include <knurl/dds/type_hash.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::dds {

namespace {

constexpr std::uint32_t last_domain = 232;
// Of a domain on one host: those whose ports discovery asks one by one, and those that there are ports for
// (DDSI-RTPS 2.3, section 9.6.1.1: 250 of a domain, two for each).
constexpr int most_asked = 32, most_of_a_host = 120;

/// What is found of an interface that was named.
struct Interface {
    bool found = false, loopback = false, multicast = false;
};

std::string address_of(const ifaddrs& at) {
    std::array<char, INET_ADDRSTRLEN> text{};
    if (at.ifa_addr == nullptr || at.ifa_addr->sa_family != AF_INET) return {};
    sockaddr_in in{};
    std::memcpy(&in, at.ifa_addr, sizeof in);
    return ::inet_ntop(AF_INET, &in.sin_addr, text.data(), text.size());
}

Interface look_for(const std::string& said) {
    Interface is;
    ifaddrs* all = nullptr;
    if (::getifaddrs(&all) != 0) return is;
    for (const ifaddrs* each = all; each != nullptr; each = each->ifa_next) {
        const std::string address = address_of(*each);
        if (address.empty() || (address != said && each->ifa_name != said)) continue;
        is = {.found = true,
              .loopback = (each->ifa_flags & IFF_LOOPBACK) != 0,
              .multicast = (each->ifa_flags & IFF_MULTICAST) != 0};
    }
    ::freeifaddrs(all);
    return is;
}

std::string interface_of(const DomainOptions& options) {
    return options.interface.empty() ? "127.0.0.1" : options.interface;
}

bool is_address(const std::string& text) {
    in_addr ignored{};
    return ::inet_pton(AF_INET, text.c_str(), &ignored) == 1;
}

/// Into an attribute of XML: what is neither a letter, a digit nor . : - _ cannot be an address or a name.
std::string attribute(const std::string& text) {
    if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.:-_") !=
            std::string::npos ||
        text.empty())
        throw std::runtime_error(
            fmt::format("'{}' is neither an address nor a name", words::printable(text, 60)));
    return text;
}

void cyclone_says(void* self, const dds_log_data_t* data) {
    std::string line(data->message, data->size);
    while (!line.empty() && line.back() == '\n') line.pop_back();
    static_cast<const Domain*>(self)->say("DDS: " + words::printable(line, 300));
}

Qos qos_of(const EndpointOptions& options, bool reader) {
    Qos qos = make_qos();
    constexpr dds_duration_t longest_block = DDS_MSECS(1);  // a slow reader does not hold up what it reads
    dds_qset_reliability(qos.get(), options.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                         longest_block);
    dds_qset_durability(qos.get(),
                        options.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, options.depth);
    if (options.liveliness.count() > 0)
        dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, options.liveliness.count());
    if (!options.message.empty()) {
        const std::string data = user_data(options.message);
        dds_qset_userdata(qos.get(), data.data(), data.size());
    }
    if (!reader) dds_qset_writer_data_lifecycle(qos.get(), true);
    return qos;
}

}  // namespace

dds_return_t check(dds_return_t code, std::string_view what) {
    if (code >= 0) return code;
    throw std::runtime_error(fmt::format("{}: {}", what, dds_strretcode(code)));
}

std::uint32_t domain_of_environment() {
    const char* said = std::getenv("ROS_DOMAIN_ID");
    if (said == nullptr || *said == '\0') return 0;
    std::uint32_t id = 0;
    const char* end = said + std::strlen(said);
    const auto [at, error] = std::from_chars(said, end, id);
    if (error != std::errc() || at != end || id > last_domain)
        throw std::runtime_error(fmt::format("ROS_DOMAIN_ID is '{}'; set it to a number from 0 to {}",
                                             words::printable(said, 60), last_domain));
    return id;
}

namespace {

int most_processes(const Interface& is, const DomainOptions& options) {
    return is.loopback || !options.peers.empty() ? most_asked : most_of_a_host;
}

}  // namespace

std::string cyclone_configuration(const DomainOptions& options) {
    const std::string said = interface_of(options);
    const Interface is = look_for(said);
    std::string peers;
    if (is.loopback) peers += R"(<Peer address="127.0.0.1"/>)";
    for (const std::string& peer : options.peers)
        peers += fmt::format(R"(<Peer address="{}"/>)", attribute(peer));
    // The participant takes the ports of an index in place of free ones: a host that multicast does not reach looks for
    // it at these.
    return fmt::format(
        R"(<Domain id="{}"><General><Interfaces><NetworkInterface {}="{}"/></Interfaces><AllowMulticast>{}</AllowMulticast></General>)"
        R"(<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex>)"
        R"(<Peers>{}</Peers><LeaseDuration>{} ms</LeaseDuration><SPDPInterval>{} ms</SPDPInterval></Discovery>)"
        R"(<Internal><Test><XmitLossiness>{}</XmitLossiness></Test></Internal></Domain>)",
        options.id, is_address(said) ? "address" : "name", attribute(said),
        is.multicast && !is.loopback ? "true" : "false", most_processes(is, options) - 1, peers,
        options.lease.count(), options.announce.count(), options.lose);
}

struct Domain::Impl {
    DomainOptions options;
    Entity domain;
    Entity participant;
    mutable std::mutex mutex;
    mutable std::map<std::string, std::chrono::steady_clock::time_point> said;
    std::map<std::string, Entity> topics;

    dds_entity_t topic(const std::string& name, const dds_topic_descriptor_t& type) {
        const std::scoped_lock lock(mutex);
        auto found = topics.find(name);
        if (found == topics.end())
            found = topics
                        .emplace(name, Entity(dds_create_topic(participant.get(), &type, name.c_str(),
                                                               nullptr, nullptr),
                                              fmt::format("topic {} of type {}", name, type.m_typename)))
                        .first;
        return found->second.get();
    }
};

namespace {

/// The name of the topic of a reader or writer.
std::string topic_name(dds_entity_t endpoint) {
    std::array<char, 256> name{};
    const dds_entity_t topic = dds_get_topic(endpoint);
    if (topic > 0) dds_get_name(topic, name.data(), name.size());
    return name.data();
}

std::string policy_name(std::uint32_t policy) {
    switch (policy) {
        case DDS_RELIABILITY_QOS_POLICY_ID:
            return "reliability";
        case DDS_DURABILITY_QOS_POLICY_ID:
            return "durability";
        case DDS_DEADLINE_QOS_POLICY_ID:
            return "deadline";
        case DDS_LIVELINESS_QOS_POLICY_ID:
            return "liveliness";
        case DDS_OWNERSHIP_QOS_POLICY_ID:
            return "ownership";
        case DDS_DATA_REPRESENTATION_QOS_POLICY_ID:
            return "data representation (XCDR version)";
        default:
            return fmt::format("policy {}", policy);
    }
}

void incompatible_writer(dds_entity_t reader, dds_requested_incompatible_qos_status_t status, void* self) {
    static_cast<const Domain*>(self)->say(
        fmt::format("a writer of {} offers another {} than is read here: its messages do not come",
                    topic_name(reader), policy_name(status.last_policy_id)));
}
void incompatible_reader(dds_entity_t writer, dds_offered_incompatible_qos_status_t status, void* self) {
    static_cast<const Domain*>(self)->say(
        fmt::format("a reader of {} asks for another {} than is written (reliable, volatile, keep last 1): "
                    "it gets nothing",
                    topic_name(writer), policy_name(status.last_policy_id)));
}

}  // namespace

Domain::Domain(DomainOptions options) : impl_(std::make_unique<Impl>()) {
    impl_->options = std::move(options);
    const DomainOptions& o = impl_->options;
    if (o.id > last_domain)
        throw std::runtime_error(fmt::format("domain {}: give 0 to {}", o.id, last_domain));
    const std::string said = interface_of(o);
    const Interface is = look_for(said);
    if (!is.found)
        throw std::runtime_error(fmt::format(
            "interface '{}': this host has none with that name or IPv4 address; `ip -br address` lists them",
            words::printable(said, 60)));
    dds_set_log_mask(DDS_LC_FATAL | DDS_LC_ERROR | DDS_LC_WARNING);
    dds_set_log_sink(&cyclone_says, this);
    if (!is.loopback && !is.multicast && o.peers.empty())
        say(fmt::format("interface {} has no multicast, so nobody is found; name the other hosts as peers",
                        said));
    impl_->domain =
        Entity(dds_create_domain(o.id, cyclone_configuration(o).c_str()), fmt::format("domain {}", o.id));
    std::unique_ptr<dds_listener_t, decltype(&dds_delete_listener)> listener(dds_create_listener(this),
                                                                             &dds_delete_listener);
    dds_lset_requested_incompatible_qos(listener.get(), &incompatible_writer);
    dds_lset_offered_incompatible_qos(listener.get(), &incompatible_reader);
    const dds_entity_t participant = dds_create_participant(o.id, nullptr, listener.get());
    if (participant < 0)
        throw std::runtime_error(
            fmt::format("domain {} cannot be joined at {} ({}); at most {} processes of a host can be found "
                        "by their ports",
                        o.id, said, dds_strretcode(participant), most_processes(is, o)));
    impl_->participant = Entity(participant, "participant");
}

Domain::~Domain() {
    impl_->topics.clear();
    impl_->participant = {};
    impl_->domain = {};
    dds_set_log_sink(nullptr, nullptr);
}

dds_entity_t Domain::participant() const {
    return impl_->participant.get();
}

const DomainOptions& Domain::options() const {
    return impl_->options;
}

void Domain::say(const std::string& line) const {
    constexpr std::chrono::seconds again{60};
    constexpr std::size_t most = 256;
    const auto now = std::chrono::steady_clock::now();
    const std::scoped_lock lock(impl_->mutex);
    const auto found = impl_->said.find(line);
    if (found != impl_->said.end() && now - found->second < again) return;
    if (impl_->said.size() >= most) impl_->said.clear();
    impl_->said[line] = now;
    impl_->options.log(line);
}

Entity Domain::writer(const std::string& topic, const dds_topic_descriptor_t& type,
                      const EndpointOptions& options) {
    const Qos qos = qos_of(options, false);
    return {dds_create_writer(participant(), impl_->topic(topic, type), qos.get(), nullptr),
            "writer of " + topic};
}

Entity Domain::reader(const std::string& topic, const dds_topic_descriptor_t& type,
                      const EndpointOptions& options) {
    const Qos qos = qos_of(options, true);
    return {dds_create_reader(participant(), impl_->topic(topic, type), qos.get(), nullptr),
            "reader of " + topic};
}

namespace {

std::string property(const dds_qos_t* qos, const char* name) {
    char* value = nullptr;
    if (qos == nullptr || !dds_qget_prop(qos, name, &value) || value == nullptr) return {};
    std::string text = words::printable(value, 60);
    dds_free(value);
    return text;
}

std::string guid_text(const dds_guid_t& guid) {
    std::string text;
    for (const std::uint8_t byte : guid.v) text += fmt::format("{:02x}", byte);
    return text;
}

std::string user_data_of(const dds_qos_t* qos) {
    void* data = nullptr;
    std::size_t size = 0;
    if (qos == nullptr || !dds_qget_userdata(qos, &data, &size) || data == nullptr) return {};
    std::string text(static_cast<const char*>(data), size);
    dds_free(data);
    return text;
}

/// What the participant says of itself.
void describe(Peer& peer, dds_entity_t reader, dds_instance_handle_t participant) {
    const dds_entity_t built_in =
        dds_create_reader(dds_get_participant(reader), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr);
    if (built_in < 0) return;
    void* sample = nullptr;
    dds_sample_info_t info;
    if (dds_read_instance(built_in, &sample, &info, 1, 1, participant) == 1) {
        if (info.valid_data) {
            const auto* said = static_cast<const dds_builtintopic_participant_t*>(sample);
            peer.host = property(said->qos, "__Hostname");
            const std::string process = property(said->qos, "__ProcessName"),
                              pid = property(said->qos, "__Pid");
            peer.text = process;
            if (!peer.host.empty()) peer.text += "@" + peer.host;
            if (!pid.empty()) peer.text += " pid " + pid;
        }
        dds_return_loan(built_in, &sample, 1);
    }
    dds_delete(built_in);
}

}  // namespace

Peer peer_of(dds_entity_t reader, dds_instance_handle_t writer, std::string_view message) {
    Peer peer;
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, writer);
    if (endpoint == nullptr) return peer;
    peer.id = guid_text(endpoint->participant_key);
    describe(peer, reader, endpoint->participant_instance_handle);
    if (peer.text.empty()) peer.text = "participant " + peer.id.substr(0, 24);
    const std::optional<std::string> theirs = hash_in(user_data_of(endpoint->qos));
    const std::string ours = message.empty() ? std::string() : type_hash(message);
    if (theirs && !message.empty() && *theirs != ours)
        peer.wrong_type = fmt::format(
            "{} writes {} as another type than {} is here (its hash {}, ours {}): its messages are ignored; "
            "build it "
            "with the same message definitions",
            peer.text, words::printable(endpoint->topic_name, 100), message, words::printable(*theirs, 80),
            ours);
    dds_builtintopic_free_endpoint(endpoint);
    return peer;
}

}  // namespace knurl::dds
