#pragma once
// The header page: how a producer fills it, and what a reader demands of it before it believes anything.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shm_protocol/inside/bytes/text.hpp"
#include "shm_protocol/layout.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::shm {

// Returns the fields that every stream of this kind has, in hash order; further ones may follow.
std::span<const char* const> required_fields(StreamKind kind);

// The fields that a stream of agents may have beside, all four or none; a stream of water has none.
std::span<const char* const> impulse_fields();

// The names of all fields of a stream that this program knows, the required ones first.
std::vector<const char*> fields_of(const StreamInfo& info);

// Where things lie, in private memory: offsets are never read from the segment again.
struct SegmentMap {
    StreamInfo info;
    std::uint64_t total_bytes = 0;
    std::uint64_t control = 0, doorbell = 0, consumers = 0, descriptors = 0, slots = 0;  // from the start of the file
    std::uint64_t consumer_stride = 0, descriptor_stride = 0, slot_stride = 0;
    std::uint32_t consumer_count = 0;
    bool descriptors_have_checks = false;  // the producer's version gives each descriptor a CRC-32C
    bool has_further_hash = false;         // and the hash of its optional fields
    std::vector<std::uint64_t> fields;     // from the start of a slot, in the order of fields_of(info)
};

// The header of a new stream, complete but for the magic, which the producer stores last.
// Errors: std::invalid_argument that names the member, its value and the allowed range.
Header make_header(const StreamInfo& info, std::uint64_t session_id);

// Checks a private copy of a header, magic included, against the size of the file, and translates it.
// Errors: Failure::protocol_violation that names what is wrong.
SegmentMap read_header(const Header& copy, std::uint64_t file_bytes);

// CRC-32C of a header page with the word crc32c taken as 0.
std::uint32_t header_crc(Header copy);

}  // namespace wade::shm
