#pragma once
// Reads a recording: all of it is checked before the first frame is used.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "configs/files/plain_file.hpp"
#include "shm_protocol/inside/header.hpp"
#include "shm_protocol/stream.hpp"
#include "tools/shm/recording_format.hpp"

namespace wade::recording {

struct FrameRecord {
    std::uint64_t payload_at = 0;  // bytes from the start of the file
    std::uint64_t payload_bytes = 0;
    PayloadEncoding encoding = payload_plain;
    shm::SlotDescriptor descriptor{};
};

class Recording {
 public:
    // Reads the file from end to end. One that ends in the middle of a record holds what came before it.
    // Errors: ConfigurationError if it cannot be read, is no recording, of another version, or damaged; it names the
    // frame.
    explicit Recording(const std::filesystem::path& file);

    [[nodiscard]] const shm::StreamInfo& info() const { return map_.info; }
    [[nodiscard]] const Thinning& thinning() const { return thinning_; }  // all 0: every frame, bit by bit
    [[nodiscard]] const std::vector<FrameRecord>& frames() const { return frames_; }
    [[nodiscard]] const std::optional<EndBody>& end() const { return end_; }  // none: the file was cut off
    [[nodiscard]] std::uint64_t file_bytes() const { return file_bytes_; }
    [[nodiscard]] std::uint64_t whole_bytes() const { return whole_bytes_; }  // up to the end of the last whole record
    [[nodiscard]] std::uint64_t plain_bytes() const;                          // of all arrays

    // Fills the arrays of a slot with the arrays of a frame.
    // Errors: ConfigurationError if their hash is not the one that the recorder saw.
    void read(const FrameRecord& record, const shm::FrameFields& slot);

 private:
    void read_start();
    bool read_record();  // false at the end
    void keep_frame(const RecordHead& head);
    [[nodiscard]] bool fetch(std::uint64_t from, void* into, std::uint64_t bytes) const;
    [[nodiscard]] std::uint32_t crc_of_body(const RecordHead& head) const;
    [[noreturn]] void refuse(const std::string& why) const;
    [[noreturn]] void refuse_next(const std::string& why) const;  // names the frame after the last one kept

    std::filesystem::path path_;
    PlainFile file_;  // locked, so that no recorder replaces the file meanwhile
    std::uint64_t file_bytes_ = 0, whole_bytes_ = 0;
    shm::SegmentMap map_;
    Thinning thinning_{};
    std::vector<FrameRecord> frames_;
    std::optional<EndBody> end_;
};

}  // namespace wade::recording
