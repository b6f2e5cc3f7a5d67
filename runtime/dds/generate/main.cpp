// knurl_dds_messages FOLDER: writes the messages of the representations from their tables: knurl_msgs.idl and
// kind_table.cpp for this build, and the ROS 2 package knurl_msgs (msg/*.msg) for others.

#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <locale>
#include <sstream>
#include <string>
#include <vector>

#include <knurl/reps/all.hpp>

namespace {

using knurl::Field;

struct KindMessage {
    const knurl::KindInfo* info = nullptr;
    std::vector<std::byte> defaults;
};

template <class R>
KindMessage message_of() {
    const R params{};
    KindMessage made{.info = &knurl::kinds()[knurl::kind_of<R>],
                     .defaults = std::vector<std::byte>(sizeof params)};
    std::memcpy(made.defaults.data(), &params, sizeof params);
    return made;
}

template <class... R>
std::vector<KindMessage> messages_of(knurl::TypeList<R...>) {
    return {message_of<R>()...};
}

/// "half_plane": "HalfPlane".
std::string type_name(std::string_view kind) {
    std::string name;
    bool up = true;
    for (const char c : kind) {
        if (c == '_') {
            up = true;
            continue;
        }
        name += up ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        up = false;
    }
    return name;
}

std::string member(const Field& field) {
    std::string name(field.name);
    for (char& c : name)
        if (c == '.') c = '_';
    return name;
}

/// A mesh cannot be sent in a message, so what is made of one cannot be added by it.
bool has_asset(const knurl::KindInfo& kind) {
    for (const Field& field : kind.fields)
        if (field.name == "asset") return true;
    return false;
}

std::string idl_type(const Field& field) {
    switch (field.type) {
        case Field::Type::real:
            return "double";
        case Field::Type::vector:
            return "geometry_msgs::msg::dds_::Vector3_";
        case Field::Type::quaternion:
            return "geometry_msgs::msg::dds_::Quaternion_";
        case Field::Type::choice:
        case Field::Type::integer:
            return "unsigned long";
        case Field::Type::matrix:
            return "sequence<double>";
        case Field::Type::points:
            return "sequence<geometry_msgs::msg::dds_::Vector3_>";
    }
    return {};
}

std::string msg_type(const Field& field) {
    switch (field.type) {
        case Field::Type::real:
            return "float64";
        case Field::Type::vector:
            return "geometry_msgs/Vector3";
        case Field::Type::quaternion:
            return "geometry_msgs/Quaternion";
        case Field::Type::choice:
        case Field::Type::integer:
            return "uint32";
        case Field::Type::matrix:
            return "float64[]";
        case Field::Type::points:
            return "geometry_msgs/Vector3[]";
    }
    return {};
}

/// " 800.0"; empty: ROS knows no default for this type, or it is 0.
std::string msg_default(const Field& field, const std::vector<std::byte>& defaults) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    if (field.type == Field::Type::real) {
        double value = 0;
        std::memcpy(&value, defaults.data() + field.offset, sizeof value);
        out << value;
        const std::string text = out.str();
        if (value == 0 || !(value - value == 0)) return {};
        return " " + text + (text.find_first_of(".e") == std::string::npos ? ".0" : "");
    }
    if (field.type == Field::Type::choice || field.type == Field::Type::integer) {
        std::uint32_t value = 0;
        std::memcpy(&value, defaults.data() + field.offset, sizeof value);
        return value == 0 ? std::string() : " " + std::to_string(value);
    }
    return {};
}

