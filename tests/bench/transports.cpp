#include "tests/bench/transports.hpp"

#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>

#include "shm_protocol/publisher.hpp"
#include "shm_protocol/subscriber.hpp"

#ifdef WADE_HAS_ZEROMQ
#include <zmq.h>
#endif

namespace wade::bench {
namespace {

constexpr std::size_t arrays = 7;
volatile float sink = 0;  // keeps the reading from being left out

std::span<const float> array_of(const Payload& payload, std::size_t i) {
    const std::size_t n = payload.size() / arrays;
    return std::span(payload).subspan(i * n, n);
}

void read_block(const Payload& block) {
    sink = read_positions(array_of(block, 4), array_of(block, 5), array_of(block, 6));
}

std::string unique_name(const char* kind) {
    static int count = 0;
    return std::string("wade-bench-") + kind + "-" + std::to_string(getpid()) + "-" + std::to_string(++count);
}

class Memcpy final : public Transport {
 public:
    explicit Memcpy(std::uint32_t n) : slot_(arrays * std::size_t{n}) {}
    void exchange(const Payload& payload) override {
        std::memcpy(slot_.data(), payload.data(), payload.size() * sizeof(float));
        read_block(slot_);
    }

 private:
    Payload slot_;
};

enum class Hand { copy, in_place };

class SharedMemory final : public Transport {
 public:
    SharedMemory(const std::string& session, std::uint32_t n, Hand hand, bool hash)
        : hand_(hand), publisher_(session, info_for(n, hash)), child_([session, hash] { consume(session, hash); }) {
        publisher_.wait_for_consumers(1);
    }
    ~SharedMemory() override { publisher_.close(); }

    void exchange(const Payload& payload) override {
        // At depth 1 the beginning of the next frame is the acknowledgement of the last.
        const auto slot = publisher_.begin_frame();
        if (!slot) throw std::runtime_error("the consumer has left");
        const std::size_t n = payload.size() / arrays;
        if (hand_ == Hand::copy) {
            std::size_t i = 0;
            for (const auto& to : {slot->mass, slot->vx, slot->vy, slot->vz, slot->px, slot->py, slot->pz})
                std::ranges::copy(array_of(payload, i++), to.begin());
        } else if (slot->frame <= publisher_.info().slots) {
            std::ranges::fill(slot->mass, 1.0F);  // once for each slot, a mass is above 0
        }
        publisher_.end_frame(static_cast<std::uint32_t>(n));
    }

 private:
    static shm::StreamInfo info_for(std::uint32_t n, bool hash) {
        shm::StreamInfo info;
        info.producer_name = "bench";
        info.capacity = std::max(n, 1U);
        info.depth = 1;
        info.hash_frames = hash;
        return info;
    }
    static void consume(const std::string& session, bool check) {
        shm::JoinOptions join;
        join.check_values = check;
        shm::Subscriber subscriber(session, "bench", join);
        while (const auto frame = subscriber.acquire()) {
            sink = read_positions(frame->px, frame->py, frame->pz);
            subscriber.release();
        }
    }

