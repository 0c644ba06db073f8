#include "configs/json/json.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <type_traits>

namespace wade {

namespace {

using Library = nlohmann::ordered_json;

[[noreturn]] void refuse_use(const std::string& wanted, const Json& value) {
    throw JsonError(JsonError::Fault::use, "expected " + wanted + ", found " + value.type_name());
}

// The library's message without its own number and position.
std::string reason_of(const nlohmann::detail::exception& error) {
    const std::string text = error.what();
    const std::size_t column = text.find("column ");
    const std::size_t start = column == std::string::npos ? text.find("] ") : text.find(": ", column);
    return start == std::string::npos ? text : text.substr(start + 2);
}

// Receives the events of the library's parser. The library's own document accepts duplicate keys and any depth. A fault of the
// syntax further on is reported before these two, so the parser runs to the end of the text.
class Builder {
 public:
    explicit Builder(std::size_t max_values) : values_left_(max_values) {}

    bool null() { return add(nullptr); }
    bool boolean(bool value) { return add(value); }
    bool number_integer(std::int64_t value) { return add(value); }
    bool number_unsigned(std::uint64_t value) { return add(value); }
    bool number_float(double value, const std::string& /*digits*/) { return add(value); }
    bool string(std::string& value) { return add(std::move(value)); }
    bool binary(Library::binary_t& /*value*/) { return false; }  // of other formats
    bool start_object(std::size_t /*size*/) { return open(Json::object()); }
    bool start_array(std::size_t /*size*/) { return open(Json::array()); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }
    bool key(const std::string& name) {
        if (is_too_deep()) return true;
        Json& object = *open_.back();
        const std::size_t before = object.size();
        count(2);
        member_ = &object[name];
        if (object.size() == before && !duplicate_) duplicate_ = name;
        return true;
    }
    bool parse_error(std::size_t byte, const std::string& /*token*/, const nlohmann::detail::exception& error) {
        const bool is_syntax = dynamic_cast<const Library::parse_error*>(&error) != nullptr;
        throw JsonError(is_syntax ? JsonError::Fault::syntax : JsonError::Fault::number, reason_of(error),
                        is_syntax ? byte : 0);
    }

    Json finish(const JsonSyntax& syntax) {
        if (too_deep_) {
            throw JsonError(JsonError::Fault::nesting,
                            "objects and arrays are nested more than " + std::to_string(Json::max_depth) + " deep");
        }
        if (syntax.unique_keys && duplicate_) {
            throw JsonError(JsonError::Fault::duplicate_key,
                            "the key \"" + *duplicate_ + "\" stands twice in one object");
        }
        return std::move(root_);
    }

 private:
    void count(std::size_t values) {
        if (values > values_left_) throw JsonError(JsonError::Fault::size, "it has too many values");
        values_left_ -= values;
    }

    bool is_too_deep() {
        too_deep_ = too_deep_ || depth_ > Json::max_depth;
        return depth_ > Json::max_depth;
    }

    bool add(Json value) {
        if (is_too_deep()) return true;
        count(1);
        if (open_.empty()) {
            root_ = std::move(value);
            last_ = &root_;
        } else if (open_.back()->is_array()) {
            open_.back()->push_back(std::move(value));
            last_ = &open_.back()->back();
        } else {
            *member_ = std::move(value);
            last_ = member_;
        }
        return true;
    }

    bool open(Json container) {
        if (!is_too_deep()) {
            add(std::move(container));
            open_.push_back(last_);
        }
        ++depth_;
        return true;
    }

    bool close() {
        if (--depth_ < open_.size()) open_.pop_back();
        return true;
    }

    Json root_;
    std::vector<Json*> open_;  // the objects and arrays around the next value, as far as they are kept
    std::size_t depth_ = 0;    // how many there are
    Json* member_ = nullptr;   // the value of the last key
    Json* last_ = nullptr;     // the last value that was added
    bool too_deep_ = false;
    std::size_t values_left_;
    std::optional<std::string> duplicate_;  // the first
};

Library of_library(const Json& value, bool sorted) {
    if (value.is_array()) {
        Library made = Library::array();
        for (const Json& element : value) made.push_back(of_library(element, sorted));
        return made;
    }
    if (value.is_object()) {
        Library made = Library::object();
        // The library's own insertion compares the key with all keys that are there.
        auto& members = made.get_ref<Library::object_t&>();
        const auto add = [&](const JsonMember& member) {
            members.push_back({member.first, of_library(member.second, sorted)});
        };
        if (sorted) {
            for (const JsonMember* const member : value.sorted_items()) add(*member);
        } else {
            for (const JsonMember& member : value.items()) add(member);
        }
        return made;
    }
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) return value.get<double>();
    if (value.is_number_unsigned()) return value.get<std::uint64_t>();
    if (value.is_number_integer()) return value.get<std::int64_t>();
    if (value.is_boolean()) return value.get<bool>();
    return nullptr;
}

// The same number whatever its type is. A comparison of an integer with a double is one of doubles.
bool same_number(const Json& a, const Json& b) {
    if (a.is_number_float() || b.is_number_float()) return a.get<double>() == b.get<double>();
    const bool same_sign = (a.get<double>() < 0) == (b.get<double>() < 0);  // 2^64 - 1 has the bits of -1
    return same_sign && a.get<std::int64_t>() == b.get<std::int64_t>();
}

}  // namespace

