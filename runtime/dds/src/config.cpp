#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include <knurl/bridge/host_and_port.hpp>
#include <knurl/dds/config.hpp>
#include <knurl/protocol/name.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>
#include <knurl/words/toml.hpp>

namespace knurl::dds {

namespace {

/// Reads tables and says where in the file what is wrong.
class ConfigReader {
  public:
    explicit ConfigReader(const std::string& path) : path_(path) {}

    std::runtime_error error(const toml::source_region& at, const std::string& what) const {
        return std::runtime_error(fmt::format("{}:{}:{}: {}", path_, at.begin.line, at.begin.column, what));
    }
    std::runtime_error unknown(const toml::key& key, const std::vector<std::string_view>& known) const {
        return error(key.source(),
                     fmt::format("unknown key \"{}\"; {}", words::printable(key.str(), 60),
                                 words::did_you_mean(key.str(), known,
                                                     fmt::format("known here: {}", fmt::join(known, ", ")))));
    }
    std::string text(const toml::node& node, std::string_view key) const {
        if (const auto value = node.value_exact<std::string>()) return *value;
        throw error(node.source(), fmt::format("{} must be a string", key));
    }
    double number(const toml::node& node, std::string_view key, double low, double high) const {
        const auto value = node.value<double>();
        if (!value || !node.is_number() || !(*value >= low && *value <= high))
            throw error(node.source(), fmt::format("{} must be a number from {:g} to {:g}", key, low, high));
        return *value;
    }
    bool truth(const toml::node& node, std::string_view key) const {
        if (const auto value = node.value_exact<bool>()) return *value;
        throw error(node.source(), fmt::format("{} must be true or false", key));
    }
    const toml::table& table(const toml::node& node, std::string_view key) const {
        if (const toml::table* found = node.as_table()) return *found;
        throw error(node.source(), fmt::format("{} must be a table", key));
    }
    std::vector<std::string> texts(const toml::node& node, std::string_view key) const {
        const toml::array* all = node.as_array();
        if (all == nullptr) throw error(node.source(), fmt::format("{} must be an array of strings", key));
        std::vector<std::string> found;
        for (const toml::node& each : *all) found.push_back(text(each, key));
        return found;
    }
    std::string name(const toml::node& node, std::string_view key) const {
        const std::string value = text(node, key);
        if (!protocol::is_name(value))
            throw error(node.source(), fmt::format("{} = \"{}\" is no name; use letters, digits, _ . and -",
                                                   key, words::printable(value, 60)));
        return value;
    }
    std::chrono::nanoseconds time(const toml::node& node, std::string_view key) const {
        return std::chrono::nanoseconds(std::llround(number(node, key, 0.001, 10) * 1e9));
    }

  private:
    const std::string& path_;
};

/// A name of ROS: letters, digits, _ and /.
void require_topic(const ConfigReader& read, const toml::source_region& at, const std::string& name) {
    constexpr std::string_view legal = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_/";
    if (name.empty() || name.find_first_not_of(legal) != std::string::npos || name.ends_with('/') ||
        name.find("//") != std::string::npos)
        throw read.error(at, fmt::format("\"{}\" is no name of a topic; use letters, digits, _ and /",
                                         words::printable(name, 60)));
}

CommandRule command_rule(const ConfigReader& read, const toml::table& table) {
    static const std::vector<std::string_view> known{"device",   "from",    "deadline",
                                                     "lifespan", "enabled", "representations"};
    CommandRule rule;
    for (auto&& [key, node] : table) {
        const std::string_view said = key.str();
        if (said == "device")
            rule.device = read.name(node, said);
        else if (said == "from")
            rule.from = read.texts(node, said);
        else if (said == "deadline")
            rule.deadline = read.time(node, said);
        else if (said == "lifespan")
            rule.lifespan = read.time(node, said);
        else if (said == "enabled")
            rule.enabled = read.truth(node, said);
        else if (said == "representations")
            rule.representations = read.texts(node, said);
        else
            throw read.unknown(key, known);
    }
    if (rule.device.empty())
        throw read.error(table.source(), "[[command]] names no device; add device = \"NAME\"");
    return rule;
}

void read_commands(const ConfigReader& read, const toml::node& node, Config& config) {
    const toml::array* all = node.as_array();
    if (all == nullptr)
        throw read.error(node.source(), "command must be an array of tables; write [[command]]");
    for (const toml::node& each : *all)
        config.robot.commands.push_back(command_rule(read, read.table(each, "command")));
}

void read_rates(const ConfigReader& read, const toml::table& table, Config& config) {
    std::vector<std::string_view> known;
    for (const auto& [name, rate] : default_rates()) known.push_back(name);
    for (auto&& [key, node] : table) {
        const std::string name(key.str());
        if (!default_rates().contains(name)) throw read.unknown(key, known);
        config.robot.rates[name] = read.number(node, name, 0, name == "tf" ? 100 : 20000);
    }
}

void read_remap(const ConfigReader& read, const toml::table& table, Config& config) {
    for (auto&& [key, node] : table) {
        const std::string from(key.str()), to = read.text(node, from);
        require_topic(read, key.source(), from);
        require_topic(read, node.source(), to);
        config.robot.remap[from] = to;
    }
}

void read_key(const ConfigReader& read, const toml::key& key, const toml::node& node, Config& config) {
    static const std::vector<std::string_view> known{"servo",     "name",   "domain", "interface", "peers",
                                                     "namespace", "bridge", "rates",  "remap",     "command"};
    const std::string_view said = key.str();
    if (said == "servo") {
        config.robot.servo = read.text(node, said);
    } else if (said == "name") {
        config.name = read.name(node, said);
    } else if (said == "domain") {
        config.domain.id = static_cast<std::uint32_t>(read.number(node, said, 0, 232));
    } else if (said == "interface") {
        config.domain.interface = read.text(node, said);
    } else if (said == "peers") {
        config.domain.peers = read.texts(node, said);
    } else if (said == "namespace") {
        config.robot.name_space = read.text(node, said);
        require_topic(read, node.source(), config.robot.name_space);
    } else if (said == "bridge") {
        config.bridge = read.text(node, said);
        try {
            bridge::check_host_and_port(config.bridge);
        } catch (const std::runtime_error& wrong) {
            throw read.error(node.source(), fmt::format("bridge: {}", wrong.what()));
        }
    } else if (said == "rates") {
        read_rates(read, read.table(node, said), config);
    } else if (said == "remap") {
        read_remap(read, read.table(node, said), config);
    } else if (said == "command") {
        read_commands(read, node, config);
    } else {
        throw read.unknown(key, known);
    }
}

}  // namespace

void read_config_text(const std::string& text, const std::string& path, Config& config) {
    const toml::table table = words::parse_toml(text, path);
    const ConfigReader read(path);
    Config made = config;  // nothing of a file that is wrong
    for (auto&& [key, node] : table) read_key(read, key, node, made);
    config = std::move(made);
}

void read_config(const std::filesystem::path& file, Config& config) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || !std::filesystem::is_regular_file(file))
        throw std::runtime_error(
            fmt::format("{}: cannot be read; is it a file that this user may read?", file.string()));
    read_config_text(text.str(), file.string(), config);
}

std::string default_name(const std::string& servo, const std::string& host) {
    return servo == "default" && protocol::is_name(host) ? host : servo;
}

}  // namespace knurl::dds