    Hand hand_;
    shm::Publisher publisher_;
    Child child_;
};

void send_all(int fd, const void* data, std::size_t bytes) {
    const auto* at = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t sent = ::send(fd, at, bytes, MSG_NOSIGNAL);
        if (sent <= 0) throw std::runtime_error("the socket's other end is gone");
        at += sent;
        bytes -= static_cast<std::size_t>(sent);
    }
}

bool receive_all(int fd, void* data, std::size_t bytes) {
    auto* at = static_cast<char*>(data);
    while (bytes > 0) {
        const ssize_t got = ::recv(fd, at, bytes, 0);
        if (got <= 0) return false;
        at += got;
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

class UnixSocket final : public Transport {
 public:
    explicit UnixSocket(std::uint32_t n)
        : ends_(make_pair()), child_([this, n] {
              ::close(ends_.first);
              Payload block(arrays * std::size_t{n});
              char go = 0;
              while (receive_all(ends_.second, &go, 1) &&
                     receive_all(ends_.second, block.data(), block.size() * sizeof(float))) {
                  read_block(block);
                  send_all(ends_.second, &go, 1);
              }
          }) {
        ::close(ends_.second);
    }
    ~UnixSocket() override { ::close(ends_.first); }

    void exchange(const Payload& payload) override {
        char go = 1;
        send_all(ends_.first, &go, 1);
        send_all(ends_.first, payload.data(), payload.size() * sizeof(float));
        if (!receive_all(ends_.first, &go, 1)) throw std::runtime_error("the consumer is gone");
    }

 private:
    static std::pair<int, int> make_pair() {
        int fds[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM, 0, fds) != 0) throw std::runtime_error("no socket pair");
        return {fds[0], fds[1]};
    }
    std::pair<int, int> ends_;
    Child child_;
};

#ifdef WADE_HAS_ZEROMQ
class ZeroMq final : public Transport {
 public:
    explicit ZeroMq(std::uint32_t n) : place_("ipc:///tmp/" + unique_name("zmq")), child_([this, n] { consume(n); }) {
        context_ = zmq_ctx_new();
        socket_ = zmq_socket(context_, ZMQ_PAIR);
        if (zmq_bind(socket_, place_.c_str()) != 0) throw std::runtime_error("zeromq: " + place_ + " cannot be bound");
    }
    ~ZeroMq() override {
        zmq_send(socket_, "end", goodbye_bytes, 0);
        zmq_close(socket_);
        zmq_ctx_term(context_);
    }

    void exchange(const Payload& payload) override {
        char answer = 0;
        // A handshake is a message of one byte; no frame has as many as a goodbye.
        const std::size_t bytes = std::max<std::size_t>(payload.size() * sizeof(float), 1);
        const char nothing = 0;
        zmq_send(socket_, payload.empty() ? static_cast<const void*>(&nothing) : payload.data(), bytes, 0);
        if (zmq_recv(socket_, &answer, 1, 0) < 0) throw std::runtime_error("zeromq: the consumer is gone");
    }

 private:
    void consume(std::uint32_t n) const {
        void* const context = zmq_ctx_new();
        void* const socket = zmq_socket(context, ZMQ_PAIR);
        zmq_connect(socket, place_.c_str());
        Payload block(std::max<std::size_t>(arrays * std::size_t{n}, 1));
        while (zmq_recv(socket, block.data(), block.size() * sizeof(float), 0) != goodbye_bytes) {
            if (n > 0) read_block(block);
            zmq_send(socket, "", 0, 0);
        }
        zmq_close(socket);
        zmq_ctx_term(context);
    }

    static constexpr int goodbye_bytes = 3;
    std::string place_;
    Child child_;
    void* context_ = nullptr;
    void* socket_ = nullptr;
};
#endif

}  // namespace

// Four sums, so that the compiler may use vectors and the time is that of the memory.
float read_positions(std::span<const float> px, std::span<const float> py, std::span<const float> pz) {
    float total = 0;
    for (const auto& array : {px, py, pz}) {
        float sums[16] = {};
        std::size_t k = 0;
        for (; k + 16 <= array.size(); k += 16)
            for (std::size_t lane = 0; lane < 16; ++lane) sums[lane] += array[k + lane];
        for (; k < array.size(); ++k) sums[0] += array[k];
        for (const float sum : sums) total += sum;
    }
    return total;
}

Child::Child(const std::function<void()>& work) : pid_(::fork()) {
    if (pid_ < 0) throw std::runtime_error("no child process");
    if (pid_ > 0) return;
    try {
        work();
        std::_Exit(0);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench: the consumer failed: %s\n", error.what());
        std::_Exit(1);
    }
}

Child::~Child() {
    ::waitpid(pid_, nullptr, 0);
}

std::vector<std::string> transport_names() {
    std::vector<std::string> names{"memcpy", "wade in place", "wade unchecked", "wade", "unix socket"};
#ifdef WADE_HAS_ZEROMQ
    names.push_back("zeromq ipc");
#endif
    return names;
}

std::unique_ptr<Transport> make_transport(const std::string& name, std::uint32_t n) {
    if (name == "memcpy") return std::make_unique<Memcpy>(n);
    if (name == "wade in place") return std::make_unique<SharedMemory>(unique_name("shm"), n, Hand::in_place, false);
    if (name == "wade unchecked") return std::make_unique<SharedMemory>(unique_name("shm"), n, Hand::copy, false);
    if (name == "wade") return std::make_unique<SharedMemory>(unique_name("shm"), n, Hand::copy, true);
    if (name == "unix socket") return std::make_unique<UnixSocket>(n);
#ifdef WADE_HAS_ZEROMQ
    if (name == "zeromq ipc") return std::make_unique<ZeroMq>(n);
#endif
    throw std::invalid_argument("no transport " + name);
}

}  // namespace wade::bench
