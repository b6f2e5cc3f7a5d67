#include <algorithm>
#include <ostream>

#include <nlohmann/json.hpp>

#include <knurl/json/json.hpp>

namespace knurl {

struct Json::Parts {
    std::string text;
    std::vector<std::string> keys;  // of an object: as many as values
    std::vector<Json> values;
};

/// Conversion from and to nlohmann's value.
struct JsonText {
    using Theirs = nlohmann::ordered_json;

    static Json from(Theirs& value) {
        switch (value.type()) {
            case Theirs::value_t::boolean:
                return value.get<bool>();
            case Theirs::value_t::number_integer:
                return value.get<std::int64_t>();
            case Theirs::value_t::number_unsigned:
                return value.get<std::uint64_t>();
            case Theirs::value_t::number_float:
                return value.get<double>();
            case Theirs::value_t::string:
                return std::move(value.get_ref<std::string&>());
            case Theirs::value_t::array: {
                Json made = Json::array();
                for (auto& element : value) made.push_back(from(element));
                return made;
            }
            case Theirs::value_t::object: {
                Json made = Json::object();
                for (auto& [key, member] : value.get_ref<Theirs::object_t&>()) {
                    made.parts_->keys.push_back(key);
                    made.parts_->values.push_back(from(member));
                }
                return made;
            }
            default:
                return nullptr;
        }
    }
    static Theirs to(const Json& value) {
        switch (value.kind_) {
            case Json::Kind::null:
                return nullptr;
            case Json::Kind::boolean:
                return value.as_boolean();
            case Json::Kind::integer:
                return value.number_.integer;
            case Json::Kind::natural:
                return value.number_.natural;
            case Json::Kind::real:
                return value.number_.real;
            case Json::Kind::text:
                return value.parts_->text;
            case Json::Kind::array: {
                Theirs made = Theirs::array();
                for (const Json& element : value) made.push_back(to(element));
                return made;
            }
            case Json::Kind::object:
                break;
        }
        Theirs made = Theirs::object();
        auto& members = made.get_ref<Theirs::object_t&>();
        for (const auto& [key, member] : value.items())  // not by their operator, which compares with every
                                                         // key
            members.Container::emplace_back(key, to(member));
        return made;
    }
};

void Json::Drop::operator()(Parts* parts) const {
    delete parts;
}

Json::Json(Kind kind) : kind_(kind), parts_(new Parts) {}
Json::Json(std::string text) : Json(Kind::text) {
    parts_->text = std::move(text);
}
Json::Json(std::initializer_list<Json> values) : Json(Kind::array) {
    const auto is_member = [](const Json& v) { return v.is_array() && v.size() == 2 && v[0].is_string(); };
    if (!std::ranges::all_of(values, is_member)) {
        parts_->values = values;
        return;
    }
    kind_ = Kind::object;
    for (const Json& member : values) (*this)[member[0].as_text()] = member[1];
}
Json::Json(const Json& other)
    : kind_(other.kind_), number_(other.number_), parts_(other.parts_ ? new Parts(*other.parts_) : nullptr) {}
Json& Json::operator=(const Json& other) {
    return *this = Json(other);
}

Json Json::array(std::initializer_list<Json> values) {
    Json made = array();
    made.parts_->values = values;
    return made;
}

Json Json::parse(std::string_view text) {
    // Values are copied, written and destroyed level by level, on the stack.
    constexpr int deepest = 256;
    const auto look = [](int depth, JsonText::Theirs::parse_event_t, JsonText::Theirs&) {
        if (depth > deepest)
            throw JsonError("it nests deeper than " + std::to_string(deepest) + " arrays and objects");
        return true;
    };
    try {
        auto theirs = JsonText::Theirs::parse(text, look);
        return JsonText::from(theirs);
    } catch (const nlohmann::json::exception& error) {
        throw JsonError(error.what());
    }
}

std::string Json::dump(int indent) const {
    return JsonText::to(*this).dump(indent, ' ', false, JsonText::Theirs::error_handler_t::replace);
}

std::ostream& operator<<(std::ostream& out, const Json& json) {
    return out << json.dump();
}

JsonError Json::wrong_type(const char* wanted) const {
    static constexpr const char* names[] = {"null",     "a boolean", "a number", "a number",
                                            "a number", "text",      "an array", "an object"};
    return JsonError(std::string("is ") + names[static_cast<std::size_t>(kind_)] + " where " + wanted +
                     " is wanted");
}

std::size_t Json::size() const {
    return is_null() ? 0 : is_array() || is_object() ? parts_->values.size() : 1;
}

std::optional<std::size_t> Json::place_of(std::string_view key) const {
    if (!is_object()) return std::nullopt;
    const auto found = std::ranges::find(parts_->keys, key);
    if (found == parts_->keys.end()) return std::nullopt;
    return static_cast<std::size_t>(found - parts_->keys.begin());
}

const Json& Json::at(std::string_view key) const {
    if (!is_object()) throw wrong_type("an object");
    const auto place = place_of(key);
    if (!place) throw JsonError("key '" + std::string(key) + "' is missing");
    return parts_->values[*place];
}

Json& Json::operator[](std::string_view key) {
    if (is_null()) *this = object();
    if (!is_object()) throw wrong_type("an object");
    if (const auto place = place_of(key)) return parts_->values[*place];
    parts_->keys.emplace_back(key);
    return parts_->values.emplace_back();
}

const Json& Json::element(std::size_t index) const {
    if (!is_array()) throw wrong_type("an array");
    if (index >= size())
        throw JsonError("element " + std::to_string(index) + " is missing of " + std::to_string(size()));
    return parts_->values[index];
}

const Json* Json::begin() const {
    return is_array() || is_object() ? parts_->values.data() : nullptr;
}
const Json* Json::end() const {
    return is_array() || is_object() ? begin() + size() : nullptr;
}

std::vector<Json::Item> Json::items() const {
    if (!is_object()) throw wrong_type("an object");
    std::vector<Item> all;
    all.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) all.push_back({parts_->keys[i], parts_->values[i]});
    return all;
}

