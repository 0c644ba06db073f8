#pragma once
// Which build this is, for --version and the manifest.

#include <string_view>

namespace wade {

// Release number, for example "0.1.0".
[[nodiscard]] std::string_view version();

// First 12 digits of the commit, with "-dirty" if tracked files differ from it; "unknown" outside a git checkout.
[[nodiscard]] std::string_view git_hash();

// Name and version of the compiler, for example "GNU 12.2.0".
[[nodiscard]] std::string_view compiler();

}  // namespace wade
