#pragma once
// The part of a fluid producer in a two-way run that has no use for the agents: takes every frame, looks at none.

#include <atomic>
#include <exception>
#include <string>
#include <thread>

#include "shm_protocol/stream.hpp"

namespace wade {

// Takes the frames of `/<session>-agents` in a thread of its own, from the moment the stream appears to its end.
class AgentsTaker {
 public:
    // Does nothing at all unless `wanted`.
    AgentsTaker(bool wanted, const std::string& session, shm::Waiting waiting);
    ~AgentsTaker();  // says goodbye
    AgentsTaker(const AgentsTaker&) = delete;
    AgentsTaker& operator=(const AgentsTaker&) = delete;

    // Throws what the thread met, if anything.
    void check() const;

    // Waits for the end of the stream. Errors: as check().
    void finish();

 private:
    void take_all(const std::string& session, const shm::Waiting& waiting);

    std::atomic<bool> stop_{false}, failed_{false};
    std::exception_ptr error_;
    std::thread thread_;
};

}  // namespace wade
