// What every output promises; one that is in the list is tried here by being in the list.

#include <catch2/catch.hpp>
#include <set>

#include "outputs/conformance.hpp"

using namespace wade::crowd;

TEST_CASE("Every output keeps what outputs promise") {
    for (const RegisteredOutput& output : outputs()) {
        INFO("output " << output.files[0]);
        testing::check_output(output);
    }
}

TEST_CASE("No two outputs have a file in common") {
    std::set<std::string_view> names;
    std::size_t count = 0;
    for (const RegisteredOutput& output : outputs()) {
        for (const std::string_view file : output.files) {
            if (file.empty()) continue;
            names.insert(file);
            ++count;
        }
    }
    CHECK(names.size() == count);
    CHECK(names.contains("trajectories.sqlite"));
}
