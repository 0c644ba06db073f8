#include "configs/version.hpp"

#include "wade_build_version.hpp"

namespace wade {

std::string_view version() {
    return WADE_BUILD_VERSION;
}
std::string_view git_hash() {
    return WADE_BUILD_GIT_HASH;
}
std::string_view compiler() {
    return WADE_BUILD_COMPILER;
}

}  // namespace wade
