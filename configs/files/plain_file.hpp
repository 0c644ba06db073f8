#pragma once
// Files that another user may have made or named: opened without waiting, and only if they are plain files.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace wade {

class PlainFile {
 public:
    explicit PlainFile(const std::filesystem::path& file);
    ~PlainFile();
    PlainFile(const PlainFile&) = delete;
    PlainFile& operator=(const PlainFile&) = delete;

    // Empty if the file is open, else the reason why it is not.
    [[nodiscard]] const std::string& problem() const { return problem_; }
    [[nodiscard]] bool is_open() const { return problem_.empty(); }
    [[nodiscard]] int descriptor() const { return fd_; }  // -1 if there is no such file
    // Length in bytes, 0 if the file is not open.
    [[nodiscard]] std::uint64_t bytes() const;
    // Reads up to `count` bytes from an offset on and returns how many there were.
    std::size_t read(std::uint64_t from, void* into, std::size_t count) const;

 private:
    int fd_;
    std::string problem_;
};

// Opens a file to write it anew; returns its descriptor, or -1 with errno. A symbolic link, FIFO or socket of that name is
// removed first, so that nothing elsewhere is overwritten and the opening never waits.
[[nodiscard]] int open_anew(const std::filesystem::path& file);

// Removes a symbolic link, FIFO or socket of a name under which a library then writes a file.
void clear_name(const std::filesystem::path& file);

}  // namespace wade
