#pragma once
// A file to read, perhaps named by another user: opened without waiting, and only if it is a plain file.

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
    // Length in bytes, 0 if the file is not open.
    [[nodiscard]] std::uint64_t bytes() const;
    // Reads up to `count` bytes from an offset on and returns how many there were.
    std::size_t read(std::uint64_t from, void* into, std::size_t count) const;

 private:
    int fd_;
    std::string problem_;
};

}  // namespace wade
