#pragma once
// Typed access to the pages of a mapped segment.

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "shm_protocol/inside/header.hpp"

namespace wade::shm {

// `Byte` is std::byte for a writable mapping and const std::byte for a read-only one.
template <typename Byte>
class Pages {
    template <typename T>
    using Like = std::conditional_t<std::is_const_v<Byte>, const T, T>;

 public:
    Pages() = default;
    Pages(Byte* base, const SegmentMap& map) : base_(base), map_(&map) {}

    [[nodiscard]] Like<Control>& control() const { return at<Control>(map_->control); }
    [[nodiscard]] Like<Doorbell>& doorbell() const { return at<Doorbell>(map_->doorbell); }
    [[nodiscard]] Like<ConsumerEntry>& consumer(std::uint32_t i) const {
        return at<ConsumerEntry>(map_->consumers + i * map_->consumer_stride);
    }
    [[nodiscard]] Like<SlotDescriptor>& descriptor(std::uint64_t frame) const {
        return at<SlotDescriptor>(map_->descriptors + slot_of(frame) * map_->descriptor_stride);
    }
    // The array number i (header.hpp: fields_of) of the slot of a frame.
    [[nodiscard]] Like<float>* field(std::uint64_t frame, std::size_t i) const {
        return &at<float>(map_->slots + slot_of(frame) * map_->slot_stride + map_->fields[i]);
    }

 private:
    [[nodiscard]] std::uint64_t slot_of(std::uint64_t frame) const { return (frame - 1) % map_->info.slots; }
    template <typename T>
    [[nodiscard]] Like<T>& at(std::uint64_t offset) const {
        return *reinterpret_cast<Like<T>*>(base_ + offset);  // aligned: read_header() demands it of every offset
    }

    Byte* base_ = nullptr;
    const SegmentMap* map_ = nullptr;
};

}  // namespace wade::shm
