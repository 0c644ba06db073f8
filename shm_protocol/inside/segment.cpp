#include "shm_protocol/inside/segment.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/interprocess/exceptions.hpp>
#include <boost/interprocess/permissions.hpp>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "shm_protocol/error.hpp"
#include "shm_protocol/inside/liveness.hpp"
#include "shm_protocol/layout.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::shm {
namespace {

namespace ipc = boost::interprocess;

[[noreturn]] void fail(int error, const std::string& doing) {
    throw std::system_error(error, std::generic_category(), doing);
}

// The process that a living segment's control page names, as a remark for the user.
std::string holder(int fd) {
    std::uint32_t pid = 0;
    const off_t at = static_cast<off_t>(control_offset + offsetof(Control, pid));
    if (pread(fd, &pid, sizeof pid, at) != static_cast<ssize_t>(sizeof pid) || pid == 0) return "";
    return " (process " + std::to_string(pid) + ")";
}

}  // namespace

std::string segment_name(const std::string& session, StreamKind kind) {
    constexpr const char* allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
    constexpr std::size_t longest = 200;  // file names end at 255 bytes
    if (session.empty() || session.size() > longest || session.find_first_not_of(allowed) != std::string::npos)
        throw std::invalid_argument("Session name '" + session +
                                    "' is not allowed: 1 to 200 characters of A-Z a-z 0-9 . _ - are.");
    return "/" + session + (kind == stream_agents ? "-agents" : "-fluid");
}

std::optional<SegmentFile> SegmentFile::open(const std::string& name) {
    SegmentFile file;
    try {
        file.object_ = ipc::shared_memory_object(ipc::open_only, name.c_str(), ipc::read_write);
    } catch (const ipc::interprocess_exception& e) {
        if (e.get_native_error() == ENOENT) return std::nullopt;
        fail(e.get_native_error(), "opening the shared-memory segment " + name);
    }
    return file;
}

std::optional<SegmentFile> SegmentFile::create_exclusive(const std::string& name) {
    SegmentFile file;
    try {
        file.object_ =
            ipc::shared_memory_object(ipc::create_only, name.c_str(), ipc::read_write, ipc::permissions(0600));
    } catch (const ipc::interprocess_exception& e) {
        if (e.get_native_error() == EEXIST) return std::nullopt;
        fail(e.get_native_error(), "creating the shared-memory segment " + name);
    }
    return file;
}

bool SegmentFile::owned_by_this_user() const {
    struct stat about {};
    return fstat(fd(), &about) == 0 && about.st_uid == geteuid();
}

bool SegmentFile::open_to_group_of_this_process() const {
    struct stat about {};
    if (fstat(fd(), &about) != 0 || (about.st_mode & 0060) != 0060) return false;
    if (about.st_gid == getegid()) return true;
    std::vector<gid_t> groups(static_cast<std::size_t>(std::max(getgroups(0, nullptr), 0)));
    const int n = getgroups(static_cast<int>(groups.size()), groups.data());
    return n > 0 && std::find(groups.begin(), groups.begin() + n, about.st_gid) != groups.begin() + n;
}

void SegmentFile::open_to_group(const std::string& name) const {
    if (fchmod(fd(), 0660) != 0) fail(errno, "opening the shared-memory segment " + name + " to its group");
}

std::uint64_t SegmentFile::size() const {
    struct stat about {};
    return fstat(fd(), &about) == 0 && about.st_size > 0 ? static_cast<std::uint64_t>(about.st_size) : 0;
}

bool SegmentFile::is_named(const std::string& name) const {
    struct stat mine {};
    struct stat named {};
    const int other = shm_open(name.c_str(), O_RDONLY | O_CLOEXEC, 0);
    if (other < 0) return false;
    const bool known = fstat(fd(), &mine) == 0 && fstat(other, &named) == 0;
    ::close(other);
    return known && mine.st_ino == named.st_ino && mine.st_dev == named.st_dev;
}

void SegmentFile::allocate(const std::string& name, std::uint64_t bytes) const {
    int error = 0;
    do {
        error = posix_fallocate(fd(), 0, static_cast<off_t>(bytes));
    } while (error == EINTR);
    if (error != 0)
        fail(error, "allocating " + std::to_string(bytes) + " bytes of shared memory for " + name +
                        " (see 'df /dev/shm' for what is free)");
}

ipc::mapped_region SegmentFile::map(std::uint64_t offset, std::uint64_t bytes, bool writable) const {
    try {
        return ipc::mapped_region(object_, writable ? ipc::read_write : ipc::read_only,
                                  static_cast<ipc::offset_t>(offset), bytes, nullptr, MAP_POPULATE);
    } catch (const ipc::interprocess_exception& e) {
        fail(e.get_native_error(), "mapping " + std::to_string(bytes) + " bytes of shared memory");
    }
}

// Whoever holds the producer lock of an object decides about it, and only while its name still leads to it. Each step
// may lose against another process that does the same; then the round starts again with what that one left.
SegmentFile create_segment(const std::string& name, std::uint64_t bytes, bool group_access) {
    constexpr int rounds = 100;  // each lost round means that another process made progress
    for (int round = 0; round < rounds; ++round) {
        if (auto created = SegmentFile::create_exclusive(name)) {
            if (!lock_byte(created->fd(), producer_lock_byte) || !created->is_named(name)) continue;
            try {
                if (group_access) created->open_to_group(name);
                created->allocate(name, bytes);
            } catch (...) {
                unlink_segment(*created, name);
                throw;
            }
            return std::move(*created);
        }
        std::optional<SegmentFile> old;
        try {
            old = SegmentFile::open(name);
        } catch (const std::system_error& e) {
            if (e.code().value() != EACCES) throw;
            throw Error(Failure::name_in_use,
                        "The shared-memory segment " + name + " belongs to another user; choose another session name.");
        }
        if (!old) continue;
        if (!old->owned_by_this_user())
            throw Error(Failure::name_in_use,
                        "The shared-memory segment " + name + " belongs to another user; choose another session name.");
        if (!lock_byte(old->fd(), producer_lock_byte)) {
            if (!old->is_named(name)) continue;
            throw Error(Failure::name_in_use, "The shared-memory segment " + name + " is in use by a living producer" +
                                                  holder(old->fd()) +
                                                  "; stop that one or choose another session name.");
        }
        unlink_segment(*old, name);
    }
    throw Error(Failure::name_in_use, "The name " + name + " is fought over by other producers.");
}

bool has_living_producer(const std::string& session, StreamKind kind) {
    const std::string name = segment_name(session, kind);
    std::optional<SegmentFile> file;
    try {
        file = SegmentFile::open(name);
    } catch (const std::system_error&) {
        return true;  // another user's
    }
    return file && is_locked_by_other(file->fd(), producer_lock_byte);
}

void unlink_segment(const SegmentFile& file, const std::string& name) noexcept {
    if (file.is_named(name)) ipc::shared_memory_object::remove(name.c_str());
}

}  // namespace wade::shm
