#pragma once
// HTTP and WebSocket on 127.0.0.1: files for GET, questions and answers over /stream. Knows nothing of water or people.
//
// Other users of the machine reach the port, too. So each request needs a key of 128 random bits, in a cookie that the page gets from
// /?key=KEY.
//
// A client asks and gets one answer for each question. Of each kind and slot only the last question counts, so that nothing piles
// up for a slow client, and a question without an answer yet waits.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace wade::view {

// The binary messages; README.md has the same table for authors of another page.
//
//   MessageHead, then `fields` arrays of `count` float32 each, one after another
enum MessageKind : std::uint32_t {
    kind_water = 1,    // x y z vx vy vz, volume
    kind_people = 2,   // see people_fields of run_folder.hpp
    kind_depths = 3,   // depth of the water, row by row
    kind_paths = 4,    // id, time, x, z
    kind_walkers = 5,  // id, x, z, vx, vz, height, state: of a stream of agents
    kind_ground = 6    // height of the ground at points, row by row; a cell is their distance
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
    float lasts_s = 0;                     // until the next frame of the source; 0: there is none, or it is unknown
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

struct WebFile {
    std::string type, body;  // "text/html"
};

// One line of JSON of a client, understood.
struct Question {
    std::string kind;        // a client has one of each at a time
    double time = 0;         // s
    double after = -1;       // a frame
    std::uint32_t id = 0;    // of a person
    std::uint32_t slot = 0;  // 0 to 15: a client has one question of each kind and slot at a time
    std::string command;
};

struct Answer {
    bool is_binary = false;
    Message bytes;
};

struct Pages {
    std::function<std::optional<WebFile>(const std::string& path)> file;         // none: 404
    std::function<std::optional<Question>(const std::string& text)> understand;  // none: the client is told so
    std::function<std::optional<Answer>(const Question&)> answer;                // none: not yet
    std::function<std::string()> status;                                         // text for all, twice a second
    std::function<bool()> work;  // 60 times a second; false ends the server
};

// Serves until work() says false. `opened` gets the address of the page with its key, once the port listens; port 0: any that is free.
// Errors: ConfigurationError if the port cannot be had.
void serve(std::uint16_t port, const Pages& site, const std::function<void(const std::string& address)>& opened);

}  // namespace wade::view