struct JsonObject::Index {
    std::map<std::string, std::size_t, std::less<>> positions;
};

JsonObject::JsonObject() = default;
JsonObject::JsonObject(JsonObject&& other) noexcept = default;
JsonObject::~JsonObject() = default;

JsonObject::JsonObject(const JsonObject& other) : members_(other.members_) {
    if (other.index_) index_ = std::make_unique<Index>(*other.index_);
}

JsonObject& JsonObject::operator=(JsonObject other) noexcept {
    members_.swap(other.members_);
    index_.swap(other.index_);
    return *this;
}

void JsonObject::index_all() {
    constexpr std::size_t few = 16;  // are compared as fast one by one
    index_.reset();
    if (members_.size() <= few) return;
    index_ = std::make_unique<Index>();
    for (std::size_t i = 0; i < members_.size(); ++i) index_->positions.emplace(members_[i].first, i);
}

const Json* JsonObject::find(std::string_view key) const {
    if (index_) {
        const auto found = index_->positions.find(key);
        return found == index_->positions.end() ? nullptr : &members_[found->second].second;
    }
    for (const auto& [name, value] : members_) {
        if (name == key) return &value;
    }
    return nullptr;
}

Json& JsonObject::member(std::string_view key) {
    if (const Json* const known = find(key)) return const_cast<Json&>(*known);
    members_.emplace_back(key, Json());
    if (index_) {
        index_->positions.emplace(key, members_.size() - 1);
    } else {
        index_all();
    }
    return members_.back().second;
}

void JsonObject::erase(std::string_view key) {
    if (std::erase_if(members_, [&](const JsonMember& member) { return member.first == key; }) > 0) index_all();
}

Json::Json() = default;
Json::Json(std::nullptr_t) {}
Json::Json(int value) : value_(std::int64_t{value}) {}
Json::Json(unsigned value) : value_(std::uint64_t{value}) {}
Json::Json(long value) : value_(std::int64_t{value}) {}
Json::Json(unsigned long value) : value_(std::uint64_t{value}) {}
Json::Json(long long value) : value_(std::int64_t{value}) {}
Json::Json(unsigned long long value) : value_(std::uint64_t{value}) {}
Json::Json(double value) : value_(value) {}
Json::Json(const char* value) : value_(std::string(value)) {}
Json::Json(std::string_view value) : value_(std::string(value)) {}
Json::Json(std::string value) : value_(std::move(value)) {}

Json::Json(std::initializer_list<Json> elements) {
    const bool is_object = std::all_of(elements.begin(), elements.end(), [](const Json& element) {
        return element.is_array() && element.size() == 2 && element[0].is_string();
    });
    if (!is_object) {
        value_ = Array(elements);
        return;
    }
    JsonObject& object = value_.emplace<JsonObject>();
    for (const Json& element : elements) object.member(element[0].get<std::string>()) = element[1];
}

Json Json::array(std::initializer_list<Json> elements) {
    Json made;
    made.value_ = Array(elements);
    return made;
}

Json Json::object() {
    Json made;
    made.value_.emplace<JsonObject>();
    return made;
}

Json::Json(const Json& other) = default;
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(const Json& other) = default;
Json& Json::operator=(Json&& other) noexcept = default;
Json::~Json() = default;

Json Json::parse(std::string_view text, const JsonSyntax& syntax) {
    Builder builder(syntax.max_values);
    Library::sax_parse(text.begin(), text.end(), &builder, Library::input_format_t::json, /*strict=*/true,
                       syntax.comments);
    return builder.finish(syntax);
}

std::optional<Json> Json::try_parse(std::string_view text) {
    try {
        return parse(text);
    } catch (const JsonError&) {
        return std::nullopt;
    }
}

