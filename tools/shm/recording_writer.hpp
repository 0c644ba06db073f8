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
    // thinning: what is wanted; with a velocity_step_m_s positions and velocities are rounded.
    // Errors: ConfigurationError if the file is something else than a recording or cannot be created.
    RecordingWriter(const std::filesystem::path& file, int compression, const Thinning& thinning = {});
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    // Starts the recording of a stream; an older one stays until the first frame.
    // Errors: as append(); ConfigurationError for a box in a stream of agents, or of other units or axes than the world's.
    void begin(const shm::StreamInfo& info);

    // Whether the file still holds an older recording, as no frame has come.
    [[nodiscard]] bool keeps_older() const;

    // Once this returns the frame survives the death of this process; one that is not due is left out. The first and the
    // final one always are.
    // Errors: std::system_error, for example when the disk is full; the file then ends after the frame before.
    void append(const shm::Frame& frame);

    // The last record; the text is cut at 511 bytes. Errors: as append().
    void finish(EndReason reason, int code, std::string_view text);

    [[nodiscard]] std::uint64_t frames() const { return frames_; }            // in the file
    [[nodiscard]] std::uint64_t taken() const { return taken_; }              // those that were not due among them
    [[nodiscard]] std::uint64_t outside() const { return outside_; }          // particles left out of frames
    [[nodiscard]] std::uint64_t cut() const { return cut_; }                  // velocities beyond what can be rounded
    [[nodiscard]] std::uint64_t plain_bytes() const { return plain_bytes_; }  // of the arrays
    [[nodiscard]] std::uint64_t file_bytes() const { return file_bytes_; }

 private:
    bool is_due(const shm::Frame& frame);
    std::vector<std::span<const float>> in_the_box(std::span<const std::span<const float>> fields);
    void write_start();
    void write_record(RecordKind kind, std::uint32_t encoding);
    void write_all(std::span<const std::byte> bytes);

    std::filesystem::path path_;
    int fd_ = -1;
    bool is_new_ = false;  // the file was made here; it goes again if nothing is written
    shm::StreamKind kind_ = shm::stream_fluid;
    int compression_;
    Thinning thinning_;
    std::uint64_t interval_ticks_ = 0, due_tick_ = 0;
    std::uint64_t frames_ = 0, taken_ = 0, outside_ = 0, cut_ = 0, hash_ = 0, plain_bytes_ = 0, file_bytes_ = 0;
    std::vector<std::vector<float>> kept_;  // values of a frame that are in the box
    std::vector<std::byte> start_;          // until it is written
    std::vector<std::byte> record_;         // RecordHead and body
};

}  // namespace wade::recording
