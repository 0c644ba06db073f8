#include "configs/program/version.hpp"

#include <cstddef>
#include <string>

#include "wade_build_version.hpp"

namespace wade {

namespace {

// A field of fixed size with a mark: two builds that differ in the commit that they name, or in "-dirty", differ in these
// bytes alone. Scripts blank it and so tell whether a program would still compute the same. Volatile, or the compiler
// would put the length of the name into its code.
const volatile char commit_field[64] = "wade-commit=" WADE_BUILD_GIT_HASH;
constexpr std::size_t mark_length = 12;

std::string read_commit() {
    std::string text;
    for (std::size_t i = mark_length; i < sizeof commit_field && commit_field[i] != 0; ++i) text += commit_field[i];
    return text;
}

}  // namespace

std::string_view version() {
    return WADE_BUILD_VERSION;
}
std::string_view git_hash() {
    static const std::string text = read_commit();
    return text;
}
std::string_view compiler() {
    return WADE_BUILD_COMPILER;
}

}  // namespace wade
