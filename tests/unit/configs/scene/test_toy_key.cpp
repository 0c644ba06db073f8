// A key is one line in a list of fields: what the documents say of a scene key, done with toys.

#include "configs/json/json.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/scene_documents.hpp"
#include "configs/scene/scene_json.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using wade::Fields;
using wade::Json;
using wade::Problems;

namespace toys {

struct Flag {
    double height = 2;
};
struct Boat {
    double draught = 0.5;
    int seats = 4;
    wade::Sides sides = wade::Sides::walls;
    wade::Spread load = 80;
    std::optional<double> keel;
    std::vector<Flag> flags;
};

void fields(Flag& flag, Fields& f) {
    f.number("height_m", flag.height, "m", wade::above(0), "Of its top.", wade::required);
}
void fields(Boat& boat, Fields& f) {
    f.number("draught_m", boat.draught, "m", wade::from(0).to(5), "Depth below the water line.");
    f.whole("seats", boat.seats, "", wade::from(1).to(9), "Places to sit.");
    f.choice("sides", boat.sides, "What it has at its sides.");
    f.spread("load_kg", boat.load, "kg", wade::from(0), "Mass of a passenger.");
    f.object(
        "hull",
        [&] { f.number("keel_m", boat.keel, "m", wade::from(0), "Length of the keel.", wade::otherwise("none")); },
        "The hull.");
    f.list("flags", boat.flags, "Flags, if any.");
}

Boat read(const std::string& text, Problems& problems) {
    Boat boat;
    const auto list = [&](Fields& f) { fields(boat, f); };
    const wade::KeyNode keys = wade::declared_keys([](Fields& f) {
        Boat fresh;
        fields(fresh, f);
    });
    const wade::Reading reading{"boat.json", problems, keys};
    const Json document = Json::parse(text);
    wade::check_keys(document, keys, "", reading);
    if (problems.none()) wade::read_fields(document, list, reading);
    return boat;
}

std::string refused(const std::string& text) {
    Problems problems;
    static_cast<void>(read(text, problems));
    try {
        problems.throw_if_any();
    } catch (const wade::ConfigurationError& error) {
        return error.what();
    }
    return "";
}

wade::KeyNode keys() {
    return wade::declared_keys([boat = Boat()](Fields& f) mutable { fields(boat, f); });
}

}  // namespace toys

TEST_CASE("a declared key is read into its member, and absent ones keep their defaults") {
    Problems problems;
    const toys::Boat boat = toys::read(
        R"({"draught_m": 1, "sides": "periodic", "load_kg": {"min": 50, "max": 90}, "hull": {"keel_m": 3},
            "flags": [{"height_m": 4}, {"height_m": 5}]})",
        problems);
    CHECK(problems.none());
    CHECK(boat.draught == 1);
    CHECK(boat.seats == 4);
    CHECK(boat.sides == wade::Sides::periodic);
    CHECK((boat.load.lo == 50 && boat.load.hi == 90));
    CHECK(boat.keel == 3);
    CHECK((boat.flags.size() == 2 && boat.flags[1].height == 5));
}

TEST_CASE("a declared key is written") {
    toys::Boat boat;
    boat.seats = 7;
    boat.flags.resize(1);
    const Json written = wade::written_fields([&](Fields& f) { fields(boat, f); });
    CHECK(written == Json::parse(R"({"draught_m": 0.5, "seats": 7, "sides": "walls", "load_kg": 80.0, "hull": {},
                                     "flags": [{"height_m": 2.0}]})"));
}

TEST_CASE("a declared key is in the schema with type, unit, range, default and meaning") {
    const Json schema = Json::parse(wade::schema_text(toys::keys()))["properties"];
    CHECK(schema["draught_m"] == Json::parse(R"({"type": "number", "x-unit": "m", "minimum": 0, "maximum": 5,
                                                 "default": 0.5, "description": "Depth below the water line."})"));
    CHECK(schema["seats"]["type"] == "integer");
    CHECK(schema["sides"]["enum"] == Json::parse(R"(["walls", "periodic"])"));
    CHECK(schema["load_kg"]["type"] == Json::parse(R"(["number", "object"])"));
    CHECK(schema["hull"]["properties"]["keel_m"]["x-default"] == "none");
    CHECK(schema["flags"]["items"]["required"] == Json::parse(R"(["height_m"])"));
}

TEST_CASE("a declared key is in the table of the documentation") {
    const std::string table = wade::keys_table(toys::keys());
    CHECK_THAT(table, Contains("| `draught_m` | m | [0, 5] | `0.5` | Depth below the water line. |\n"));
    CHECK_THAT(table, Contains("| `sides` |  | `walls`, `periodic` | `\"walls\"` | What it has at its sides. |\n"));
    CHECK_THAT(table, Contains("| `hull.keel_m` | m | [0, inf] | none | Length of the keel. |\n"));
    CHECK_THAT(table, Contains("| `flags[].height_m` | m | (0, inf] | **required** | Of its top. |\n"));
}

TEST_CASE("a declared key has its messages: nearest name, type, range, missing") {
    CHECK_THAT(toys::refused(R"({"draft_m": 1})"),
               Equals("boat.json: /draft_m: unknown key \"draft_m\"; the nearest known key is \"draught_m\"."));
    CHECK_THAT(toys::refused(R"({"keel_m": 1})"),
               Equals("boat.json: /keel_m: unknown key \"keel_m\"; the nearest known key is /hull/keel_m."));
    CHECK_THAT(toys::refused(R"({"seats": 1.5})"), Contains("/seats: expected a whole number, found 1.5"));
    CHECK_THAT(toys::refused(R"({"draught_m": 6})"),
               Contains("/draught_m: 6 is out of range; allowed: >= 0 and <= 5 m."));
    CHECK_THAT(toys::refused(R"({"flags": [{}]})"),
               Contains("/flags/0/height_m: required key \"height_m\" is missing"));
}
