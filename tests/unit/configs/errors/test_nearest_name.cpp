#include <catch2/catch.hpp>

#include "configs/errors/nearest_name.hpp"

using wade::edit_distance;
using wade::nearest_name;

TEST_CASE("edit distance counts insertions, deletions, replacements and swaps of neighbours") {
    CHECK(edit_distance("tau", "tau") == 0);
    CHECK(edit_distance("", "tau") == 3);
    CHECK(edit_distance("tau", "ta") == 1);
    CHECK(edit_distance("tau", "tou") == 1);
    CHECK(edit_distance("tau", "tua") == 1);
    CHECK(edit_distance("kitten", "sitting") == 3);
    CHECK(edit_distance("seed", "desired") == edit_distance("desired", "seed"));
}

TEST_CASE("the nearest name is the first with the smallest edit distance") {
    CHECK(nearest_name("clf", {"model", "cfl", "clx"}) == "cfl");
    CHECK(nearest_name("anything", {}).empty());
}
