// People in the lee of a block that stands in a stream.

#include "cases.hpp"
#include "impulse.hpp"

namespace wade::validation {

Case impulse_lee_case() {
    Case c;
    c.name = "impulse_lee";
    c.truth =
        "our own finest run (tests/validation/data/impulse_lee_*.csv): a block of 1.2 m x 1.2 m in a stream of 1 m/s, "
        "9 people stand in its lee, 6 beside it, 8 walk through the lee.";
    c.reference = "finest run";
    c.spacings = {0.4642, 0.2321, 0.1161};
    c.quick = true;
    c.run = [](const Request& request) { return run_impulse_case(request, "impulse_lee"); };
    return c;
}

}  // namespace wade::validation
