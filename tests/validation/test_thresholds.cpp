// The tables of thresholds and of known failures: how they are read, and that each line means something.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "configs/errors/exit_code.hpp"
#include "thresholds.hpp"
#include "validation_case.hpp"

using namespace wade;
using namespace wade::validation;

namespace {

struct TemporaryFile {
    std::filesystem::path path;
    explicit TemporaryFile(const std::string& text) {
        char name[] = "/tmp/wade-table-XXXXXX";
        std::fclose(fdopen(mkstemp(name), "w"));
        path = name;
        std::ofstream(path) << text;
    }
    ~TemporaryFile() { std::filesystem::remove(path); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
};

bool is_case(const std::string& name) {
    return std::any_of(all_cases().begin(), all_cases().end(), [&](const Case& c) { return c.name == name; });
}

}  // namespace

TEST_CASE("a threshold holds for the finer levels until another is given", "[thresholds]") {
    const TemporaryFile file("case,metric,coarse,medium,fine,reason\na,x,0.1,,0.05,one, two\nb,y,-,2,,why\n");
    const auto all = read_thresholds(file.path);
    REQUIRE(all.size() == 2);
    CHECK(all[0].reason == "one, two");
    CHECK(threshold_of(all, "a", "x", 0) == 0.1);
    CHECK(threshold_of(all, "a", "x", 1) == 0.1);
    CHECK(threshold_of(all, "a", "x", 2) == 0.05);
    CHECK(threshold_of(all, "b", "y", 0) == std::nullopt);
    CHECK(threshold_of(all, "b", "y", 2) == 2);
    CHECK(threshold_of(all, "a", "y", 0) == std::nullopt);
}

TEST_CASE("a wrong table is refused with file and line", "[thresholds]") {
    const std::string names = "case,metric,coarse,medium,fine,reason\n";
    for (const char* row : {"a,x,0.1,,,\n", "a,x,0.1\n", "a,x,-1,,,why\n", "a,x,,,,why\n", "a,x,1z,,,why\n"}) {
        const TemporaryFile file(names + row);
        CHECK_THROWS_WITH(read_thresholds(file.path), Catch::Contains(file.path.string() + ", line 2"));
    }
    const TemporaryFile file("case,metric,level,guard,reason\na,x,rough,1,why\n");
    CHECK_THROWS_WITH(read_known_failures(file.path), Catch::Contains("line 2: level \"rough\""));
    const TemporaryFile of_another_suite("case,setting,rule,guard,reason\na,default,x,1,why\n");
    CHECK_THROWS_WITH(read_thresholds(of_another_suite.path), Catch::Contains("line 1: \"case,setting"));
    CHECK_THROWS_AS(read_thresholds("/nowhere"), ConfigurationError);
}

TEST_CASE("the shipped tables name cases that exist, each metric once, and guards above thresholds", "[thresholds]") {
    const std::filesystem::path folder = WADE_VALIDATION;
    const auto thresholds = read_thresholds(folder / "thresholds.csv");
    for (const Threshold& row : thresholds) {
        INFO(row.case_name << ',' << row.metric);
        CHECK(is_case(row.case_name));
        CHECK(std::count_if(thresholds.begin(), thresholds.end(), [&](const Threshold& other) {
                  return other.case_name == row.case_name && other.metric == row.metric;
              }) == 1);
    }
    for (const KnownFailure& row : read_known_failures(folder / "known_failures.csv")) {
        INFO(row.case_name << ',' << row.metric << ',' << row.level);
        const auto level = std::find(level_names.begin(), level_names.end(), row.level) - level_names.begin();
        const auto threshold = threshold_of(thresholds, row.case_name, row.metric, static_cast<std::size_t>(level));
        REQUIRE(threshold);
        CHECK(row.guard > *threshold);
    }
}

TEST_CASE("each case has a name of its own and says what it is compared with", "[cases]") {
    for (const Case& c : all_cases()) {
        INFO(c.name);
        CHECK(std::count_if(all_cases().begin(), all_cases().end(), [&](const Case& o) { return o.name == c.name; }) ==
              1);
        CHECK(c.run != nullptr);
        CHECK_FALSE(c.truth.empty());
        CHECK_FALSE(c.reference.empty());
        CHECK(c.reference.find(',') == std::string::npos);  // goes into a CSV table
        CHECK(!c.spacings.empty());
        CHECK(c.spacings.size() <= 3);
        CHECK(c.quick_level < c.spacings.size());
    }
}