std::string upper(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

void write_idl(std::ostream& out, const std::vector<KindMessage>& kinds) {
    out << "// Made from the tables of the representations.\n#include \"ros_messages.idl\"\n\n"
           "module knurl_msgs { module msg { module dds_ {\n"
           "    @final struct Remove_ { std_msgs::msg::dds_::Header_ header; string id; };\n";
    for (const KindMessage& kind : kinds) {
        out << "    @final struct " << type_name(kind.info->name)
            << "_ {\n        std_msgs::msg::dds_::Header_ header;\n        string id;\n        unsigned long "
               "probe;\n";
        for (const Field& field : kind.info->fields)
            out << "        " << idl_type(field) << " _" << member(field) << ";\n";
        out << "    };\n";
    }
    out << "}; }; };\n";
}

void write_table(std::ostream& out, const std::vector<KindMessage>& kinds) {
    out << "// Made from the tables of the representations.\n#include <array>\n#include "
           "<cstddef>\n\n#include \"kind_message.hpp\"\n"
           "#include \"knurl_msgs.h\"\n\nnamespace knurl::dds {\n\nnamespace {\n\n";
    for (const KindMessage& kind : kinds) {
        const std::string c_name = "knurl_msgs_msg_dds__" + type_name(kind.info->name) + "_";
        out << "constexpr std::array<std::size_t, " << kind.info->fields.size() << "> offsets_"
            << kind.info->name << "{{\n";
        for (const Field& field : kind.info->fields)
            out << "    offsetof(" << c_name << ", " << member(field) << "),\n";
        out << "}};\nconstexpr std::array<unsigned char, " << kind.defaults.size() << "> defaults_"
            << kind.info->name << "{{";
        for (const std::byte byte : kind.defaults) out << std::to_integer<int>(byte) << ",";
        out << "}};\n";
    }
    out << "\n}  // namespace\n\nstd::span<const KindMessage> kind_messages() {\n    static const "
           "std::array<KindMessage, "
        << kinds.size() << "> all{{\n";
    for (const KindMessage& kind : kinds) {
        const std::string type = type_name(kind.info->name), c_name = "knurl_msgs_msg_dds__" + type + "_";
        out << "        {" << kind.info - knurl::kinds().data() << ", \"" << type << "\", &" << c_name
            << "_desc, sizeof(" << c_name << "), offsetof(" << c_name << ", header), offsetof(" << c_name
            << ", id), offsetof(" << c_name << ", probe), offsets_" << kind.info->name << ", defaults_"
            << kind.info->name << "},\n";
    }
    out << "    }};\n    return all;\n}\n\n}  // namespace knurl::dds\n";
}

void write_msg(std::ostream& out, const KindMessage& kind) {
    out << "# A " << kind.info->name << (kind.info->surface ? ", a surface" : ", an effect")
        << ", in the frame <device>_base. Lengths in m, forces in N.\nstd_msgs/Header header\n"
           "# Names it among those of this node: the first message adds it, later ones change it.\nstring "
           "id\nuint32 probe\n";
    for (const Field& field : kind.info->fields) {
        out << "# " << field.meaning
            << (field.unit.empty() || field.unit == "1" ? "" : " (" + std::string(field.unit) + ")")
            << (field.infinity_allowed ? "; .inf: as stiff as the device allows" : "")
            << (field.automatic_allowed ? "; -1: automatic" : "") << "\n";
        for (std::size_t i = 0; i < field.choices.size(); ++i)
            out << "uint32 " << upper(member(field)) << "_" << upper(std::string(field.choices[i])) << "="
                << i << "\n";
        out << msg_type(field) << " " << member(field) << msg_default(field, kind.defaults) << "\n";
    }
}

void write_ros_package(const std::filesystem::path& folder, const std::vector<KindMessage>& kinds) {
    std::filesystem::create_directories(folder / "msg");
    std::ofstream remove(folder / "msg" / "Remove.msg");
    remove << "# Removes what this node has added under that id; an empty one: all of it.\nstd_msgs/Header "
              "header\nstring id\n";
    std::string files = "  \"msg/Remove.msg\"\n";
    for (const KindMessage& kind : kinds) {
        const std::string name = type_name(kind.info->name);
        std::ofstream out(folder / "msg" / (name + ".msg"));
        write_msg(out, kind);
        files += "  \"msg/" + name + ".msg\"\n";
    }
    std::ofstream(folder / "package.xml")
        << "<?xml version=\"1.0\"?>\n<package format=\"3\">\n  <name>knurl_msgs</name>\n  "
           "<version>0.1.0</version>\n"
           "  <description>Representations of Knurl, a haptics server</description>\n  <maintainer "
           "email=\"knurl@localhost\">Knurl</maintainer>\n"
           "  <license>See Knurl</license>\n  <buildtool_depend>ament_cmake</buildtool_depend>\n"
           "  <buildtool_depend>rosidl_default_generators</buildtool_depend>\n  <depend>std_msgs</depend>\n  "
           "<depend>geometry_msgs</depend>\n"
           "  <exec_depend>rosidl_default_runtime</exec_depend>\n  "
           "<member_of_group>rosidl_interface_packages</member_of_group>\n"
           "  <export><build_type>ament_cmake</build_type></export>\n</package>\n";
    std::ofstream(folder / "CMakeLists.txt")
        << "cmake_minimum_required(VERSION 3.8)\nproject(knurl_msgs)\nfind_package(ament_cmake REQUIRED)\n"
           "find_package(rosidl_default_generators REQUIRED)\nfind_package(std_msgs "
           "REQUIRED)\nfind_package(geometry_msgs REQUIRED)\n"
           "rosidl_generate_interfaces(${PROJECT_NAME}\n"
        << files << "  DEPENDENCIES std_msgs geometry_msgs)\nament_package()\n";
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("knurl_dds_messages FOLDER\n", stderr);
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    std::vector<KindMessage> kinds;
    for (KindMessage& each : messages_of(knurl::Representations{}))
        if (!has_asset(*each.info)) kinds.push_back(std::move(each));
    std::filesystem::create_directories(folder);
    std::ofstream idl(folder / "knurl_msgs.idl"), table(folder / "kind_table.cpp");
    write_idl(idl, kinds);
    write_table(table, kinds);
    write_ros_package(folder / "knurl_msgs", kinds);
    idl.close();
    table.close();
    if (!idl || !table) {
        std::fprintf(stderr, "knurl_dds_messages: %s cannot be written\n", folder.c_str());
        return 1;
    }
    return 0;
}
