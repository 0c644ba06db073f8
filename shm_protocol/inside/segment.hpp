#pragma once
// The shared-memory object of a session: creation, takeover of a stale one, opening, mapping, removal.

#include <boost/interprocess/mapped_region.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "shm_protocol/layout.hpp"

namespace wade::shm {

// Where the object of that name lies in the file system.
std::string path_of(const std::string& name);

// Returns what an object of that name is if it is no plain file, for example "a FIFO of user 1000"; else empty. Any
// process may have created it, and opening it could block.
std::string foreign_object(const std::string& name);

enum class Access { read_only, read_write };

// An open shared-memory object; closing it gives up the locks that were taken through it.
class SegmentFile {
 public:
    SegmentFile() = default;
    ~SegmentFile();
    SegmentFile(SegmentFile&& other) noexcept;
    SegmentFile& operator=(SegmentFile&& other) noexcept;

    // The existing plain file of that name; empty if there is none. Never blocks.
    // Errors: std::system_error, with EACCES for another user's, EMFILE when no file can be opened; ForeignObject.
    static std::optional<SegmentFile> open(const std::string& name, Access access = Access::read_write);

    // A new object of mode 0600; empty if the name is taken. Errors: std::system_error.
    static std::optional<SegmentFile> create_exclusive(const std::string& name);

    [[nodiscard]] int fd() const { return fd_; }
    [[nodiscard]] bool owned_by_this_user() const;
    [[nodiscard]] bool open_to_group_of_this_process() const;  // mode 0660 at least, and the group is one of its own
    [[nodiscard]] std::uint64_t size() const;

    // Whether `name` still leads to this object and not to a successor. Opens no file.
    [[nodiscard]] bool is_named(const std::string& name) const;

    // Lets the object's group read and write. Errors: std::system_error.
    void open_to_group(const std::string& name) const;

    // Sizes the object and allocates its memory, so that no later write can fail for want of memory.
    // Errors: std::system_error that names the size, ENOSPC when /dev/shm is full.
    void allocate(const std::string& name, std::uint64_t bytes) const;

    // Maps a part, page tables filled at once if its memory is there. Errors: std::system_error.
    [[nodiscard]] boost::interprocess::mapped_region map(std::uint64_t offset, std::uint64_t bytes,
                                                         bool writable) const;

 private:
    explicit SegmentFile(int fd) : fd_(fd) {}
    int fd_ = -1;
};

// The name leads to something that is no plain file; what() says to what.
class ForeignObject : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

// Creates the object of a new producer, holding its lock, sized, of mode 0660 with group_access and 0600 without. A stale
// object of the same name is removed first. Nothing is left of it if it fails.
// Errors: Failure::name_in_use; std::system_error.
SegmentFile create_segment(const std::string& name, std::uint64_t bytes, bool group_access = false);

// Whether a stream of this session has a producer that lives. Errors: std::invalid_argument for a bad name.
bool has_living_producer(const std::string& session, StreamKind kind);

// Removes the name if it still leads to `file`.
void unlink_segment(const SegmentFile& file, const std::string& name) noexcept;

}  // namespace wade::shm
