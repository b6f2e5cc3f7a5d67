#include "device_commands.hpp"

#include <algorithm>
#include <cstring>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/messages/channels.hpp>
#include <knurl/words/nearest.hpp>

#include "kind_message.hpp"
#include "knurl_msgs.h"
#include "ros_messages.h"
#include "wire_text.hpp"

namespace knurl::dds {

namespace {

constexpr std::size_t most_peers_known = 256;

Vec3 plain(const geometry_msgs_msg_dds__Vector3_& v) {
    return {v.x, v.y, v.z};
}

Head head(const std_msgs_msg_dds__Header_& header) {
    return {.frame = said(header.frame_id),
            .stamp_ns = std::int64_t{header.stamp.sec} * 1'000'000'000 + header.stamp.nanosec};
}

/// The kinds that a rule names.
std::vector<const KindMessage*> kinds_of(const CommandRule& rule) {
    std::vector<const KindMessage*> found;
    std::vector<std::string_view> names;
    for (const KindMessage& message : kind_messages()) {
        const std::string_view name = kinds()[message.kind].name;
        names.push_back(name);
        const auto& wanted = rule.representations;
        if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end())
            found.push_back(&message);
    }
    for (const std::string& name : rule.representations)
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw std::runtime_error(fmt::format(
                "representations of '{}': no message is called '{}'; {}", rule.device, name,
                words::did_you_mean(name, names, fmt::format("there are {}", fmt::join(names, ", ")))));
    return found;
}

}  // namespace

DeviceCommands::DeviceCommands(Domain& domain, const RobotOptions& options, const CommandRule& rule,
                               CommandOptions desk)
    : domain_(domain), desk_(std::move(desk)) {
    const std::string device = messages::ros_name(rule.device) + "/";
    const auto topic = [&](const std::string& name) { return dds_topic(options, device + name); };
    for (const bool body : {false, true})
        add(domain, topic(body ? "body/servo_cf" : "servo_cf"), "geometry_msgs/msg/WrenchStamped",
            geometry_msgs_msg_dds__WrenchStamped__desc, [this, body](const Origin& from, const void* sample) {
                const auto& said = *static_cast<const geometry_msgs_msg_dds__WrenchStamped_*>(sample);
                desk_.force(from, head(said.header), plain(said.wrench.force), plain(said.wrench.torque),
                            body);
            });
    add(domain, topic("servo_cp"), "geometry_msgs/msg/PoseStamped", geometry_msgs_msg_dds__PoseStamped__desc,
        [this](const Origin& from, const void* sample) {
            const auto& said = *static_cast<const geometry_msgs_msg_dds__PoseStamped_*>(sample);
            const auto& p = said.pose.position;
            desk_.place(from, head(said.header), {p.x, p.y, p.z});
        });
    add(domain, topic("state_command"), "crtk_msgs/msg/StringStamped", crtk_msgs_msg_dds__StringStamped__desc,
        [this](const Origin& from, const void* sample) {
            desk_.word(from, said(static_cast<const crtk_msgs_msg_dds__StringStamped_*>(sample)->string));
        });
    add(domain, topic("hold"), "std_msgs/msg/Empty", std_msgs_msg_dds__Empty__desc,
        [this](const Origin& from, const void*) { desk_.hold(from); });
    add(domain, topic("free"), "std_msgs/msg/Empty", std_msgs_msg_dds__Empty__desc,
        [this](const Origin& from, const void*) { desk_.free(from); });
    add(domain, topic("representation/remove"), "knurl_msgs/msg/Remove", knurl_msgs_msg_dds__Remove__desc,
        [this](const Origin& from, const void* sample) {
            desk_.remove(from, said(static_cast<const knurl_msgs_msg_dds__Remove_*>(sample)->id));
        });
    for (const KindMessage* kind : kinds_of(rule)) {
        const std::string message = fmt::format("knurl_msgs/msg/{}", kind->type);
        add(domain, topic(fmt::format("representation/{}", kinds()[kind->kind].name)), message.c_str(),
            *kind->descriptor, [this, kind](const Origin& from, const void* sample) {
                const auto* bytes = static_cast<const std::byte*>(sample);
                std::vector<std::byte> params;
                if (const std::string wrong = read_params(*kind, sample, params); !wrong.empty())
                    return desk_.refuse(from, wrong);
                const char* id = nullptr;
                std::uint32_t probe = 0;
                std_msgs_msg_dds__Header_ header;
                std::memcpy(&id, bytes + kind->id, sizeof id);
                std::memcpy(&probe, bytes + kind->probe, sizeof probe);
                std::memcpy(&header, bytes + kind->header, sizeof header);
                desk_.put(from, head(header), said(id), probe, kind->kind, params);
            });
    }
}

void DeviceCommands::add(Domain& domain, const std::string& topic, const char* message,
                         const dds_topic_descriptor_t& type,
                         std::function<void(const Origin&, const void*)> handle) {
    auto input = std::make_unique<Input>();
    input->message = message;
    // Best effort matches writers of both kinds; of a force only the newest counts. Several things are put or removed at once.
    const bool one = topic.find("/representation/") == std::string::npos;
    input->reader =
        domain.reader(topic, type, {.message = message, .reliable = false, .depth = one ? 1 : 32});
    input->take = [this, handle = std::move(handle), raw = input.get()](const Input& self) {
        for (;;) {
            const Taken<char> taken(self.reader.get());
            for (std::size_t i = 0; i < taken.size(); ++i)
                if (taken.info(i).valid_data)
                    if (const Origin from = origin(*raw, taken.info(i)); !from.id.empty())
                        handle(from, &taken[i]);
            if (taken.size() < 32) return;
        }
    };
    inputs_.push_back(std::move(input));
}

void DeviceCommands::attach(dds_entity_t waitset) {
    for (auto& input : inputs_) {
        input->condition =
            Entity(dds_create_readcondition(input->reader.get(), DDS_ANY_STATE), "read condition");
        check(dds_waitset_attach(waitset, input->condition.get(), 0), "waitset");
    }
}

Origin DeviceCommands::origin(Input& input, const dds_sample_info_t& info) {
    auto found = input.peers.find(info.publication_handle);
    if (found == input.peers.end()) {
        if (input.peers.size() >= most_peers_known) input.peers.clear();
        found = input.peers
                    .emplace(info.publication_handle,
                             peer_of(input.reader.get(), info.publication_handle, input.message))
                    .first;
        if (!found->second.wrong_type.empty()) domain_.say(found->second.wrong_type);
    }
    const Peer& peer = found->second;
    if (!peer.wrong_type.empty()) return {};
    return {.id = peer.id, .text = peer.text, .host = peer.host, .written_ns = info.source_timestamp};
}

void DeviceCommands::take() {
    for (auto& input : inputs_) input->take(*input);
}

bool DeviceCommands::anybody_there() const {
    return std::any_of(inputs_.begin(), inputs_.end(), [](const auto& input) {
        dds_subscription_matched_status_t status{};
        return dds_get_subscription_matched_status(input->reader.get(), &status) == DDS_RETCODE_OK &&
               status.current_count > 0;
    });
}

void DeviceCommands::look_for_gone() {
    const std::vector<std::string> held = desk_.peers();
    if (held.empty()) return;
    std::set<std::string> here;
    for (auto& input : inputs_) {
        std::vector<dds_instance_handle_t> writers(most_peers_known);
        const dds_return_t count =
            dds_get_matched_publications(input->reader.get(), writers.data(), writers.size());
        for (std::size_t i = 0;
             i < std::min<std::size_t>(static_cast<std::size_t>(std::max(count, 0)), writers.size()); ++i)
            if (const auto known = input->peers.find(writers[i]); known != input->peers.end())
                here.insert(known->second.id);
    }
    for (const std::string& id : held)
        if (!here.contains(id)) desk_.gone(id);
}

}  // namespace knurl::dds
