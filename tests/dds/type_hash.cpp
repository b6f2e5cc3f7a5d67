// What is said of message types: published hashes, and those that were computed by another program.

#include <gtest/gtest.h>

#include <knurl/dds/type_hash.hpp>
#include <knurl/reps/plane.hpp>

#include "kind_message.hpp"
#include "knurl_msgs.h"

namespace {

using namespace knurl;
using namespace knurl::dds;

TEST(DdsTypeHash, are_those_of_ros_2) {
    const std::map<std::string, std::string> published{
        {"std_msgs/msg/Empty", "20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312"},
        {"geometry_msgs/msg/PoseStamped", "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"},
        {"geometry_msgs/msg/TwistStamped",
         "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"},
        {"geometry_msgs/msg/WrenchStamped",
         "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"},
        {"geometry_msgs/msg/TransformStamped",
         "0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206"},
        {"tf2_msgs/msg/TFMessage", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
        {"sensor_msgs/msg/JointState", "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"},
        {"sensor_msgs/msg/Joy", "0d356c79cad3401e35ffeb75a96a96e08be3ef896b8b83841d73e890989372c5"},
        {"diagnostic_msgs/msg/DiagnosticArray",
         "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
        {"crtk_msgs/msg/OperatingState", "5cc57eea589b217fe5194bf2735b91d4a7f2dd5ac1245ae657f7ea7590c2c80e"},
        {"crtk_msgs/msg/StringStamped", "83efb802e6596e03f69ac322e3231037329946f2bd13ed48874d97f5b8f5db1d"},
    };
    for (const auto& [name, hash] : published) EXPECT_EQ(type_hash(name), "RIHS01_" + hash) << name;
}

TEST(DdsTypeHash, is_found_in_user_data_and_nowhere_else) {
    EXPECT_EQ(user_data("std_msgs/msg/Empty"), "typehash=" + type_hash("std_msgs/msg/Empty") + ";");
    EXPECT_EQ(hash_in("enclave=/;typehash=RIHS01_ab;x=1;"), "RIHS01_ab");
    EXPECT_EQ(hash_in("typehash=RIHS01_ab"), "RIHS01_ab");
    EXPECT_EQ(hash_in("enclave=/;"), std::nullopt);
    EXPECT_THROW(type_hash("geometry_msgs/msg/Nothing"), std::runtime_error);
    EXPECT_EQ(dds_type_name("geometry_msgs/msg/Pose"), "geometry_msgs::msg::dds_::Pose_");
}

TEST(DdsKinds, have_a_message_each_but_those_of_a_mesh) {
    EXPECT_EQ(kind_messages().size() + 1, kinds().size());
    for (const KindMessage& message : kind_messages()) {
        EXPECT_EQ(message.fields.size(), kinds()[message.kind].fields.size());
        EXPECT_EQ(message.descriptor->m_typename,
                  dds_type_name("knurl_msgs/msg/" + std::string(message.type)));
        EXPECT_NE(type_hash("knurl_msgs/msg/" + std::string(message.type)), "");
    }
}

const KindMessage& message_of(std::string_view kind) {
    for (const KindMessage& message : kind_messages())
        if (kinds()[message.kind].name == kind) return message;
    throw std::runtime_error("no such kind");
}

TEST(DdsKinds, a_plane_is_read_as_the_client_states_it) {
    knurl_msgs_msg_dds__Plane_ sent{};
    sent.normal = {.x = 0, .y = 0, .z = 1};
    sent.offset = 0.01;
    sent.stiffness = 800;
    sent.recovery = -1;
    std::vector<std::byte> params;
    ASSERT_EQ(read_params(message_of("plane"), &sent, params), "");
    ASSERT_EQ(params.size(), sizeof(Plane));
    Plane plane;
    std::memcpy(&plane, params.data(), sizeof plane);
    EXPECT_EQ(plane.normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(plane.offset, 0.01);
    EXPECT_EQ(plane.stiffness, 800);
    EXPECT_EQ(plane.recovery, automatic);
    EXPECT_EQ(plane.texture.wavelength, Plane{}.texture.wavelength) << "0 can mean nothing else";
    EXPECT_TRUE(kinds()[kind_number<Plane>()].validate(&plane));
    EXPECT_EQ(plane.damping, 0) << "what ROS does not state is 0; its .msg has the defaults";
}

TEST(DdsKinds, a_sequence_that_does_not_fit_is_refused_whatever_length_it_states) {
    knurl_msgs_msg_dds__Polygon_ sent{};
    std::vector<geometry_msgs_msg_dds__Vector3_> points(3);
    sent.vertices._buffer = points.data();
    std::vector<std::byte> params;
    for (const std::uint32_t length : {0u, 2u, 9u, 1000u, 4'000'000'000u}) {
        sent.vertices._length = sent.vertices._maximum = length;
        EXPECT_NE(read_params(message_of("polygon"), &sent, params).find("polygon.vertices has"),
                  std::string::npos)
            << length;
    }
    sent.vertices._length = sent.vertices._maximum = 3;
    EXPECT_EQ(read_params(message_of("polygon"), &sent, params), "");
}

}  // namespace
