// Height and mass by age and sex, and implausible sizes.

#include <catch2/catch.hpp>
#include <cmath>

#include "configs/json/json.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/person_size.hpp"
#include "scene_texts.hpp"

namespace wade::person_size_test {

// Returns the random number with the normal score z, within 2.
double draw_of(double z) {
    return (normal_share(z) - normal_share(-2)) / (normal_share(2) - normal_share(-2));
}

PersonSize by_age(double age, bool is_male, double height_score = 0, double mass_score = 0) {
    return size_of_person({}, {}, age, is_male, {0, draw_of(height_score), 0, 0, 0, draw_of(mass_score)});
}

// Of one resident, in the group of the houses, which may have keys of its own.
std::string refused_resident(const std::string& row, const std::string& keys = "") {
    const test::TemporaryFolder folder;
    folder.write("r.csv", "x,y,age,height,mass\n5,5,,,\n" + row + "\n");
    const auto scene =
        folder.write("scene.json",
                     R"({"world": {"length_m": 20, "width_m": 20}, "site": {"epsg": 0, "residents_csv": "r.csv",
            "shelters": [{"polygon": [[15, 15], [18, 15], [18, 18]]}]},
            "crowd": {"groups": [{"name": "a", "start": {"from": "houses"}, "goal": {"to": "shelters"})" +
                         keys + "}]}}");
    try {
        (void)load_scene(scene);
    } catch (const std::exception& error) {
        return error.what();
    }
    return "nothing is refused";
}

}  // namespace wade::person_size_test

using namespace wade::person_size_test;
using Catch::Matchers::Contains;
using wade::AgentGroup;
using wade::PersonRow;
using wade::PersonSize;

TEST_CASE("sizes of children are those of the growth charts") {
    // Published medians within half of their last digit, per cents within that and half of the last digit of the table's median.
    CHECK(by_age(4, true).height == Approx(1.022).margin(0.0005));
    CHECK(by_age(4, true).mass == Approx(16.2).margin(0.05));
    CHECK(by_age(8, false).height == Approx(1.276).margin(0.0005));
    CHECK(by_age(7, true).height * by_age(7, true).mass == Approx(28.1).margin(0.1));
    CHECK(by_age(2, true, -1.645).height == Approx(0.807).margin(0.001));
    CHECK(by_age(2, true, 1.645).height == Approx(0.922).margin(0.001));
    CHECK(by_age(5.5, true).height == Approx((1.089 + 1.154) / 2).margin(0.0005));
    for (const bool is_male : {false, true}) {
        double last = 0;
        for (double age = 3; age < wade::adult_age; age += 0.25) {
            const PersonSize size = by_age(age, is_male);
            CHECK(size.height * size.mass > last);
            last = size.height * size.mass;
            CHECK_FALSE(wade::fault_of_size(wade::Interval{age, age}, size.height, size.mass));
            CHECK_FALSE(wade::fault_of_size(wade::Interval{age, age}, by_age(age, is_male, -2, 2).height,
                                            by_age(age, is_male, -2, 2).mass));
        }
    }
}

TEST_CASE("tall children are heavy, and one size sets the score of the other") {
    CHECK(by_age(6, false, 1).mass > by_age(6, false).mass);
    PersonRow tall;
    tall.height = by_age(6, false, 1.5).height;
    CHECK(size_of_person({}, tall, 6, false, {0, 0, 0, 0, 0, 0.5}).mass == Approx(by_age(6, false, 1.5).mass));
    PersonRow heavy;
    heavy.mass = 30;
    const PersonSize size = size_of_person({}, heavy, 6, false, {0, 0.5, 0, 0, 0, 0});
    CHECK((size.mass == 30 && size.height > by_age(6, false).height));
}

TEST_CASE("adults have 1.7 m and 65 kg, and sizes of a group with adults hold for its adults") {
    CHECK((by_age(20, true, 1).height == 1.7 && by_age(80, false, 1).mass == 65));
    AgentGroup mixed;
    mixed.body.age = {4, 80};
    mixed.body.height = 1.9;
    mixed.mass = 90;
    CHECK(
        (size_of_person(mixed, {}, 40, true, {}).height == 1.9 && size_of_person(mixed, {}, 40, true, {}).mass == 90));
    CHECK(size_of_person(mixed, {}, 4, true, {0, 0.5, 0, 0, 0, 0.5}).height == by_age(4, true).height);
    AgentGroup children;
    children.body.age = {4, 6};
    children.body.height = 1.2;
    CHECK(size_of_person(children, {}, 4, true, {}).height == 1.2);
    CHECK(size_of_person(children, {}, 40, true, {}).height == 1.7);
}

TEST_CASE("a group of children does not take over the sizes of a crowd of adults") {
    const std::string two = wade::test::crowd(wade::test::group("a", 1, 1, R"(, "age": {"min": 4, "max": 8})") + "," +
                                              wade::test::group("b", 2, 2));
    const auto loaded = wade::test::load_patched(two, {"/crowd/mass_kg=80", "/crowd/height_m=1.8"});
    const auto& groups = loaded.scene.crowd->groups;
    CHECK((!groups.at(0).mass && !groups.at(0).body.height));
    CHECK((*groups.at(1).mass == 80 && *groups.at(1).body.height == 1.8));
    CHECK(wade::load_scene_text(loaded.canonical_json, "again.json").canonical_json == loaded.canonical_json);
}

TEST_CASE("people of no plausible size are refused with file, row, key, value and allowed range") {
    CHECK(refused_resident("6,6,4,,") == "nothing is refused");
    CHECK(refused_resident("6,6,4,1.1,20") == "nothing is refused");
    CHECK_THAT(
        refused_resident("6,6,3,,1000"),
        Contains("r.csv: line 3: mass: 1000 kg is no body of a person at an age of 3 years; allowed: 5.5 to 57.2 kg"));
    CHECK_THAT(refused_resident("6,6,4,1.7,"),
               Contains("r.csv: line 3: height: 1.7 m") && Contains("at an age of 4 years; allowed: 0.6 to 1.44 m"));
    CHECK_THAT(refused_resident("6,6,40,0.8,"), Contains("line 3: height: 0.8 m") && Contains("allowed: 1 to 2.5 m"));
    CHECK_THAT(refused_resident("6,6,40,1.8,10"), Contains("line 3: mass: 10 kg with a height of 1.8 m"));
    CHECK_THAT(refused_resident("6,6,,0.8,", R"(, "age": {"min": 10, "max": 12})"),
               Contains("line 3: height: 0.8 m") && Contains("at ages of 10 to 12 years"));

    const auto refused = [](const std::string& keys) {
        return wade::test::refusal(wade::test::crowd(wade::test::group("a", 1, 1, keys)), {"/crowd/response=measured"});
    };
    CHECK_THAT(refused(R"(, "age": 4, "height_m": 1.7)"), Contains("/crowd/groups/0/height_m: 1.7 m is no body"));
    CHECK_THAT(refused(R"(, "age": {"min": 3, "max": 5}, "mass_kg": {"min": 20, "max": 1000})"),
               Contains("/crowd/groups/0/mass_kg: 1000 kg is no body of a person at ages of 3 to 5 years"));
    CHECK_THAT(refused(R"(, "people": [{"age": 4}, {"age": 3, "mass_kg": 1000}])"),
               Contains("/crowd/groups/0/people/1/mass_kg: 1000 kg"));
}
