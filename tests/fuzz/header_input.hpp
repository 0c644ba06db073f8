#pragma once
// How the bytes of a fuzzer become a header page and the size of a file: a byte that says what is put right, then the
// page, cut after its last byte that is not zero.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "shm_protocol/inside/header.hpp"

namespace wade::fuzz {

// Without these repairs almost no input would get past the magic, the checksum and the size.
enum Repair : std::uint8_t { repair_identity = 1, repair_crc = 2, repair_size = 4, also_round_trip = 8 };

struct HeaderInput {
    shm::Header header{};
    std::uint64_t file_bytes = 0;
};

inline HeaderInput read_input(const std::uint8_t* data, std::size_t size) {
    HeaderInput input;
    if (size == 0) return input;
    shm::Header& h = input.header;
    std::memcpy(&h, data + 1, std::min(size - 1, sizeof h));
    std::memcpy(&input.file_bytes, h.reserved1 + sizeof h.reserved1 - 8, 8);
    if ((data[0] & repair_identity) != 0) {
        h.magic = shm::magic;
        h.version_major = shm::version_major;
        h.endian_tag = shm::endian_tag;
        h.header_bytes = shm::page_bytes;
        h.required_features = 0;
    }
    if ((data[0] & repair_size) != 0) input.file_bytes = h.total_bytes;
    if ((data[0] & repair_crc) != 0) h.crc32c = shm::header_crc(h);
    return input;
}

inline std::vector<std::uint8_t> write_input(std::uint8_t repairs, const shm::Header& h) {
    std::vector<std::uint8_t> bytes(1 + sizeof h);
    bytes[0] = repairs;
    std::memcpy(bytes.data() + 1, &h, sizeof h);
    while (bytes.size() > 1 && bytes.back() == 0) bytes.pop_back();
    return bytes;
}

}  // namespace wade::fuzz