void Json::push_back(Json value) {
    if (is_null()) *this = array();
    if (!is_array()) throw wrong_type("an array");
    parts_->values.push_back(std::move(value));
}

void Json::erase(std::string_view key) {
    const auto place = place_of(key);
    if (!place) return;
    parts_->keys.erase(parts_->keys.begin() + static_cast<std::ptrdiff_t>(*place));
    parts_->values.erase(parts_->values.begin() + static_cast<std::ptrdiff_t>(*place));
}

bool Json::as_boolean() const {
    if (!is_boolean()) throw wrong_type("a boolean");
    return number_.integer != 0;
}
double Json::as_real() const {
    switch (kind_) {
        case Kind::integer:
            return static_cast<double>(number_.integer);
        case Kind::natural:
            return static_cast<double>(number_.natural);
        case Kind::real:
            return number_.real;
        default:
            throw wrong_type("a number");
    }
}
std::int64_t Json::as_integer() const {
    switch (kind_) {
        case Kind::integer:
            return number_.integer;
        case Kind::natural:
            return static_cast<std::int64_t>(number_.natural);
        case Kind::real:
            return static_cast<std::int64_t>(number_.real);
        default:
            throw wrong_type("a number");
    }
}
const std::string& Json::as_text() const {
    if (!is_string()) throw wrong_type("text");
    return parts_->text;
}

std::partial_ordering operator<=>(const Json& a, const Json& b) {
    if (!a.is_number() || !b.is_number()) return std::partial_ordering::unordered;
    if (!a.is_number_integer() || !b.is_number_integer()) return a.as_real() <=> b.as_real();
    if (a.kind_ == b.kind_ && a.is_number_unsigned()) return a.number_.natural <=> b.number_.natural;
    // A natural number above all integers appears negative in as_integer().
    const auto above = [](const Json& n) { return n.is_number_unsigned() && n.as_integer() < 0; };
    if (above(a) || above(b)) return above(a) <=> above(b);
    return a.as_integer() <=> b.as_integer();
}

bool operator==(const Json& a, const Json& b) {
    if (a.is_number() && b.is_number()) return (a <=> b) == 0;
    if (a.kind_ != b.kind_ || a.size() != b.size()) return false;
    switch (a.kind_) {
        case Json::Kind::boolean:
            return a.number_.integer == b.number_.integer;
        case Json::Kind::text:
            return a.parts_->text == b.parts_->text;
        case Json::Kind::array:
            return a.parts_->values == b.parts_->values;
        case Json::Kind::object:
            return std::ranges::all_of(a.items(), [&b](const Json::Item& item) {
                return b.contains(item.key) && b.at(item.key) == item.value;
            });
        default:
            return true;
    }
}

}  // namespace knurl
