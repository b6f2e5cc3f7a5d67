// knurl_dds_fast_peer DOMAIN WHAT TOPIC ...: a process of a DDS domain on another vendor's engine, Fast DDS, which ROS 2 uses by
// default. Its messages are written here from the rules of CDR alone. It reaches 127.0.0.1 only, as with ROS_LOCALHOST_ONLY.
//   read TOPIC N             N poses of a topic, then "frame X, position X Y Z"
//   push TOPIC X Y Z         wrenches at 200 Hz, until it is killed

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include <fastcdr/Cdr.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

namespace {

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
namespace cdr = eprosima::fastcdr;

/// A header and numbers: PoseStamped has 7, WrenchStamped 6.
template <std::size_t N>
struct Stamped {
    std::int32_t seconds = 0;
    std::uint32_t nanoseconds = 0;
    std::string frame;
    std::array<double, N> numbers{};
};

template <std::size_t N>
class StampedType final : public fast::TopicDataType {
  public:
    explicit StampedType(const char* name) {
        setName(name);
        m_typeSize = room;
        m_isGetKeyDefined = false;
    }
    bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
        const auto& message = *static_cast<const Stamped<N>*>(data);
        cdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
        cdr::Cdr out(buffer, cdr::Cdr::DEFAULT_ENDIAN, cdr::Cdr::DDS_CDR);
        payload->encapsulation = CDR_LE;
        out.serialize_encapsulation();
        out << message.seconds << message.nanoseconds << message.frame << message.numbers;
        payload->length = static_cast<std::uint32_t>(out.getSerializedDataLength());
        return true;
    }
    bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
        auto& message = *static_cast<Stamped<N>*>(data);
        cdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->length);
        cdr::Cdr in(buffer, cdr::Cdr::DEFAULT_ENDIAN, cdr::Cdr::DDS_CDR);
        in.read_encapsulation();
        in >> message.seconds >> message.nanoseconds >> message.frame >> message.numbers;
        return true;
    }
    std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
        return [] { return room; };
    }
    void* createData() override { return new Stamped<N>; }
    void deleteData(void* data) override { delete static_cast<Stamped<N>*>(data); }
    bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }

  private:
    static constexpr std::uint32_t room = 512;
};

/// On 127.0.0.1, whose participants it asks directly: loopback has no multicast.
fast::DomainParticipant* join(std::uint32_t domain) {
    fast::DomainParticipantQos qos;
    auto loopback = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    loopback->interfaceWhiteList.emplace_back("127.0.0.1");
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(loopback);
    for (std::uint32_t participant = 0; participant < 10; ++participant) {
        rtps::Locator_t peer;
        rtps::IPLocator::setIPv4(peer, "127.0.0.1");
        // Port of unicast discovery: DDSI-RTPS 2.3, section 9.6.1.1.
        peer.port = 7400 + 250 * domain + 10 + 2 * participant;
        qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    }
    return fast::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
}

template <std::size_t N>
fast::Topic* topic_of(fast::DomainParticipant* participant, const char* name, const char* type) {
    fast::TypeSupport support(new StampedType<N>(type));
    support.register_type(participant);
    return participant->create_topic(name, type, fast::TOPIC_QOS_DEFAULT);
}

int read(fast::DomainParticipant* participant, char** words) {
    fast::Topic* topic = topic_of<7>(participant, words[0], "geometry_msgs::msg::dds_::PoseStamped_");
    fast::DataReaderQos qos;
    qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    fast::DataReader* reader =
        participant->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT)->create_datareader(topic, qos);
    Stamped<7> pose;
    fast::SampleInfo info;
    for (int left = std::atoi(words[1]); left > 0;) {
        reader->wait_for_unread_message({1, 0});
        while (left > 0 && reader->take_next_sample(&pose, &info) == ReturnCode_t::RETCODE_OK)
            if (info.valid_data) --left;
    }
    std::printf("frame %s, position %.17g %.17g %.17g\n", pose.frame.c_str(), pose.numbers[0],
                pose.numbers[1], pose.numbers[2]);
    return 0;
}

int push(fast::DomainParticipant* participant, char** words) {
    fast::Topic* topic = topic_of<6>(participant, words[0], "geometry_msgs::msg::dds_::WrenchStamped_");
    fast::DataWriter* writer = participant->create_publisher(fast::PUBLISHER_QOS_DEFAULT)
                                   ->create_datawriter(topic, fast::DATAWRITER_QOS_DEFAULT);
    Stamped<6> wrench;
    for (std::size_t i = 0; i < 3; ++i) wrench.numbers[i] = std::atof(words[1 + i]);
    for (auto next = std::chrono::steady_clock::now();; next += std::chrono::milliseconds(5)) {
        std::this_thread::sleep_until(next);
        writer->write(&wrench);
    }
}

}  // namespace

int main(int count, char** words) {
    const std::string what = count > 2 ? words[2] : "";
    if (!(what == "read" && count == 5) && !(what == "push" && count == 7)) {
        std::fputs("usage: knurl_dds_fast_peer DOMAIN read TOPIC N | push TOPIC X Y Z\n", stderr);
        return 2;
    }
    fast::DomainParticipant* participant = join(static_cast<std::uint32_t>(std::atoi(words[1])));
    if (participant == nullptr) return 1;
    const int code = what == "read" ? read(participant, words + 3) : push(participant, words + 3);
    std::fflush(stdout);
    std::_Exit(code);  // the engine's threads end with the process
}
