// JSON as a value: what is parsed, refused, found and printed.

#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>

#include "configs/json/json.hpp"

namespace wade::json_test {

std::string round_trip(const std::string& text) {
    return Json::parse(text).dump();
}

JsonError refused_text(const std::string& text, const JsonSyntax& syntax = {}) {
    try {
        static_cast<void>(Json::parse(text, syntax));
    } catch (const JsonError& error) {
        return error;
    }
    FAIL("accepted: " << text.substr(0, 100));
    return {JsonError::Fault::use, ""};
}

std::string nested(std::size_t depth, const std::string& innermost) {
    return std::string(depth, '[') + innermost + std::string(depth, ']');
}

std::string number_key(int i) {
    return "key" + std::to_string(i);
}

// {"key0":0,"key1":1,...}
std::string wide_object(int members) {
    std::string text = "{";
    for (int i = 0; i < members; ++i) text += (i == 0 ? "\"" : ",\"") + number_key(i) + "\":" + std::to_string(i);
    return text + "}";
}

}  // namespace wade::json_test

using namespace wade::json_test;
using wade::Json;
using wade::JsonError;
using Fault = wade::JsonError::Fault;

TEST_CASE("numbers are printed as they were read, integers as integers") {
    for (const std::string text :
         {"0", "-1", "9223372036854775807", "-9223372036854775808", "9223372036854775808", "18446744073709551615",
          "0.1", "-0.0", "1e+300", "5e-324", "0.30000000000000004", "1.7976931348623157e+308", "123456789.125"})
        CHECK(round_trip(text) == text);
    CHECK(round_trip("1e2") == "100.0");
    CHECK(round_trip("18446744073709551616") == "1.8446744073709552e+19");
    CHECK(Json::parse("18446744073709551615").get<std::uint64_t>() == std::numeric_limits<std::uint64_t>::max());
    CHECK(Json::parse("5").is_number_integer());
    CHECK(Json::parse("5.0").is_number_float());
    CHECK(Json::parse("-5").get<double>() == -5);
}

TEST_CASE("values that no JSON number has are printed as null") {
    CHECK(Json(std::numeric_limits<double>::quiet_NaN()).dump() == "null");
    CHECK(Json(std::numeric_limits<double>::infinity()).dump() == "null");
}

TEST_CASE("texts keep their characters, escaped where JSON needs it") {
    CHECK(round_trip(R"("a\"\\\/\n\t\u0001é\u00e9\ud83d\ude00")") == "\"a\\\"\\\\/\\n\\t\\u0001éé😀\"");
    CHECK(Json::parse("\"a\\u0000b\"").get<std::string>() == std::string("a\0b", 3));
}

TEST_CASE("bytes that are not UTF-8 are refused, or replaced on demand") {
    const Json text(
        "a\xff"
        "b");
    CHECK_THROWS_AS(text.dump(), JsonError);
    CHECK(text.dump({.lossy_text = true}) == "\"a\uFFFDb\"");
    CHECK(refused_text("\"a\xff\"").fault == Fault::syntax);
}

TEST_CASE("members keep the order of insertion, and are printed by key on demand") {
    Json value = Json::parse(R"({"b": {"z": 1, "y": 2}, "a": [{"d": 3, "c": 4}]})");
    value["0"] = nullptr;
    value["b"]["x"] = true;
    CHECK(value.dump() == R"({"b":{"z":1,"y":2,"x":true},"a":[{"d":3,"c":4}],"0":null})");
    CHECK(value.dump({.sorted = true}) == R"({"0":null,"a":[{"c":4,"d":3}],"b":{"x":true,"y":2,"z":1}})");
    CHECK(value.dump({.indent = 1}).starts_with("{\n \"b\": {\n  \"z\": 1,\n"));
    value.erase("b");
    CHECK(value.items().size() == 2);
    CHECK(value.sorted_items().front()->first == "0");
    CHECK_FALSE(value.contains("b"));
}

TEST_CASE("values are equal whatever the order of members and the type of numbers") {
    CHECK(Json::parse(R"({"a": 1, "b": [2.0]})") == Json::parse(R"({"b": [2], "a": 1.0})"));
    CHECK(Json::parse(R"({"a": 1})") != Json::parse(R"({"a": 1, "b": 2})"));
    CHECK(Json::parse(R"({"a": 1})") != Json::parse(R"({"b": 1})"));
    CHECK(Json(1) != Json(true));
    CHECK(Json("1") != Json(1));
    CHECK(Json(-1) == Json(-1.0));
    CHECK(Json(-1) != Json(std::numeric_limits<std::uint64_t>::max()));
    CHECK(Json(1) == Json(1U));
}

