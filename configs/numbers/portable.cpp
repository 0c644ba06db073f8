#include "configs/numbers/portable.hpp"

#include <boost/math/special_functions/cbrt.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <numbers>

namespace wade {
namespace {

// Without long double, which has another width on each processor.
using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

}  // namespace

double cube_root(double x) {
    return boost::math::cbrt(x, InDouble());
}

double normal_share(double z) {
    return 0.5 * boost::math::erfc(-z / std::numbers::sqrt2, InDouble());
}

}  // namespace wade
