#include "tools/shm/recording_writer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <system_error>

#include "configs/errors/exit_code.hpp"
#include "shm_protocol/inside/bytes/crc32c.hpp"
#include "shm_protocol/inside/header.hpp"
#include "tools/shm/frame_payload.hpp"

namespace wade::recording {
namespace {

template <typename T>
std::span<const std::byte> bytes_of(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
    throw ConfigurationError("The recording " + file.string() + " cannot be written: " + why + ".");
}

// A misspelt name must not cost anybody a file.
void demand_replaceable(int fd, const std::filesystem::path& file) {
    std::uint64_t begin = 0;
    const ssize_t got = ::pread(fd, &begin, sizeof begin, 0);  // below 0: a pipe
    if (got > 0 && (got != static_cast<ssize_t>(sizeof begin) || begin != file_magic))
        refuse(file, "there is such a file already, and it is no recording; remove it or choose another name");
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& file, int compression)
    : path_(file), compression_(compression) {
    fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    is_new_ = fd_ >= 0;
    if (!is_new_) fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (fd_ < 0) refuse(file, std::strerror(errno));
    try {
        if (::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
            refuse(file, "it is being written or played by another program");
        demand_replaceable(fd_, file);
    } catch (...) {
        ::close(fd_);
        throw;
    }
}

RecordingWriter::~RecordingWriter() {
    if (is_new_ && file_bytes_ == 0) ::unlink(path_.c_str());
    ::close(fd_);
}

void RecordingWriter::begin(const shm::StreamInfo& info) {
    kind_ = info.kind;
    struct {
        FileHead head{};
        shm::Header page;
    } start;
    static_assert(sizeof start == sizeof(FileHead) + sizeof(shm::Header));
    start.head.magic = file_magic;
    start.head.version = file_version;
    start.head.endian_tag = shm::endian_tag;
    start.page = shm::make_header(info, info.session_id);
    start.head.crc32c = shm::crc32c(bytes_of(start));
    const auto bytes = bytes_of(start);
    start_.assign(bytes.begin(), bytes.end());
    if (!keeps_older()) write_start();
}

bool RecordingWriter::keeps_older() const {
    return !start_.empty() && !is_new_;
}

void RecordingWriter::write_start() {
    if (::ftruncate(fd_, 0) != 0 && errno != EINVAL)  // EINVAL: a device or a pipe
        throw std::system_error(errno, std::generic_category(), "emptying the recording " + path_.string());
    write_all(start_);
    start_.clear();
}

void RecordingWriter::append(const shm::Frame& frame) {
    if (keeps_older()) write_start();
    shm::SlotDescriptor descriptor{};
    descriptor.sequence = 2 * frame.frame;
    descriptor.frame = frame.frame;
    descriptor.tick = frame.tick;
    descriptor.count = frame.count;
    descriptor.flags = frame.final ? shm::frame_final : 0U;
    descriptor.hash = frame.hash;
    descriptor.previous_hash = hash_;
    descriptor.diagnostics = frame.diagnostics;
    const auto fields = fields_of(frame, kind_);
    const auto bytes = bytes_of(descriptor);
    record_.assign(sizeof(RecordHead), std::byte{});
    record_.insert(record_.end(), bytes.begin(), bytes.end());
    write_record(record_frame, append_payload(fields, compression_, record_));
    ++frames_;
    hash_ = frame.hash;
    plain_bytes_ += fields.size() * fields[0].size_bytes();
}

void RecordingWriter::finish(EndReason reason, int code, std::string_view text) {
    if (keeps_older()) return;
    EndBody end{};
    end.frames = frames_;
    end.hash = hash_;
    end.reason = reason;
    end.code = code;
    shm::store_text(end.text, sizeof end.text, text);
    const auto bytes = bytes_of(end);
    record_.assign(sizeof(RecordHead), std::byte{});
    record_.insert(record_.end(), bytes.begin(), bytes.end());
    write_record(record_end, 0);
}

void RecordingWriter::write_record(RecordKind kind, std::uint32_t encoding) {
    const auto body = std::span<const std::byte>(record_).subspan(sizeof(RecordHead));
    RecordHead head{};
    head.kind = kind;
    head.encoding = encoding;
    head.body_bytes = body.size();
    head.body_crc32c = shm::crc32c(body);
    head.head_crc32c = shm::crc32c(bytes_of(head).first(offsetof(RecordHead, head_crc32c)));
    std::memcpy(record_.data(), &head, sizeof head);
    write_all(record_);
}

void RecordingWriter::write_all(std::span<const std::byte> bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = ::write(fd_, bytes.data() + done, bytes.size() - done);
        if (n >= 0) {
            done += static_cast<std::size_t>(n);
        } else if (errno != EINTR) {
            const int error = errno;
            // What was written of this record goes again, as far as the place allows.
            if (::ftruncate(fd_, static_cast<off_t>(file_bytes_)) == 0)
                ::lseek(fd_, static_cast<off_t>(file_bytes_), SEEK_SET);
            throw std::system_error(error, std::generic_category(), "writing the recording " + path_.string());
        }
    }
    file_bytes_ += bytes.size();
}

}  // namespace wade::recording
