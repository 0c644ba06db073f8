// The front of a dam break on people who stand and walk.

#include "cases.hpp"
#include "impulse.hpp"

namespace wade::validation {

Case impulse_front_case() {
    Case c;
    c.name = "impulse_front";
    c.truth =
        "our own finest run (tests/validation/data/impulse_front_*.csv): the front of a dam break, 1 m of water 5 m "
        "long, meets 16 people who stand and 9 who walk on a dry bed.";
    c.reference = "finest run";
    c.spacings = {0.4642, 0.2321, 0.1161};
    c.quick = true;
    c.run = [](const Request& request) { return run_impulse_case(request, "impulse_front"); };
    return c;
}

}  // namespace wade::validation
