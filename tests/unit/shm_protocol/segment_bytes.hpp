#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "shm_protocol/inside/frame_check.hpp"
#include "shm_protocol/layout.hpp"

namespace wade::shm::test {

// The bytes of a segment, as an outsider sees them.
class Bytes {
 public:
    explicit Bytes(const std::string& path) : fd_(open(path.c_str(), O_RDWR | O_CLOEXEC)) {
        size_ = static_cast<std::size_t>(lseek(fd_, 0, SEEK_END));
        data_ = static_cast<unsigned char*>(mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, 0));
    }
    ~Bytes() {
        munmap(data_, size_);
        close(fd_);
    }
    Bytes(const Bytes&) = delete;
    Bytes& operator=(const Bytes&) = delete;
    [[nodiscard]] bool mapped() const { return data_ != MAP_FAILED; }
    unsigned char& operator[](std::size_t at) { return data_[at]; }
    template <typename T>
    T& as(std::size_t at) {
        return *reinterpret_cast<T*>(data_ + at);
    }
    SlotDescriptor& descriptor(std::uint64_t frame) {
        const auto& header = as<Header>(0);
        return as<SlotDescriptor>(header.descriptors_offset +
                                  (frame - 1) % header.slot_count * header.descriptor_stride);
    }
    // Recomputes the checksum of a changed descriptor, as a false producer would.
    void reseal(std::uint64_t frame) { descriptor(frame).crc32c = descriptor_crc(descriptor(frame)); }

    ConsumerEntry& consumer(std::uint32_t i) { return as<ConsumerEntry>(consumers_offset + i * page_bytes); }
    Control& control() { return as<Control>(control_offset); }

 private:
    int fd_;
    std::size_t size_;
    unsigned char* data_;
};

}  // namespace wade::shm::test
