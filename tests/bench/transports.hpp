#pragma once
// Transports: each brings a frame of particles from one process to another and reports that it was read.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace wade::bench {

// Seven arrays of n values each, as one block.
using Payload = std::vector<float>;

// What a consumer does with a frame: it reads the positions.
float read_positions(std::span<const float> px, std::span<const float> py, std::span<const float> pz);

// The producing end of a transport; the consuming end runs in a child process until the end.
class Transport {
 public:
    Transport() = default;
    Transport(const Transport&) = delete;
    Transport& operator=(const Transport&) = delete;
    virtual ~Transport() = default;
    // One frame: hands over the payload and returns when it was read and acknowledged.
    virtual void exchange(const Payload& payload) = 0;
};

// Starts both ends for frames of n particles. `name` is one of transport_names().
//   wade            copied into the slot, hashed on both sides, every value checked
//   wade unchecked  copied, no hash on either side and no check of the values
//   wade in place   the producer's arrays are the slot, so that nothing is copied; unchecked
//   memcpy          the limit: the same copy and the same reading in one process, no hand-over
//   unix socket     a stream of bytes through a socket pair, acknowledged with one byte
//   zeromq ipc      one message a frame, acknowledged with an empty one
std::unique_ptr<Transport> make_transport(const std::string& name, std::uint32_t n);
std::vector<std::string> transport_names();

// Runs `work` in a child process that ends after it; the destructor waits for it.
class Child {
 public:
    explicit Child(const std::function<void()>& work);
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    [[nodiscard]] int pid() const { return pid_; }

 private:
    int pid_;
};

}  // namespace wade::bench
