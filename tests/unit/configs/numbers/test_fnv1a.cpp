#include <catch2/catch.hpp>

#include "configs/numbers/fnv1a.hpp"

using namespace wade;

TEST_CASE("hashes of texts are those of the published test vectors", "[numbers]") {
    CHECK(fnv1a("") == 0xcbf29ce484222325ULL);
    CHECK(fnv1a("a") == 0xaf63dc4c8601ec8cULL);
    CHECK(fnv1a("foobar") == 0x85944171f73967e8ULL);
    CHECK(fnv1a("\xff") == fnv1a_next(fnv1a_basis, 0xff));  // bytes have no sign
}
