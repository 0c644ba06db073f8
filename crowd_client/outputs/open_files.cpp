#include "crowd_client/outputs/open_files.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <string>

#include "configs/errors/exit_code.hpp"

namespace wade::crowd {

void allow_open_files(std::span<const std::size_t> per_crowd) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    constexpr rlim_t others = 48;  // the segment, streams, files that are written as a whole, and some to spare
    rlim_t needed = others;
    std::size_t fitting = 0;
    for (const std::size_t files : per_crowd) {
        needed += files;
        if (needed <= limit.rlim_max) ++fitting;
    }
    if (needed > limit.rlim_max) {
        throw ConfigurationError("--crowds: " + std::to_string(per_crowd.size()) + " crowds keep up to " +
                                 std::to_string(needed) + " files open, but this process may have " +
                                 std::to_string(limit.rlim_max) + " (ulimit -Hn); allowed: the first " +
                                 std::to_string(fitting) +
                                 " crowds of the list, or fewer files with \"pictures\": false.");
    }
    limit.rlim_cur = std::max(limit.rlim_cur, needed);
    ::setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace wade::crowd
