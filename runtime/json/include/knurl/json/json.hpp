#pragma once

// JSON for programs, tests and benchmarks: a value, read from text and written as text. Only json.cpp
// compiles nlohmann's parser and writer: their header takes seconds in every source that includes it.

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace knurl {

/// The text is no JSON, the value has another type, or a member is missing.
struct JsonError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// null, true or false, a number, text, an array, or an object that keeps the order of its keys.
class Json {
  public:
    using value_type = Json;
    using iterator = Json*;
    using const_iterator = const Json*;

    template <class T>
    static constexpr bool is_integer = std::integral<T> && !std::same_as<T, bool> && !std::same_as<T, char>;

    Json() = default;
    Json(std::nullptr_t) {}
    Json(std::same_as<bool> auto value) : kind_(Kind::boolean) { number_.integer = value ? 1 : 0; }
    template <class T>
    requires(is_integer<T>&& std::is_signed_v<T>) Json(T value) : kind_(Kind::integer) {
        number_.integer = value;
    }
    template <class T>
    requires(is_integer<T>&& std::is_unsigned_v<T>) Json(T value) : kind_(Kind::natural) {
        number_.natural = value;
    }
    Json(std::floating_point auto value) : kind_(Kind::real) { number_.real = static_cast<double>(value); }
    Json(std::string text);
    Json(std::string_view text) : Json(std::string(text)) {}
    Json(const char* text) : Json(std::string(text)) {}
    template <class T>
    requires(!std::same_as<T, char>) Json(const std::vector<T>& values) : Json(array()) {
        for (const auto& value : values) push_back(T(value));
    }
    template <class Map>
    requires requires { typename Map::mapped_type; }
    Json(const Map& members) : Json(object()) {
        for (const auto& [key, value] : members) (*this)[key] = value;
    }
    /// Pairs that begin with text each make an object, anything else an array: {{"x", 1}, {"y", 2}}, {1, 2}.
    Json(std::initializer_list<Json> values);
    Json(const Json& other);
    Json(Json&&) noexcept = default;
    Json& operator=(const Json& other);
    Json& operator=(Json&&) noexcept = default;
    ~Json() = default;

    static Json array() { return Json(Kind::array); }
    static Json array(std::initializer_list<Json> values);
    static Json object() { return Json(Kind::object); }
    /// Throws JsonError, which says where.
    static Json parse(std::string_view text);

    bool is_null() const { return kind_ == Kind::null; }
    bool is_boolean() const { return kind_ == Kind::boolean; }
    bool is_number() const { return is_number_integer() || kind_ == Kind::real; }
    bool is_number_integer() const { return kind_ == Kind::integer || is_number_unsigned(); }
    bool is_number_unsigned() const { return kind_ == Kind::natural; }
    bool is_number_float() const { return kind_ == Kind::real; }
    bool is_string() const { return kind_ == Kind::text; }
    bool is_array() const { return kind_ == Kind::array; }
    bool is_object() const { return kind_ == Kind::object; }

    /// Elements of an array, members of an object; none in null, one in anything else.
    std::size_t size() const;
    bool empty() const { return size() == 0; }

    bool contains(std::string_view key) const { return place_of(key).has_value(); }
    /// Throws if it is missing. The operator adds it instead, if the value may change: null becomes an
    /// object.
    const Json& at(std::string_view key) const;
    Json& at(std::string_view key) { return const_cast<Json&>(std::as_const(*this).at(key)); }
    const Json& operator[](std::string_view key) const { return at(key); }
    Json& operator[](std::string_view key);
    const Json& operator[](const char* key) const { return at(key); }
    Json& operator[](const char* key) { return (*this)[std::string_view(key)]; }
    template <class T>
    requires is_integer<T>
    const Json& at(T index) const { return element(static_cast<std::size_t>(index)); }
    template <class T>
    requires is_integer<T> Json& at(T index) {
        return const_cast<Json&>(element(static_cast<std::size_t>(index)));
    }
    template <class T>
    requires is_integer<T>
    const Json& operator[](T index) const { return at(index); }
    template <class T>
    requires is_integer<T> Json& operator[](T index) { return at(index); }
    Json value(std::string_view key, Json otherwise) const { return contains(key) ? at(key) : otherwise; }

    /// Elements of an array, values of an object.
    const Json* begin() const;
    const Json* end() const;
    Json* begin() { return const_cast<Json*>(std::as_const(*this).begin()); }
    Json* end() { return const_cast<Json*>(std::as_const(*this).end()); }
    const Json& back() const { return at(size() - 1); }
    Json& back() { return at(size() - 1); }
    struct Item {
        const std::string& key;
        const Json& value;
    };
    std::vector<Item> items() const;

    /// Null becomes an array.
    void push_back(Json value);
    void erase(std::string_view key);

    /// Throws JsonError where the value is of another type.
    template <class T>
    T get() const {
        if constexpr (std::same_as<T, Json>)
            return *this;
        else if constexpr (std::same_as<T, bool>)
            return as_boolean();
        else if constexpr (std::same_as<T, std::string>)
            return as_text();
        else if constexpr (std::floating_point<T>)
            return static_cast<T>(as_real());
        else if constexpr (is_integer<T>)
            return static_cast<T>(as_integer());
        else {
            T values;
            if (!is_array()) throw wrong_type("an array");
            for (const Json& value : *this) values.push_back(value.get<typename T::value_type>());
            return values;
        }
    }
    template <class T>
    requires(std::same_as<T, bool> || std::same_as<T, std::string> || std::floating_point<T> || is_integer<T>)
    operator T() const {
        return get<T>();
    }

    /// In one line, or with members indented by so many spaces. Invalid UTF-8 in a text is replaced.
    std::string dump(int indent = -1) const;

    /// Numbers by their value, whatever their type; objects whatever their order.
    friend bool operator==(const Json& a, const Json& b);
    template <class T>
    requires(std::same_as<T, bool> || std::floating_point<T> || is_integer<T>) friend bool operator==(
        const Json& a, T b) {
        return a == Json(b);
    }
    friend bool operator==(const Json& a, const std::string& b) { return a == Json(b); }
    friend bool operator==(const Json& a, const char* b) { return a == Json(b); }
    /// For numbers; false for all else.
    friend std::partial_ordering operator<=>(const Json& a, const Json& b);
    template <class T>
    requires(std::floating_point<T> || is_integer<T>) friend std::partial_ordering operator<=>(const Json& a,
                                                                                               T b) {
        return a <=> Json(b);
    }
    friend std::ostream& operator<<(std::ostream& out, const Json& json);

  private:
    enum class Kind : std::uint8_t { null, boolean, integer, natural, real, text, array, object };
    struct Parts;
    struct Drop {
        void operator()(Parts* parts) const;
    };

    explicit Json(Kind kind);
    JsonError wrong_type(const char* wanted) const;
    std::optional<std::size_t> place_of(std::string_view key) const;
    const Json& element(std::size_t index) const;
    bool as_boolean() const;
    double as_real() const;
    std::int64_t as_integer() const;
    const std::string& as_text() const;

    Kind kind_ = Kind::null;
    union {
        std::int64_t integer = 0;
        std::uint64_t natural;
        double real;
    } number_;
    std::unique_ptr<Parts, Drop> parts_;  // of text, arrays and objects

    friend struct JsonText;
};

}  // namespace knurl
