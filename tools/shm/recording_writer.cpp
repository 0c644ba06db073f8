#include "tools/shm/recording_writer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <system_error>

#include "configs/errors/exit_code.hpp"
#include "shm_protocol/inside/bytes/crc32c.hpp"
#include "shm_protocol/inside/bytes/hash.hpp"
#include "shm_protocol/inside/header.hpp"
#include "tools/shm/frame_payload.hpp"

namespace wade::recording {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
    throw ConfigurationError("The recording " + file.string() + " cannot be written: " + why + ".");
}

// Throws ConfigurationError if the file has content and is no recording: a misspelt name must not cost another file.
void demand_replaceable(int fd, const std::filesystem::path& file) {
    std::uint64_t begin = 0;
    const ssize_t got = ::pread(fd, &begin, sizeof begin, 0);  // below 0: a pipe
    if (got > 0 && (got != static_cast<ssize_t>(sizeof begin) || begin != file_magic))
        refuse(file, "there is such a file already, and it is no recording; remove it or choose another name");
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& file, int compression, const Thinning& thinning)
    : path_(file), compression_(compression), thinning_(thinning) {
    if (is_quantised(thinning_)) thinning_.position_error_m = position_error(thinning_);
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
    if (has_box(thinning_) && (kind_ != shm::stream_fluid || !info.in_world_coordinates()))
        refuse(path_, "a region and rounded places are for water in metres, with axes as they are in the world");
    shm::StreamInfo stream = info;
    if (thinning_.interval_s > 0) {
        const auto rate = static_cast<double>(info.ticks_per_second);
        const double ticks = std::round(static_cast<double>(thinning_.interval_s) * rate);
        interval_ticks_ = static_cast<std::uint64_t>(std::max(1.0, ticks));
        thinning_.interval_s = static_cast<float>(static_cast<double>(interval_ticks_) / rate);
        stream.ticks_per_frame = std::max(info.ticks_per_frame, interval_ticks_);
    }
    if (is_thinned(thinning_)) stream.producer_name = info.producer_name.substr(0, 50) + ", thinned";
    struct {
        FileHead head{};
        shm::Header page;
    } start;
    static_assert(sizeof start == sizeof(FileHead) + sizeof(shm::Header));
    start.head.magic = file_magic;
    start.head.version = is_thinned(thinning_) ? thinned_version : whole_version;
    start.head.thinning = thinning_;
    start.head.endian_tag = shm::endian_tag;
    start.page = shm::make_header(stream, info.session_id);
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

// The frames at or after each multiple of the interval, the first one and the final one.
bool RecordingWriter::is_due(const shm::Frame& frame) {
    ++taken_;
    if (interval_ticks_ == 0) return true;
    const bool due = frames_ == 0 || frame.final || frame.tick >= due_tick_;
    if (due) due_tick_ = (frame.tick / interval_ticks_ + 1) * interval_ticks_;
    return due;
}

std::vector<std::span<const float>> RecordingWriter::in_the_box(std::span<const std::span<const float>> fields) {
    const std::size_t count = fields[0].size(), places = 4;
    kept_.resize(fields.size());
    for (auto& field : kept_) field.clear();
    for (std::size_t k = 0; k < count; ++k) {
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float at = fields[places + axis][k];
            inside = inside && thinning_.low[axis] <= at && at <= thinning_.high[axis];
        }
        for (std::size_t i = 0; inside && i < fields.size(); ++i) kept_[i].push_back(fields[i][k]);
    }
    outside_ += count - kept_[0].size();
    return {kept_.begin(), kept_.end()};
}

void RecordingWriter::append(const shm::Frame& frame) {
    if (!is_due(frame)) return;
    if (keeps_older()) write_start();
    auto fields = fields_of(frame, kind_);
    if (has_box(thinning_)) fields = in_the_box(fields);
    record_.assign(sizeof(RecordHead) + sizeof(shm::SlotDescriptor), std::byte{});
    PayloadEncoding encoding = payload_quantised_zstd;
    if (is_quantised(thinning_)) {  // changes the values, and so the hash
        const std::vector<std::span<float>> values(kept_.begin(), kept_.end());
        cut_ += append_quantised(values, thinning_, std::max(1, compression_), record_);
    } else {
        encoding = append_payload(fields, compression_, record_);
    }
    shm::SlotDescriptor descriptor{};
    // A thinned recording is a stream of its own, with frames that follow one another.
    const bool thinned = is_thinned(thinning_);
    descriptor.frame = thinned ? frames_ + 1 : frame.frame;
    descriptor.sequence = 2 * descriptor.frame;
    descriptor.tick = frame.tick;
    descriptor.count = static_cast<std::uint32_t>(fields[0].size());
    descriptor.flags = frame.final ? shm::frame_final : 0U;
    descriptor.hash = thinned ? shm::chain_hash(hash_, descriptor.frame, fields) : frame.hash;
    descriptor.previous_hash = hash_;
    descriptor.diagnostics = frame.diagnostics;
    std::memcpy(record_.data() + sizeof(RecordHead), &descriptor, sizeof descriptor);
    write_record(record_frame, encoding);
    ++frames_;
    hash_ = descriptor.hash;
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
            // Removes the part of this record that was written, if the file can be truncated.
            if (::ftruncate(fd_, static_cast<off_t>(file_bytes_)) == 0)
                ::lseek(fd_, static_cast<off_t>(file_bytes_), SEEK_SET);
            throw std::system_error(error, std::generic_category(), "writing the recording " + path_.string());
        }
    }
    file_bytes_ += bytes.size();
}

}  // namespace wade::recording
