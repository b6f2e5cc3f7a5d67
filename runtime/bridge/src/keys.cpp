#include <algorithm>
#include <cerrno>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/bridge/keys.hpp>
#include <knurl/shm/fd.hpp>

#include "system_text.hpp"

namespace knurl::bridge {

namespace {

constexpr std::array<std::string_view, 3> role_names{"observe", "render", "control"};
constexpr std::size_t max_file_bytes = max_keys * 160;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
    throw std::runtime_error(file.string() + ": " + what);
}

bool good_name(std::string_view name) noexcept {
    // Independent of the locale: two hosts compare a name byte by byte.
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
               c == '_' || c == '-';
    };
    return !name.empty() && name.size() <= max_key_name && std::all_of(name.begin(), name.end(), allowed);
}

std::string name_rule() {
    return "1 to " + std::to_string(max_key_name) + " letters, digits, '.', '_' or '-'";
}

int digit(char c) noexcept {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

bool parse_secret(std::string_view hex, std::array<std::byte, key_bytes>& out) noexcept {
    if (hex.size() != 2 * key_bytes) return false;
    for (std::size_t i = 0; i < key_bytes; ++i) {
        const int high = digit(hex[2 * i]), low = digit(hex[2 * i + 1]);
        if (high < 0 || low < 0) return false;
        out[i] = static_cast<std::byte>(16 * high + low);
    }
    return true;
}

std::string to_hex(const std::array<std::byte, key_bytes>& secret) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string hex;
    for (const std::byte b : secret) {
        hex += digits[std::to_integer<std::size_t>(b) >> 4];
        hex += digits[std::to_integer<std::size_t>(b) & 15];
    }
    return hex;
}

Key parse_line(const std::filesystem::path& file, std::size_t number, std::istringstream& words) {
    std::string name, role, hex, rest;
    words >> name >> role >> hex;
    const auto wrong = [&](const std::string& what) {
        refuse(file, "line " + std::to_string(number) + ": " + what);
    };
    if (!good_name(name)) wrong("bad name '" + name + "'; " + name_rule());
    const std::optional<Role> parsed = parse_role(role);
    if (!parsed) wrong("unknown role '" + role + "'; observe, render or control");
    Key key{.name = name, .role = *parsed};
    if (!parse_secret(hex, key.secret))
        wrong("the key has " + std::to_string(hex.size()) + " characters; 64 hexadecimal digits");
    if (words >> rest) wrong("unexpected '" + rest + "' after the key");
    return key;
}

std::vector<Key> parse(const std::filesystem::path& file, const std::string& text) {
    std::vector<Key> keys;
    std::istringstream lines(text);
    std::string line;
    for (std::size_t number = 1; std::getline(lines, line); ++number) {
        line.resize(std::min(line.size(), line.find('#')));
        std::istringstream words(line);
        if ((words >> std::ws).eof()) continue;
        Key key = parse_line(file, number, words);
        if (find_key(keys, key.name))
            refuse(file, "line " + std::to_string(number) + ": a second key named '" + key.name +
                             "'; each name once");
        if (keys.size() == max_keys) refuse(file, "more than " + std::to_string(max_keys) + " keys");
        keys.push_back(std::move(key));
    }
    return keys;
}

std::string read_all(const std::filesystem::path& file, int fd) {
    std::string text(max_file_bytes + 1, '\0');
    std::size_t size = 0;
    while (size < text.size()) {
        const ssize_t got = ::read(fd, text.data() + size, text.size() - size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) refuse(file, "cannot be read: " + system_text(errno));
        if (got == 0) break;
        size += static_cast<std::size_t>(got);
    }
    if (size > max_file_bytes) refuse(file, "too long for a keys file");
    text.resize(size);
    return text;
}

/// Checks the open file, not its name, which might name another file by then.
void require_private(const std::filesystem::path& file, int fd) {
    struct stat status {};
    if (::fstat(fd, &status) != 0) refuse(file, "cannot be read: " + system_text(errno));
    if (!S_ISREG(status.st_mode)) refuse(file, "is not a regular file");
    if (status.st_uid != ::geteuid() && status.st_uid != 0)
        refuse(file, "belongs to user " + std::to_string(status.st_uid) +
                         ", who could add keys; run: chown " + std::to_string(::geteuid()) + ' ' +
                         file.string());
    if ((status.st_mode & 077) != 0)
        refuse(file,
               "others may read or write it, and who reads it can move a motor; chmod 600 " + file.string());
}

}  // namespace

std::string_view role_name(Role role) noexcept {
    const auto i = static_cast<std::size_t>(role);
    return i < role_names.size() ? role_names[i] : std::string_view("?");
}

std::optional<Role> parse_role(std::string_view word) noexcept {
    const auto found = std::find(role_names.begin(), role_names.end(), word);
    if (found == role_names.end()) return std::nullopt;
    return static_cast<Role>(found - role_names.begin());
}

const Key* find_key(std::span<const Key> keys, std::string_view name) noexcept {
    const auto found =
        std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
    return found == keys.end() ? nullptr : &*found;
}

Key make_key(std::string name, Role role) {
    if (!good_name(name)) throw std::runtime_error("bad name '" + name + "' for a key; " + name_rule());
    Key key{.name = std::move(name), .role = role};
    // getrandom(2): up to 256 bytes are never cut short, and it waits until the pool is ready.
    if (::getrandom(key.secret.data(), key.secret.size(), 0) != static_cast<ssize_t>(key.secret.size()))
        throw std::runtime_error("the system gives no random numbers: " + system_text(errno));
    return key;
}

std::vector<Key> read_keys(const std::filesystem::path& file, KeysOf whose) {
    const std::string remedy = whose == KeysOf::bridge
                                   ? "make one with: knurl-bridge keygen --name NAME --role ROLE"
                                   : "ask whoever runs the bridge for your line of its keys, and write it "
                                     "into this file (mode 0600)";
    const shm::UniqueFd fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!fd) {
        const int error = errno;
        refuse(file, error == ENOENT ? "there is no such file with a key; " + remedy
                                     : "cannot be read: " + system_text(error));
    }
    require_private(file, fd.get());
    std::vector<Key> keys = parse(file, read_all(file, fd.get()));
    if (keys.empty()) refuse(file, "holds no key; " + remedy);
    return keys;
}

void add_key(const std::filesystem::path& file, const Key& key) {
    if (!good_name(key.name))
        throw std::runtime_error("bad name '" + key.name + "' for a key; " + name_rule());
    const shm::UniqueFd fd(::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK, 0600));
    if (!fd) refuse(file, "cannot be written: " + system_text(errno));
    require_private(file, fd.get());
    const std::string text = read_all(file, fd.get());
    const std::vector<Key> keys = parse(file, text);
    if (find_key(keys, key.name))
        refuse(file, "has a key named '" + key.name + "' already; choose another name, or delete that line");
    if (keys.size() == max_keys) refuse(file, "has " + std::to_string(max_keys) + " keys; no room for more");
    const std::string line = std::string(text.empty() || text.back() == '\n' ? "" : "\n") + key.name + " " +
                             std::string(role_name(key.role)) + " " + to_hex(key.secret) + "\n";
    if (::write(fd.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
        refuse(file, "cannot be written: " + system_text(errno));
}

}  // namespace knurl::bridge
