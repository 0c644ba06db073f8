#pragma once
// The binary messages of the viewer's server; docs/viewer.md has the same table for those who write another page.
//
//   MessageHead, then `fields` arrays of `count` float32 each, one after another

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>

namespace wade::view {

enum MessageKind : std::uint32_t {
    kind_water = 1,   // x y z vx vy vz, volume
    kind_people = 2,  // see people_fields of run_folder.hpp
    kind_depths = 3,  // depth of the water, row by row
    kind_paths = 4,   // id, time, x, z
    kind_walkers = 5  // id, x, z, vx, vz, height, state: of a stream of agents
};

struct MessageHead {
    std::uint32_t magic = 0x31465657;  // the bytes "WVF1"
    std::uint32_t kind = 0;
    std::uint32_t count = 0;   // values of an array
    std::uint32_t fields = 0;  // arrays
    double time_s = 0;         // of the simulation
    double frame = 0;          // number in its source
    std::uint32_t stride = 1;  // of water: every stride-th particle is there
    std::uint32_t columns = 0;
    float x0_m = 0, z0_m = 0, cell_m = 0;  // of a grid: corner, size of a cell
    std::uint32_t reserved = 0;
};
static_assert(sizeof(MessageHead) == 56 && offsetof(MessageHead, time_s) == 16);

// Bytes to be sent; shared by the clients that they go to.
using Message = std::shared_ptr<std::string>;

[[nodiscard]] inline Message new_message(const MessageHead& head) {
    auto bytes = std::make_shared<std::string>(sizeof head + sizeof(float) * head.count * head.fields, '\0');
    std::memcpy(bytes->data(), &head, sizeof head);
    return bytes;
}

// One of its arrays. The head is a multiple of 8 bytes long and strings of this length are aligned for doubles.
[[nodiscard]] inline std::span<float> array_of(const Message& message, const MessageHead& head, std::size_t field) {
    auto* first = reinterpret_cast<float*>(message->data() + sizeof head);
    return {first + field * head.count, head.count};
}

}  // namespace wade::view
