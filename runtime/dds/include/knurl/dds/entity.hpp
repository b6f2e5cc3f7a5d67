#pragma once

/// @file
/// What Cyclone's C interface hands out, owned: entities and QoS that end with their objects, and errors as exceptions of
/// one line.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <dds/dds.h>

namespace knurl::dds {

/// What Cyclone returned, if it is no error. Throws std::runtime_error: "what: why".
dds_return_t check(dds_return_t code, std::string_view what);

/// A participant, topic, reader, writer, ...; deleted with this object, and with it what was made of it.
class Entity {
  public:
    Entity() = default;
    /// Owns it. Throws if it is an error of Cyclone's.
    Entity(dds_entity_t handle, std::string_view what) : handle_(check(handle, what)) {}
    Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
    Entity& operator=(Entity&& other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Entity() {
        if (handle_ > 0) dds_delete(handle_);
    }
    /// For Cyclone's calls.
    dds_entity_t get() const { return handle_; }
    /// There is one.
    explicit operator bool() const { return handle_ > 0; }

  private:
    dds_entity_t handle_ = 0;
};

/// A QoS of Cyclone's.
using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;
/// An empty one.
inline Qos make_qos() {
    return {dds_create_qos(), &dds_delete_qos};
}

/// Samples that a reader lends; given back with this object.
template <class T, std::size_t Most = 32>
class Taken {
  public:
    /// Takes what is there, at most `Most`.
    explicit Taken(dds_entity_t reader) : reader_(reader) {
        const dds_return_t count = dds_take(reader, samples_, infos_, Most, Most);
        count_ = count > 0 ? static_cast<std::size_t>(count) : 0;
    }
    ~Taken() {
        if (count_ > 0) dds_return_loan(reader_, samples_, static_cast<std::int32_t>(count_));
    }
    Taken(const Taken&) = delete;
    Taken& operator=(const Taken&) = delete;
    /// How many.
    std::size_t size() const { return count_; }
    /// The i-th; read it only if info(i).valid_data.
    const T& operator[](std::size_t i) const { return *static_cast<const T*>(samples_[i]); }
    /// What is known of the i-th.
    const dds_sample_info_t& info(std::size_t i) const { return infos_[i]; }

  private:
    dds_entity_t reader_;
    void* samples_[Most] = {};
    dds_sample_info_t infos_[Most] = {};
    std::size_t count_ = 0;
};

}  // namespace knurl::dds
