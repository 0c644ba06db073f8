#pragma once
// A JSON document as a plain value. json.cpp alone includes the library that parses and prints it.

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
#include <utility>
#include <variant>
#include <vector>

namespace wade {

class Json;
using JsonMember = std::pair<std::string, Json>;

// Why a text is refused, or a value cannot be used as asked. what() is a sentence without its full stop.
class JsonError : public std::runtime_error {
 public:
    enum class Fault { syntax, number, nesting, duplicate_key, size, use };

    JsonError(Fault its_fault, const std::string& reason, std::size_t at = 0)
        : std::runtime_error(reason), fault(its_fault), byte(at) {}

    Fault fault;
    std::size_t byte;  // position of a syntax error, from 1 on; 0 for all other faults
};

// How a text is parsed.
struct JsonSyntax {
    bool comments = false;     // allows // and /* */
    bool unique_keys = false;  // refuses a key that stands twice in one object; otherwise the last value counts
    std::size_t max_values = std::size_t(-1);  // refuses a text with more; a member of an object counts as three
};

// How a value is printed.
struct JsonStyle {
    int indent = -1;          // spaces per level; -1: one line
    bool sorted = false;      // members by key, not in order of insertion
    bool lossy_text = false;  // bytes that are not UTF-8 become U+FFFD; otherwise they are refused
};

// The members of an object in order of insertion. A search takes logarithmic time.
class JsonObject {
 public:
    JsonObject();
    JsonObject(const JsonObject& other);
    JsonObject(JsonObject&& other) noexcept;
    JsonObject& operator=(JsonObject other) noexcept;
    ~JsonObject();

    [[nodiscard]] const std::vector<JsonMember>& members() const { return members_; }
    // The value of a key; null if there is none.
    [[nodiscard]] const Json* find(std::string_view key) const;
    // The value of a key, which is added if there is none.
    Json& member(std::string_view key);
    void erase(std::string_view key);

 private:
    struct Index;
    void index_all();

    std::vector<JsonMember> members_;
    std::unique_ptr<Index> index_;  // of an object with many members
};
bool operator==(const JsonObject& a, const JsonObject& b);

// A reference to an element or member is valid until the next one is added to the same array or object.
class Json {
 public:
    // The deepest nesting of a text that parse() accepts, so that no walk through a document exhausts the stack.
    static constexpr std::size_t max_depth = 50;

    Json();
    Json(std::nullptr_t);
    template <std::same_as<bool> Flag>
    Json(Flag value) : value_(value) {}
    Json(int value);
    Json(unsigned value);
    Json(long value);
    Json(unsigned long value);
    Json(long long value);
    Json(unsigned long long value);
    Json(double value);
    Json(const char* value);
    Json(std::string_view value);
    Json(std::string value);
    template <typename Element>
    Json(const std::vector<Element>& list) : Json(array()) {
        for (const Element& element : list) push_back(element);
    }
    // An object if every element is an array of a string and a value, otherwise an array.
    Json(std::initializer_list<Json> elements);
    static Json array(std::initializer_list<Json> elements = {});
    static Json object();

    Json(const Json& other);
    Json(Json&& other) noexcept;
    Json& operator=(const Json& other);
    Json& operator=(Json&& other) noexcept;
    ~Json();

    // Throws JsonError. Integers stay integers; a number that no double holds is refused.
    [[nodiscard]] static Json parse(std::string_view text, const JsonSyntax& syntax = {});
    // The same; none if the text is refused.
    [[nodiscard]] static std::optional<Json> try_parse(std::string_view text);
    // Throws JsonError for a text that is not UTF-8.
    [[nodiscard]] std::string dump(const JsonStyle& style = {}) const;

    [[nodiscard]] bool is_null() const { return std::holds_alternative<std::monostate>(value_); }
    [[nodiscard]] bool is_boolean() const { return std::holds_alternative<bool>(value_); }
    [[nodiscard]] bool is_number() const { return is_number_integer() || is_number_float(); }
    [[nodiscard]] bool is_number_integer() const {
        return std::holds_alternative<std::int64_t>(value_) || is_number_unsigned();
    }
    // Every integer of a text that is not negative.
    [[nodiscard]] bool is_number_unsigned() const { return std::holds_alternative<std::uint64_t>(value_); }
    [[nodiscard]] bool is_number_float() const { return std::holds_alternative<double>(value_); }
    [[nodiscard]] bool is_string() const { return std::holds_alternative<std::string>(value_); }
    [[nodiscard]] bool is_array() const { return std::holds_alternative<Array>(value_); }
    [[nodiscard]] bool is_object() const { return std::holds_alternative<JsonObject>(value_); }
    // "null", "boolean", "number", "string", "array", "object".
    [[nodiscard]] const char* type_name() const;

    // The value as bool, double, std::int64_t, std::uint64_t or std::string; a number as any of the three number types.
    // Throws JsonError for another type.
    template <typename Value>
    [[nodiscard]] Value get() const = delete;

    // Elements or members; 0 for null, 1 for any other value.
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] bool empty() const { return size() == 0; }

    // The elements of an array; none for null. Throws JsonError for another type.
    [[nodiscard]] const Json* begin() const;
    [[nodiscard]] const Json* end() const;
    [[nodiscard]] Json* begin() { return const_cast<Json*>(std::as_const(*this).begin()); }
    [[nodiscard]] Json* end() { return const_cast<Json*>(std::as_const(*this).end()); }
    // Appends to an array; null becomes one.
    void push_back(Json value);
    [[nodiscard]] Json& back() { return (*this)[size() - 1]; }
    [[nodiscard]] const Json& operator[](std::size_t index) const;
    [[nodiscard]] Json& operator[](std::size_t index) { return const_cast<Json&>(std::as_const(*this)[index]); }

    // The members of an object in order of insertion, or by key. Throws JsonError for another type.
    [[nodiscard]] const std::vector<JsonMember>& items() const;
    [[nodiscard]] std::vector<const JsonMember*> sorted_items() const;
    // The value of a key; null pointer if there is none or this is no object.
    [[nodiscard]] const Json* find(std::string_view key) const;
    [[nodiscard]] Json* find(std::string_view key) { return const_cast<Json*>(std::as_const(*this).find(key)); }
    [[nodiscard]] bool contains(std::string_view key) const { return find(key) != nullptr; }
    // The value of a key; a null value if there is none or this is no object.
    [[nodiscard]] const Json& operator[](std::string_view key) const;
    // The same; throws JsonError if there is none.
    [[nodiscard]] const Json& at(std::string_view key) const;
    // The value of a key, which is added if there is none; null becomes an object. Throws JsonError for another type.
    [[nodiscard]] Json& operator[](std::string_view key);
    void erase(std::string_view key);

    // Numbers are compared by value, objects without regard to order.
    friend bool operator==(const Json& a, const Json& b);

 private:
    using Array = std::vector<Json>;

    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, Array, JsonObject> value_;
};

template <>
bool Json::get<bool>() const;
template <>
double Json::get<double>() const;
template <>
std::int64_t Json::get<std::int64_t>() const;
template <>
std::uint64_t Json::get<std::uint64_t>() const;
template <>
std::string Json::get<std::string>() const;

// dump() on one line, with lossy text.
std::ostream& operator<<(std::ostream& out, const Json& value);

}  // namespace wade