std::string Json::dump(const JsonStyle& style) const {
    const auto handler = style.lossy_text ? Library::error_handler_t::replace : Library::error_handler_t::strict;
    try {
        return of_library(*this, style.sorted).dump(style.indent, ' ', false, handler);
    } catch (const Library::exception& error) {
        throw JsonError(JsonError::Fault::use, error.what());
    }
}

const char* Json::type_name() const {
    constexpr const char* names[] = {"null", "boolean", "number", "number", "number", "string", "array", "object"};
    return names[value_.index()];
}

namespace {

template <typename Number, typename Variant>
Number number_in(const Variant& variant, const Json& value) {
    return std::visit(
        [&](const auto& its) -> Number {
            using Type = std::decay_t<decltype(its)>;
            if constexpr (std::is_arithmetic_v<Type> && !std::is_same_v<Type, bool>) {
                return static_cast<Number>(its);
            } else {
                refuse_use("number", value);
            }
        },
        variant);
}

}  // namespace

template <>
bool Json::get<bool>() const {
    if (const bool* const flag = std::get_if<bool>(&value_)) return *flag;
    refuse_use("boolean", *this);
}

template <>
double Json::get<double>() const {
    return number_in<double>(value_, *this);
}

template <>
std::int64_t Json::get<std::int64_t>() const {
    return number_in<std::int64_t>(value_, *this);
}

template <>
std::uint64_t Json::get<std::uint64_t>() const {
    return number_in<std::uint64_t>(value_, *this);
}

template <>
std::string Json::get<std::string>() const {
    if (const std::string* const text = std::get_if<std::string>(&value_)) return *text;
    refuse_use("string", *this);
}

std::size_t Json::size() const {
    if (const Array* const elements = std::get_if<Array>(&value_)) return elements->size();
    if (const JsonObject* const object = std::get_if<JsonObject>(&value_)) return object->members().size();
    return is_null() ? 0 : 1;
}

const Json* Json::begin() const {
    if (is_null()) return nullptr;
    if (const Array* const elements = std::get_if<Array>(&value_)) return elements->data();
    refuse_use("array", *this);
}

const Json* Json::end() const {
    return is_null() ? nullptr : begin() + size();
}
void Json::push_back(Json value) {
    if (is_null()) value_ = Array();
    if (!is_array()) refuse_use("array", *this);
    std::get<Array>(value_).push_back(std::move(value));
}

const Json& Json::operator[](std::size_t index) const {
    if (!is_array()) refuse_use("array", *this);
    return std::get<Array>(value_).at(index);
}

const std::vector<JsonMember>& Json::items() const {
    if (const JsonObject* const object = std::get_if<JsonObject>(&value_)) return object->members();
    refuse_use("object", *this);
}

std::vector<const JsonMember*> Json::sorted_items() const {
    std::vector<const JsonMember*> members;
    for (const JsonMember& member : items()) members.push_back(&member);
    std::sort(members.begin(), members.end(),
              [](const JsonMember* a, const JsonMember* b) { return a->first < b->first; });
    return members;
}

const Json* Json::find(std::string_view key) const {
    const JsonObject* const object = std::get_if<JsonObject>(&value_);
    return object == nullptr ? nullptr : object->find(key);
}

const Json& Json::operator[](std::string_view key) const {
    static const Json nothing;
    const Json* const found = find(key);
    return found == nullptr ? nothing : *found;
}

const Json& Json::at(std::string_view key) const {
    if (const Json* const found = find(key)) return *found;
    throw JsonError(JsonError::Fault::use, "there is no key \"" + std::string(key) + "\"");
}

Json& Json::operator[](std::string_view key) {
    if (is_null()) value_.emplace<JsonObject>();
    if (!is_object()) refuse_use("object", *this);
    return std::get<JsonObject>(value_).member(key);
}

void Json::erase(std::string_view key) {
    if (!is_object()) refuse_use("object", *this);
    std::get<JsonObject>(value_).erase(key);
}

bool operator==(const JsonObject& a, const JsonObject& b) {
    return a.members().size() == b.members().size() &&
           std::all_of(a.members().begin(), a.members().end(), [&](const JsonMember& member) {
               const Json* const other = b.find(member.first);
               return other != nullptr && *other == member.second;
           });
}

bool operator==(const Json& a, const Json& b) {
    return a.is_number() && b.is_number() ? same_number(a, b) : a.value_ == b.value_;
}

std::ostream& operator<<(std::ostream& out, const Json& value) {
    return out << value.dump({.lossy_text = true});
}

}  // namespace wade
