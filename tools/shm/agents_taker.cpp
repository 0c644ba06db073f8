#include "tools/shm/agents_taker.hpp"

#include <optional>
#include <utility>

#include "shm_protocol/subscriber.hpp"

namespace wade {

AgentsTaker::AgentsTaker(bool wanted, const std::string& session, shm::Waiting waiting) {
    if (!wanted) return;
    waiting.warn = {};  // the fluid's side warns
    thread_ = std::thread([this, session, waiting = std::move(waiting)] { take_all(session, waiting); });
}

AgentsTaker::~AgentsTaker() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
}

void AgentsTaker::check() const {
    if (failed_) std::rethrow_exception(error_);
}

void AgentsTaker::finish() {
    if (thread_.joinable()) thread_.join();
    check();
}

void AgentsTaker::take_all(const std::string& session, const shm::Waiting& waiting) {
    try {
        std::optional<shm::Subscriber> subscriber;
        shm::JoinOptions join;
        join.kind = shm::stream_agents;
        join.waiting = waiting;
        join.waiting.interrupted = [&] {
            const bool interrupted = waiting.interrupted && waiting.interrupted();
            if (stop_ && !interrupted && subscriber) subscriber->leave();
            return stop_ || interrupted;
        };
        subscriber.emplace(session, "replay", join);
        if (subscriber->info().impulses) {
            const std::string why =
                "A recording cannot answer people who push the water: a run with /coupling/two_way has no replay.";
            subscriber->abort(static_cast<int>(shm::Failure::protocol_violation), why);
            throw shm::Error(shm::Failure::protocol_violation, why);
        }
        while (subscriber->acquire()) subscriber->release();
    } catch (...) {
        error_ = std::current_exception();
        failed_ = true;
    }
}

}  // namespace wade