TEST_CASE("a list is an object if each element is a text and a value") {
    CHECK(Json{{"a", 1}, {"b", nullptr}}.dump() == R"({"a":1,"b":null})");
    CHECK(Json{1, "a", 0.5}.dump() == R"([1,"a",0.5])");
    CHECK(Json{"a"}.dump() == R"(["a"])");
    CHECK(Json{{1, 2}, {3, 4}}.dump() == "[[1,2],[3,4]]");
    CHECK(Json{{"a", {1, 2}}, {"b", {{"c", "d"}}}}.dump() == R"({"a":[1,2],"b":{"c":"d"}})");
    CHECK(Json::array({{"a", 1}}).dump() == R"([["a",1]])");
    CHECK(Json(std::vector<std::string>{"a", "b"}).dump() == R"(["a","b"])");
    CHECK(Json(std::vector<std::string>{}).dump() == "[]");
}

TEST_CASE("what is not there is null when read, and added when written") {
    Json value;
    value["a"]["b"] = 1;
    value["c"].push_back(2);
    const Json& read = value;
    CHECK(read["a"]["b"] == 1);
    CHECK(read["c"][0] == 2);
    CHECK(read["none"]["none"].is_null());
    CHECK(read["c"]["none"].is_null());
    CHECK(value.size() == 2);
    CHECK_THROWS_WITH(read.at("none"), "there is no key \"none\"");
    CHECK_THROWS_WITH(read["a"].get<std::string>(), "expected string, found object");
    CHECK_THROWS_WITH(value["c"]["key"], "expected object, found array");
    CHECK_THROWS(read["c"][1]);
}

TEST_CASE("a syntax error has its byte and a reason") {
    const auto check = [](const std::string& text, std::size_t byte, const std::string& reason) {
        const JsonError error = refused_text(text);
        CHECK(error.fault == Fault::syntax);
        CHECK(error.byte == byte);
        CHECK_THAT(error.what(), Catch::Contains(reason));
        CHECK_FALSE(Json::try_parse(text));
    };
    check("", 1, "unexpected end of input");
    check("{\"a\" 2}", 6, "expected ':'");
    check("[1,]", 4, "unexpected ']'");
    check("[1", 3, "unexpected end of input; expected ']'");
    check("1 2", 3, "expected end of input");
    check("[1] // one", 5, "invalid literal");
    CHECK(Json::parse("[1] // one", {.comments = true}).size() == 1);
}

TEST_CASE("a JSON number that no double holds is refused") {
    CHECK(refused_text("[1e400]").fault == Fault::number);
    CHECK_THAT(refused_text("[1e400]").what(), Catch::Contains("number overflow parsing '1e400'"));
    CHECK(round_trip("1e-400") == "0.0");
}

TEST_CASE("of a key that stands twice the last value counts, or the text is refused") {
    const std::string text = R"({"a": 1, "b": {"c": 1, "d": 2, "c": 3}, "a": 4})";
    CHECK(round_trip(text) == R"({"a":4,"b":{"c":3,"d":2}})");
    const JsonError error = refused_text(text, {.unique_keys = true});
    CHECK(error.fault == Fault::duplicate_key);
    CHECK_THAT(error.what(), Catch::Equals("the key \"c\" stands twice in one object"));
    CHECK_NOTHROW(Json::parse(R"([{"a": 1}, {"a": {"a": 1}}])", {.unique_keys = true}));
}

TEST_CASE("nesting has a limit, and a fault of the syntax comes first") {
    CHECK(round_trip(nested(Json::max_depth, "1")) == nested(Json::max_depth, "1"));
    CHECK(refused_text(nested(Json::max_depth + 1, "1")).fault == Fault::nesting);
    const std::size_t many = 1'000'000;
    CHECK(refused_text(nested(many, "")).fault == Fault::nesting);
    CHECK(refused_text(std::string(many, '[')).fault == Fault::syntax);
    std::string objects = "1";
    for (int i = 0; i < 60; ++i) objects = "{\"a\":" + objects + ",\"a\":[]}";
    CHECK(refused_text(objects, {.unique_keys = true}).fault == Fault::nesting);
}

// A search that compares all keys would compare 2e11 of them here, which takes longer than a test may.
TEST_CASE("a million members are parsed, found, copied, compared and printed") {
    const int members = 1'000'000;
    const std::string text = wide_object(members);
    const Json value = Json::parse(text, {.unique_keys = true});
    const Json copy = value;
    int found = 0;
    for (int i = 0; i < members; ++i) found += copy[number_key(i)] == i ? 1 : 0;
    CHECK(found == members);
    CHECK((copy == value));
    CHECK((copy.dump() == text));
    CHECK(copy.dump({.sorted = true}).starts_with(R"({"key0":0,"key1":1,"key10":10,)"));
}

TEST_CASE("an object is searched alike below and above the size at which it gets an index") {
    Json value;
    for (int i = 0; i < 40; ++i) {
        value[number_key(i)] = i;
        value["0"] = i;
        for (int k = 0; k <= i; ++k) REQUIRE(value[number_key(k)] == k);
        REQUIRE(value.size() == static_cast<std::size_t>(i) + 2);
    }
    for (int i = 39; i >= 0; --i) {
        value.erase(number_key(i));
        REQUIRE_FALSE(value.contains(number_key(i)));
        for (int k = 0; k < i; ++k) REQUIRE(value[number_key(k)] == k);
    }
    CHECK(value.size() == 1);
}
