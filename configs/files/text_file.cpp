#include "configs/files/text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

#include "configs/errors/exit_code.hpp"

namespace wade {

namespace {

// Why a file is not read: its name may lead to something that never ends or never begins. Empty for a plain file.
std::string kind_but_plain(const struct stat& about) {
    if (S_ISREG(about.st_mode)) return "";
    if (S_ISDIR(about.st_mode)) return "it is a folder";
    if (S_ISFIFO(about.st_mode)) return "it is a pipe (FIFO); allowed: a plain file";
    if (S_ISSOCK(about.st_mode)) return "it is a socket; allowed: a plain file";
    return "it is a device; allowed: a plain file";
}

}  // namespace

std::string read_text_file(const std::filesystem::path& file, const std::string& context, std::size_t longest) {
    const auto fail = [&context](const std::string& reason) -> void {
        throw ConfigurationError(context + " cannot be read: " + reason + ".");
    };
    // Without O_NONBLOCK the opening of a FIFO waits for somebody who writes.
    const int fd = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) fail(errno == ENXIO ? "it is no plain file" : std::strerror(errno));
    const std::unique_ptr<const int, void (*)(const int*)> closing(&fd, [](const int* its) { ::close(*its); });
    struct stat about {};
    if (::fstat(fd, &about) != 0) fail(std::strerror(errno));
    if (const std::string kind = kind_but_plain(about); !kind.empty()) fail(kind);
    std::string text;
    std::array<char, 1 << 16> piece;
    while (true) {
        const ssize_t got = ::read(fd, piece.data(), piece.size());
        if (got < 0) fail("the read was cut short: " + std::string(std::strerror(errno)));
        if (got <= 0) break;
        text.append(piece.data(), static_cast<std::size_t>(got));
        if (text.size() > longest) fail("it is longer than " + std::to_string(longest >> 20) + " MiB");
    }
    // Spreadsheets and Windows begin a text in UTF-8 with a mark.
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    if (text.starts_with(mark)) text.erase(0, mark.size());
    return text;
}

}  // namespace wade
