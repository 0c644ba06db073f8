#include "crowd_client/results/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <iterator>
#include <utility>

#include "configs/files/plain_file.hpp"

namespace wade::crowd {
namespace {

std::string sentence(const std::filesystem::path& file, const std::string& reason, bool disk_full) {
    if (disk_full)
        return "no space left on the device of '" + file.string() + "', the file could not be written further";
    return "cannot write '" + file.string() + "': " + reason;
}

// Returns 0, or the error number of a failed write.
int write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

}  // namespace

bool means_full(int error_number) {
    return error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
}

OutputError::OutputError(const std::filesystem::path& file, int error_number)
    : OutputError(file, std::strerror(error_number), means_full(error_number)) {}

OutputError::OutputError(const std::filesystem::path& file, const std::string& reason, bool disk_full)
    : RunError(ExitCode::unexpected, sentence(file, reason, disk_full)), disk_full_(disk_full) {}

void write_whole_file(const std::filesystem::path& file, std::string_view content) {
    std::filesystem::path part = file;
    part += ".part";
    const int descriptor = open_anew(part);
    if (descriptor < 0) throw OutputError(file, errno);
    int error = write_all(descriptor, content);
    // Some devices cannot be flushed; that is no loss of content.
    if (error == 0 && ::fsync(descriptor) != 0 && errno != EINVAL && errno != EROFS) error = errno;
    if (::close(descriptor) != 0 && error == 0) error = errno;
    if (error == 0 && ::rename(part.c_str(), file.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(part.c_str());
        throw OutputError(file, error);
    }
}

void make_run_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error && !std::filesystem::is_directory(folder)) {
        throw ConfigurationError("--out: cannot create the run folder '" + folder.string() + "': " + error.message());
    }
    const std::filesystem::path probe = folder / ".writable";
    const int descriptor = open_anew(probe);
    if (descriptor < 0) {
        throw ConfigurationError("--out: cannot write to the run folder '" + folder.string() +
                                 "': " + std::strerror(errno));
    }
    ::close(descriptor);
    ::unlink(probe.c_str());
}

ReservedSpace::ReservedSpace(std::filesystem::path file, std::size_t bytes) : file_(std::move(file)) {
    const int descriptor = open_anew(file_);
    if (descriptor < 0) throw OutputError(file_, errno);
    const int error = ::posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
    ::close(descriptor);
    // A file system that cannot reserve is no reason not to run.
    if (error != 0 && error != EOPNOTSUPP && error != EINVAL) {
        ::unlink(file_.c_str());
        throw OutputError(file_, error);
    }
}

ReservedSpace::~ReservedSpace() {
    ::unlink(file_.c_str());
}

AppendFile::AppendFile(const std::filesystem::path& file) : file_(file), descriptor_(open_anew(file)) {
    if (descriptor_ < 0) throw OutputError(file_, errno);
}

AppendFile::~AppendFile() {
    ::close(descriptor_);
}

void AppendFile::append(std::string_view bytes) {
    const int error = write_all(descriptor_, bytes);
    if (error != 0) {
        if (::ftruncate(descriptor_, size_) == 0) ::lseek(descriptor_, size_, SEEK_SET);
        throw OutputError(file_, error);
    }
    size_ += static_cast<long long>(bytes.size());
}

std::string csv_number(double v) {
    char buffer[32];
    const auto end = std::to_chars(std::begin(buffer), std::end(buffer), v).ptr;
    return {buffer, end};
}

}  // namespace wade::crowd
