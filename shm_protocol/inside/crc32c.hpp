#pragma once
// CRC-32C (Castagnoli): RFC 3720, appendix B.4; the check value of "123456789" is 0xE3069283.

#include <cstddef>
#include <cstdint>
#include <span>

namespace wade::shm {

std::uint32_t crc32c(std::span<const std::byte> bytes);

}  // namespace wade::shm
