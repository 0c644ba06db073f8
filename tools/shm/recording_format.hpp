#pragma once
// The bytes of a recording, versions 1 and 2; README.md is its prose.
//
//   FileHead, header page of the stream, then records: RecordHead and its body
//
// A file that was cut off anywhere holds whole records up to there. Each part has a CRC-32C of its own, so what was cut
// off can be told from what was damaged.

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "shm_protocol/layout.hpp"

namespace wade::recording {

inline constexpr std::uint64_t file_magic = 0x3143455245444157;  // the bytes "WADEREC1" in a little-endian file
inline constexpr std::uint32_t whole_version = 1;                // every frame of a stream, bit by bit
inline constexpr std::uint32_t thinned_version = 2;              // what FileHead::thinning says

enum RecordKind : std::uint32_t {
    record_frame = 0x4D415246,  // "FRAM": a SlotDescriptor, then the payload
    record_end = 0x20444E45     // "END ": an EndBody
};
enum PayloadEncoding : std::uint32_t {
    payload_plain = 0,          // the required fields one after another, `count` float32 each
    payload_shuffled_zstd = 1,  // of each field first all lowest bytes, then all second ones ..., compressed as a whole
    payload_quantised_zstd = 2  // the same with int16 for velocities and uint16 for positions, see Thinning
};
enum EndReason : std::uint32_t {
    end_of_stream = 0,   // the producer ended the stream, or the last frame was final
    end_of_recorder = 1  // the recorder left or failed before
};

// What a recording of version 2 left out, or rounded; all 0 in version 1. The box is that of the world, in metres.
struct Thinning {
    float interval_s;         // from one frame to the next; 0: every frame
    float low[3], high[3];    // particles with low <= (x, y, z) <= high are in the file; all 0: all are
    float velocity_step_m_s;  // a velocity is this times an int16; 0: positions and velocities are not rounded
    float position_error_m;   // largest distance, along an axis, of a position from where it was
};

inline bool has_box(const Thinning& t) {
    return t.low[0] < t.high[0];
}
inline bool is_quantised(const Thinning& t) {
    return t.velocity_step_m_s > 0;
}
inline bool is_thinned(const Thinning& t) {
    return t.interval_s > 0 || has_box(t) || is_quantised(t);
}

struct FileHead {
    std::uint64_t magic;
    std::uint32_t version;
    std::uint32_t endian_tag;  // as in the header page
    std::uint32_t crc32c;      // of this head and the header page, with this word taken as 0
    Thinning thinning;
    std::uint8_t reserved[8];
};

struct RecordHead {
    std::uint32_t kind;
    std::uint32_t encoding;  // of a frame's payload
    std::uint64_t body_bytes;
    std::uint32_t body_crc32c;
    std::uint32_t head_crc32c;  // of the 20 bytes before
};

struct EndBody {
    std::uint64_t frames;  // recorded
    std::uint64_t hash;    // of the last one
    std::uint32_t reason;  // EndReason
    std::int32_t code;     // exit code of the recorder
    char text[shm::reason_bytes];
};

static_assert(sizeof(FileHead) == 64 && offsetof(FileHead, crc32c) == 16 && offsetof(FileHead, thinning) == 20);
static_assert(sizeof(RecordHead) == 24 && offsetof(RecordHead, head_crc32c) == 20);
static_assert(sizeof(EndBody) == 536 && offsetof(EndBody, text) == 24);
static_assert(std::is_trivially_copyable_v<FileHead> && std::is_trivially_copyable_v<RecordHead> &&
              std::is_trivially_copyable_v<EndBody>);

// The bytes of a value.
template <typename T>
[[nodiscard]] std::span<const std::byte> bytes_of(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}

}  // namespace wade::recording
