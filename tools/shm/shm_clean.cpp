// shm_clean [PATTERN]: removes the segments that dead producers left behind, and only these.

#include <fcntl.h>
#include <fnmatch.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <iostream>
#include <optional>
#include <string>
#include <system_error>

#include "configs/errors/exit_code.hpp"
#include "configs/program/program.hpp"
#include "shm_protocol/inside/liveness.hpp"
#include "shm_protocol/inside/segment.hpp"
#include "tools/shm/observer.hpp"
#include "tools/shm/tool_arguments.hpp"

namespace {

using namespace wade;

enum class Fate { removed, kept, failed };

struct Verdict {
    Fate fate;
    std::string words;
};

// Whether the bytes at the start are those of a segment, finished or not. A producer sizes its segment before it stores
// the magic, so the word is 0 or absent until then.
bool is_segment(int fd, std::uint64_t bytes) {
    std::uint64_t magic = 0;
    if (bytes == 0) return true;
    return ::pread(fd, &magic, sizeof magic, 0) == static_cast<ssize_t>(sizeof magic) &&
           (magic == shm::magic || magic == 0);
}

Verdict judge(const std::string& name, bool dry_run) {
    std::optional<shm::SegmentFile> file;
    try {
        file = shm::SegmentFile::open(name);
    } catch (const shm::ForeignObject&) {
        return {Fate::kept, "is no plain file: " + shm::foreign_object(name)};
    } catch (const std::system_error& error) {
        if (error.code().value() != EACCES) throw;
        return {Fate::kept, "belongs to another user"};
    }
    if (!file) return {Fate::kept, "it is gone already"};
    if (!file->owned_by_this_user()) return {Fate::kept, "belongs to another user"};
    if (!is_segment(file->fd(), file->size())) return {Fate::kept, "is no segment of this protocol"};
    // Looked at before it is taken: a living producer must never find its byte locked by this program.
    if (shm::is_locked_by_other(file->fd(), shm::producer_lock_byte)) return {Fate::kept, "its producer is alive"};
    if (dry_run) return {Fate::removed, "its producer is dead"};
    if (!shm::lock_byte(file->fd(), shm::producer_lock_byte)) return {Fate::kept, "its producer is alive"};
    if (!file->is_named(name)) return {Fate::kept, "another one has the name by now"};
    if (::shm_unlink(name.c_str()) != 0) return {Fate::failed, std::strerror(errno)};
    return {Fate::removed, "its producer is dead"};
}

bool matches(const std::string& pattern, const std::string& name) {
    const std::string segment = name.substr(1);
    const std::string session = segment.substr(0, segment.rfind('-'));
    return pattern.empty() || ::fnmatch(pattern.c_str(), session.c_str(), 0) == 0 ||
           ::fnmatch(pattern.c_str(), segment.c_str(), 0) == 0;
}

int clean(const std::string& pattern, bool dry_run) {
    int removed = 0, kept = 0, failed = 0;
    for (const std::string& name : segment_names()) {
        if (!matches(pattern, name)) continue;
        Verdict verdict{};
        try {
            verdict = judge(name, dry_run);
        } catch (const std::exception& error) {
            verdict = {Fate::failed, error.what()};
        }
        const char* const word = verdict.fate == Fate::removed ? (dry_run ? "would remove" : "removed")
                                 : verdict.fate == Fate::kept  ? "kept"
                                                               : "FAILED";
        ++(verdict.fate == Fate::removed ? removed : verdict.fate == Fate::kept ? kept : failed);
        std::cout << word << "  " << shm::printable(name.data(), name.size()) << "  " << verdict.words << "\n";
    }
    std::cout << removed << (dry_run ? " to be removed, " : " removed, ") << kept << " kept";
    if (failed > 0) std::cout << ", " << failed << " failed";
    std::cout << std::endl;
    return static_cast<int>(failed > 0 ? ExitCode::unexpected : ExitCode::ok);
}

}  // namespace

int main(int argc, char** argv) {
    std::string pattern;
    bool dry_run = false;
    ToolArguments arguments(
        "shm_clean", "Removes the segments of dead producers in /dev/shm; never a living one's, never another user's.");
    arguments.positional("PATTERN", pattern, "Sessions or segments, with * and ? as a shell has them [all]", false);
    arguments.flag("--dry-run", dry_run, "Only say what would be removed");
    return run_tool(arguments, argc, argv, [&](Console&) { return clean(pattern, dry_run); });
}
