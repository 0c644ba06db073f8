#pragma once
// Writes a recording, record by record, so that the file is whole at any moment up to the last frame appended.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "shm_protocol/stream.hpp"
#include "tools/shm/recording_format.hpp"

namespace wade::recording {

class RecordingWriter {
 public:
    // Opens the file, which may be an older recording. compression: 0 stores, 1 to 19 compress, faster to smaller.
    // Errors: ConfigurationError if the file is something else than a recording or cannot be created.
    RecordingWriter(const std::filesystem::path& file, int compression);
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    // Starts the recording of a stream; an older one stays until the first frame. Errors: as append().
    void begin(const shm::StreamInfo& info);

    // Whether the file still holds an older recording, as no frame has come.
    [[nodiscard]] bool keeps_older() const;

    // Once this returns the frame survives the death of this process.
    // Errors: std::system_error, for example when the disk is full; the file then ends after the frame before.
    void append(const shm::Frame& frame);

    // The last record; the text is cut at 511 bytes. Errors: as append().
    void finish(EndReason reason, int code, std::string_view text);

    [[nodiscard]] std::uint64_t frames() const { return frames_; }
    [[nodiscard]] std::uint64_t plain_bytes() const { return plain_bytes_; }  // of the arrays
    [[nodiscard]] std::uint64_t file_bytes() const { return file_bytes_; }

 private:
    void write_start();
    void write_record(RecordKind kind, std::uint32_t encoding);
    void write_all(std::span<const std::byte> bytes);

    std::filesystem::path path_;
    int fd_ = -1;
    bool is_new_ = false;  // the file was made here; it goes again if nothing is written
    shm::StreamKind kind_ = shm::stream_fluid;
    int compression_;
    std::uint64_t frames_ = 0, hash_ = 0, plain_bytes_ = 0, file_bytes_ = 0;
    std::vector<std::byte> start_;   // until it is written
    std::vector<std::byte> record_;  // RecordHead and body
};

}  // namespace wade::recording
