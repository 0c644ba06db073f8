#include "configs/files/plain_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace wade {

namespace {

// Returns why a file is not read. Other kinds than a plain file may never begin or never end.
std::string kind_but_plain(const struct stat& about) {
    if (S_ISREG(about.st_mode)) return "";
    if (S_ISDIR(about.st_mode)) return "it is a folder";
    if (S_ISFIFO(about.st_mode)) return "it is a pipe (FIFO); allowed: a plain file";
    if (S_ISSOCK(about.st_mode)) return "it is a socket; allowed: a plain file";
    return "it is a device; allowed: a plain file";
}

}  // namespace

// Without O_NONBLOCK the opening of a FIFO waits for a writer.
PlainFile::PlainFile(const std::filesystem::path& file) : fd_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    struct stat about {};
    if (fd_ < 0) {
        problem_ = errno == ENXIO ? "it is no plain file" : std::strerror(errno);
    } else if (::fstat(fd_, &about) != 0) {
        problem_ = std::strerror(errno);
    } else {
        problem_ = kind_but_plain(about);
    }
}

PlainFile::~PlainFile() {
    if (fd_ >= 0) ::close(fd_);
}

std::uint64_t PlainFile::bytes() const {
    struct stat about {};
    return is_open() && ::fstat(fd_, &about) == 0 ? static_cast<std::uint64_t>(about.st_size) : 0;
}

std::size_t PlainFile::read(std::uint64_t from, void* into, std::size_t count) const {
    std::size_t done = 0;
    while (is_open() && done < count) {
        const ssize_t got =
            ::pread(fd_, static_cast<char*>(into) + done, count - done, static_cast<off_t>(from + done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

void clear_name(const std::filesystem::path& file) {
    struct stat about {};
    if (::lstat(file.c_str(), &about) != 0) return;
    if (S_ISLNK(about.st_mode) || S_ISFIFO(about.st_mode) || S_ISSOCK(about.st_mode)) ::unlink(file.c_str());
}

int open_anew(const std::filesystem::path& file) {
    clear_name(file);
    constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
    return ::open(file.c_str(), flags, 0666);
}

}  // namespace wade
