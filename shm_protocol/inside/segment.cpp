#include "shm_protocol/inside/segment.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/interprocess/exceptions.hpp>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>
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

std::string path_of(const std::string& name) {
    return "/dev/shm" + name;
}

std::string foreign_object(const std::string& name) {
    struct stat about {};
    if (lstat(path_of(name).c_str(), &about) != 0 || S_ISREG(about.st_mode)) return "";
    const char* const kind = S_ISFIFO(about.st_mode)   ? "a FIFO"
                             : S_ISDIR(about.st_mode)  ? "a directory"
                             : S_ISSOCK(about.st_mode) ? "a socket"
                             : S_ISLNK(about.st_mode)  ? "a symbolic link"
                                                       : "a device";
    return kind + (" of user " + std::to_string(about.st_uid));
}

SegmentFile::~SegmentFile() {
    if (fd_ >= 0) ::close(fd_);
}

SegmentFile::SegmentFile(SegmentFile&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

SegmentFile& SegmentFile::operator=(SegmentFile&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
}

// What lies there is looked at before it is opened, for opening a FIFO or a device may block or do something; and after,
// for the name may lead elsewhere by then.
std::optional<SegmentFile> SegmentFile::open(const std::string& name, Access access) {
    const auto refuse_foreign = [&](const std::string& what) {
        throw ForeignObject("The name " + name + " leads to " + what + ", which is no shared-memory segment");
    };
    if (const std::string foreign = foreign_object(name); !foreign.empty()) refuse_foreign(foreign);
    const int mode = access == Access::read_only ? O_RDONLY : O_RDWR;
    SegmentFile file(::shm_open(name.c_str(), mode | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0));
    if (file.fd_ < 0) {
        if (errno == ENOENT) return std::nullopt;
        fail(errno, "opening the shared-memory segment " + name);
    }
    struct stat about {};
    if (fstat(file.fd_, &about) != 0 || !S_ISREG(about.st_mode)) refuse_foreign("something else than a plain file");
    return file;
}

std::optional<SegmentFile> SegmentFile::create_exclusive(const std::string& name) {
    SegmentFile file(::shm_open(name.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0600));
    if (file.fd_ >= 0) return file;
    if (errno == EEXIST) return std::nullopt;
    fail(errno, "creating the shared-memory segment " + name);
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
    return fstat(fd(), &mine) == 0 && lstat(path_of(name).c_str(), &named) == 0 && mine.st_ino == named.st_ino &&
           mine.st_dev == named.st_dev;
}

// Throws if the size exceeds RLIMIT_FSIZE, because the kernel would end the process with SIGXFSZ.
void SegmentFile::allocate(const std::string& name, std::uint64_t bytes) const {
    const std::string doing = "allocating " + std::to_string(bytes) + " bytes of shared memory for " + name;
    rlimit largest{};
    if (getrlimit(RLIMIT_FSIZE, &largest) == 0 && bytes > largest.rlim_cur)
        fail(EFBIG, doing + " (see 'ulimit -f' for the largest file that this process may write)");
    int error = 0;
    do {
        error = posix_fallocate(fd(), 0, static_cast<off_t>(bytes));
    } while (error == EINTR);
    if (error != 0) fail(error, doing + " (see 'df /dev/shm' for what is free)");
}

ipc::mapped_region SegmentFile::map(std::uint64_t offset, std::uint64_t bytes, bool writable) const {
    struct Mappable {
        ipc::mapping_handle_t handle;
        [[nodiscard]] ipc::mapping_handle_t get_mapping_handle() const { return handle; }
    };
    struct stat about {};
    // A file with holes would be filled by looking at it.
    const bool whole = fstat(fd(), &about) == 0 && 512 * about.st_blocks >= about.st_size;
    try {
        return ipc::mapped_region(Mappable{{fd(), false}}, writable ? ipc::read_write : ipc::read_only,
                                  static_cast<ipc::offset_t>(offset), bytes, nullptr, whole ? MAP_POPULATE : 0);
    } catch (const ipc::interprocess_exception& e) {
        fail(e.get_native_error(), "mapping " + std::to_string(bytes) + " bytes of shared memory");
    }
}

namespace {

[[noreturn]] void name_taken(const std::string& why) {
    throw Error(Failure::name_in_use, why + "; choose another session name.");
}

// What has the name already; empty if it is gone by now. Errors: name_in_use if it is not this user's.
std::optional<SegmentFile> open_predecessor(const std::string& name) {
    const std::string others = "The shared-memory segment " + name + " belongs to another user";
    try {
        auto old = SegmentFile::open(name);
        if (old && !old->owned_by_this_user()) name_taken(others);
        return old;
    } catch (const ForeignObject& foreign) {
        name_taken(foreign.what());
    } catch (const std::system_error& e) {
        if (e.code().value() != EACCES) throw;
        name_taken(others);
    }
}

}  // namespace

// The holder of an object's producer lock decides about the object, and only while its name still leads to it. Each
// step may lose against another process that does the same; then the round starts again with what that one left.
SegmentFile create_segment(const std::string& name, std::uint64_t bytes, bool group_access) {
    constexpr int rounds = 100;  // each lost round means that another process made progress
    for (int round = 0; round < rounds; ++round) {
        if (auto created = SegmentFile::create_exclusive(name)) {
            try {
                if (!lock_byte(created->fd(), producer_lock_byte) || !created->is_named(name)) continue;
                if (group_access) created->open_to_group(name);
                created->allocate(name, bytes);
            } catch (...) {
                unlink_segment(*created, name);
                throw;
            }
            return std::move(*created);
        }
        const auto old = open_predecessor(name);
        if (!old) continue;
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
    } catch (const ForeignObject&) {
        return false;
    } catch (const std::system_error& e) {
        if (e.code().value() != EACCES) throw;
        return true;  // another user's
    }
    return file && is_locked_by_other(file->fd(), producer_lock_byte);
}

void unlink_segment(const SegmentFile& file, const std::string& name) noexcept {
    if (file.is_named(name)) ::shm_unlink(name.c_str());
}

}  // namespace wade::shm
