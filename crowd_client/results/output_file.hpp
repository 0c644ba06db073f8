#pragma once
// Files of a run: written whole or not at all, with errors that name the file.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "configs/errors/exit_code.hpp"

namespace wade::crowd {

// A result could not be written, for example because the disk is full; exit code 1.
class OutputError : public RunError {
 public:
    OutputError(const std::filesystem::path& file, int error_number);
    OutputError(const std::filesystem::path& file, const std::string& reason, bool disk_full);
    [[nodiscard]] bool disk_full() const { return disk_full_; }

 private:
    bool disk_full_;
};

// Whether an error number means that there is no space for a file, or that it must not grow further.
[[nodiscard]] bool means_full(int error_number);

// Replaces `file` by `content` in one step: a temporary file beside it is written, flushed to the disk and renamed.
// Throws OutputError; the old content then stays.
void write_whole_file(const std::filesystem::path& file, std::string_view content);

// Creates the folder with its parents and makes sure that files can be written there.
// Throws ConfigurationError (exit code 2) that names the folder.
void make_run_folder(const std::filesystem::path& folder);

// Disk space kept free for files that must still be written when the disk is full. The destructor gives it back.
class ReservedSpace {
 public:
    ReservedSpace(std::filesystem::path file, std::size_t bytes);  // throws OutputError if there is not so much
    ~ReservedSpace();
    ReservedSpace(const ReservedSpace&) = delete;
    ReservedSpace& operator=(const ReservedSpace&) = delete;

 private:
    std::filesystem::path file_;
};

// A file that grows record by record; what was appended before an error stays whole.
class AppendFile {
 public:
    explicit AppendFile(const std::filesystem::path& file);  // empties it; throws OutputError
    ~AppendFile();
    AppendFile(const AppendFile&) = delete;
    AppendFile& operator=(const AppendFile&) = delete;

    // Appends all of it, or throws OutputError and removes what it had written of it.
    void append(std::string_view bytes);

 private:
    std::filesystem::path file_;
    int descriptor_;
    long long size_ = 0;
};

// Returns a number for a table: as many digits as it takes to read back the same bits, whatever the locale.
[[nodiscard]] std::string csv_number(double v);

}  // namespace wade::crowd
