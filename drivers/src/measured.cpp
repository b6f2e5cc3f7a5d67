#include "measured.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <toml++/toml.h>

namespace knurl::drivers {

namespace {

struct Figures {
    double mass = 0, damping = 0, lag = 0, friction = 0, resolution = 0;
};

[[noreturn]] void fail(const std::string& file, const std::string& why) {
    throw std::runtime_error(file + ": " + why +
                             "; `knurl device calibrate ADDRESS --write FILE` writes such a file");
}

Figures figures_in(const std::string& file) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(file, none)) fail(file, "there is no such file");
    if (std::filesystem::file_size(file, none) > 1 << 16) fail(file, "it is too long");
    toml::table all;
    try {
        all = toml::parse_file(file);
    } catch (const toml::parse_error& error) {
        fail(file, std::string(error.description()));
    }
    const toml::table* table = all["measured"].as_table();
    if (table == nullptr) fail(file, "it has no [measured]");
    Figures figures;
    struct Key {
        const char* name;
        double* to;
        double least, greatest;
    };
    const Key keys[] = {{"mass", &figures.mass, 0.001, 10},
                        {"damping", &figures.damping, 0.001, 50},
                        {"lag", &figures.lag, 0, 0.1},
                        {"friction", &figures.friction, 0, 10},
                        {"resolution", &figures.resolution, 0, 0.01}};
    for (const auto& [name, node] : *table) {
        if (name.str() == "address" || name.str() == "serial") continue;
        const Key* known = nullptr;
        for (const Key& key : keys)
            if (name.str() == key.name) known = &key;
        if (known == nullptr) fail(file, std::string(name.str()) + " is not known in [measured]");
        const auto value = node.value<double>();
        if (!value || !(*value >= known->least && *value <= known->greatest)) {
            std::ostringstream why;
            why << known->name << " is no number from " << known->least << " to " << known->greatest
                << " (SI units)";
            fail(file, why.str());
        }
        *known->to = *value;
    }
    return figures;
}

class Measured final : public Device {
  public:
    Measured(std::unique_ptr<Device> device, const std::string& file)
        : device_(std::move(device)), link_(device_->link()) {
        const Figures figures = figures_in(file);
        if (figures.mass > 0) link_.apparent_mass = figures.mass;
        if (figures.damping > 0) link_.damping = figures.damping;
        if (figures.lag > 0) link_.lag = figures.lag;
        link_.description += "; mass, damping and lag measured: " + file;
    }
    const LinkConfig& link() const noexcept override { return link_; }
    const Mechanism& mechanism() const noexcept override { return device_->mechanism(); }
    bool has_buttons() const noexcept override { return device_->has_buttons(); }
    ReadStatus read(Nanoseconds now, JointSample& sample) noexcept override {
        return device_->read(now, sample);
    }
    bool write(Nanoseconds now, const JointEfforts& efforts) noexcept override {
        return device_->write(now, efforts);
    }
    void notify(Notice notice) noexcept override { device_->notify(notice); }
    void make_safe() noexcept override { device_->make_safe(); }

  private:
    std::unique_ptr<Device> device_;
    LinkConfig link_;
};

}  // namespace

std::unique_ptr<Device> measured(std::unique_ptr<Device> device, const std::string& file) {
    return std::make_unique<Measured>(std::move(device), file);
}

void check_measured(const std::string& file) {
    static_cast<void>(figures_in(file));
}

}  // namespace knurl::drivers
