// shm_replay FILE --session NAME: a producer that plays a recording, the same frames with the same hash chain.

#include <atomic>
#include <cstdio>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/program/program.hpp"
#include "shm_protocol/publisher.hpp"
#include "shm_protocol/subscriber.hpp"
#include "tools/shm/recording.hpp"
#include "tools/shm/tool_arguments.hpp"

namespace {

using namespace wade;
using recording::Recording;

struct Options {
    std::string file, session;
    bool info = false;
    bool any_scene = false;
    bool take_agents = false;
    double depth = 0;
    double consumers = 1;
    shm::Waiting waiting;
};

// Consumes the agents stream of a two-way run as a fluid producer does, and ignores what the frames hold.
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

    // Throws the refusal of a stream with impulses, if one came: it is the cause of any other error of the replay.
    void check_refusal() const;

    // Waits for the end of the stream. Errors: as check().
    void finish();

 private:
    void take_all(const std::string& session, const shm::Waiting& waiting);
    void fail(std::exception_ptr error);

    std::atomic<bool> stop_{false}, failed_{false}, refused_{false};
    std::exception_ptr error_;
    std::thread thread_;
};

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

void AgentsTaker::check_refusal() const {
    if (refused_) check();
}

void AgentsTaker::fail(std::exception_ptr error) {
    if (failed_) return;
    error_ = std::move(error);
    failed_ = true;
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
                "A recording cannot answer people that push the water: a run with /coupling/two_way has no replay.";
            // Recorded before the crowd is told: otherwise the end of the crowd would be taken for the cause.
            fail(std::make_exception_ptr(shm::Error(shm::Failure::protocol_violation, why)));
            refused_ = true;
            subscriber->abort(static_cast<int>(shm::Failure::protocol_violation), why);
            return;
        }
        while (subscriber->acquire()) subscriber->release();
    } catch (...) {
        fail(std::current_exception());
    }
}

std::string ending_of(const Recording& r) {
    const std::uint64_t last = r.frames().empty() ? 0 : r.frames().back().descriptor.frame;
    const std::string after = last == 0 ? "before its first frame" : "after frame " + std::to_string(last);
    if (!r.end())
        return "incomplete: the file was cut off " + after + " (" + std::to_string(r.file_bytes() - r.whole_bytes()) +
               " bytes of the next record are left out)";
    const std::string text = shm::printable(r.end()->text, sizeof r.end()->text);
    if (r.end()->reason == recording::end_of_stream) return "complete: " + text;
    return "incomplete: the recorder ended " + after + " (" + text + ")";
}

// What a recording of version 2 is not of the run.
std::string thinning_of(const Recording& r) {
    const recording::Thinning& t = r.thinning();
    std::string out;
    const auto add = [&out](const char* form, auto... values) {
        char text[160];
        std::snprintf(text, sizeof text, form, values...);
        out += (out.empty() ? "" : "; ") + std::string(text);
    };
    if (t.interval_s > 0) add("a frame each %.6g s", static_cast<double>(t.interval_s));
    if (recording::has_box(t)) {
        const auto d = [](float value) { return static_cast<double>(value); };
        add("x %g to %g, y %g to %g, z %g to %g m", d(t.low[0]), d(t.high[0]), d(t.low[1]), d(t.high[1]), d(t.low[2]),
            d(t.high[2]));
    }
    if (recording::is_quantised(t))
        add("places within %.2g m, velocities within %.2g m/s", static_cast<double>(t.position_error_m),
            static_cast<double>(t.velocity_step_m_s) / 2);
    return out;
}

std::string info_text(const Options& o, const Recording& r) {
    const shm::StreamInfo& s = r.info();
    const auto& frames = r.frames();
    char text[1024];
    std::string out = o.file + ": " + (s.kind == shm::stream_agents ? "agents" : "water") + " of '" + s.producer_name +
                      "', scene " + (s.scene_hash == 0 ? "not given" : hash_text(s.scene_hash)) + "\n";
    const double rate = static_cast<double>(s.ticks_per_second) / static_cast<double>(s.ticks_per_frame);
    std::snprintf(text, sizeof text, "stream      capacity %u, depth %u, %.6g frames/s, coupling lag %u\n", s.capacity,
                  s.depth, rate, s.coupling_lag);
    out += text;
    if (frames.empty()) {
        out += "frames      none\n";
    } else {
        std::uint32_t least = ~0U, most = 0;
        for (const auto& f : frames) {
            least = std::min(least, f.descriptor.count);
            most = std::max(most, f.descriptor.count);
        }
        const auto& first = frames.front().descriptor;
        const auto& last = frames.back().descriptor;
        std::snprintf(text, sizeof text, "frames      %llu to %llu, up to %.6g s%s; %u to %u particles\n",
                      static_cast<unsigned long long>(first.frame), static_cast<unsigned long long>(last.frame),
                      static_cast<double>(last.tick) / static_cast<double>(s.ticks_per_second),
                      (last.flags & shm::frame_final) != 0 ? ", the last one final" : "", least, most);
        out += text;
        out += "frame hash  " + hash_text(last.hash) + "\n";
    }
    if (recording::is_thinned(r.thinning())) out += "thinned     " + thinning_of(r) + "\n";
    const auto plain = static_cast<double>(r.plain_bytes());
    std::snprintf(text, sizeof text, "size        %.2f MB for %.2f MB of particles, ratio %.2f\n",
                  1e-6 * static_cast<double>(r.file_bytes()), 1e-6 * plain,
                  plain / static_cast<double>(r.file_bytes()));
    out += text;
    return out + "end         " + ending_of(r) + "\n";
}

shm::StreamInfo stream_of(const Options& o, const Recording& r) {
    shm::StreamInfo info = r.info();
    info.hash_frames = true;
    if (o.depth > 0) {
        info.depth = static_cast<std::uint32_t>(o.depth);
        info.slots = 0;
    }
    if (o.any_scene) info.scene_hash = 0;
    return info;
}

// Plays all frames. Returns the number of the first frame that no consumer wanted any more, 0 if all were played.
std::uint64_t play(Recording& r, shm::Publisher& publisher, AgentsTaker& agents) {
    for (const auto& record : r.frames()) {
        agents.check();
        const auto& d = record.descriptor;
        if (received_signal() != 0)
            throw shm::Error(shm::Failure::interrupted,
                             "Interrupted by a signal at frame " + std::to_string(d.frame) + ".");
        const auto slot = publisher.begin_frame();
        if (!slot) return d.frame;
        r.read(record, *slot);
        publisher.end_frame(d.count, d.diagnostics, (d.flags & shm::frame_final) != 0, d.tick);
    }
    return 0;
}

// Waits for the consumers and plays; as play(). Throws the refusal of agents that push, whichever stream ends first.
std::uint64_t play_to(Recording& r, shm::Publisher& publisher, AgentsTaker& agents, int consumers) {
    try {
        if (consumers > 0) publisher.wait_for_consumers(consumers);
        const std::uint64_t left_at = play(r, publisher, agents);
        publisher.close();
        return left_at;
    } catch (const shm::Error&) {
        agents.check_refusal();
        throw;
    }
}

int replay(Options& o, Recording& r, Console& console) {
    connect(o.waiting, console);
    if (!r.frames().empty() && r.frames().front().descriptor.frame != 1)
        throw ConfigurationError(o.file + " begins at frame " + std::to_string(r.frames().front().descriptor.frame) +
                                 "; only a recording from frame 1 on can be played.");
    shm::Publisher publisher(o.session, stream_of(o, r), o.waiting);
    console.line("session '" + o.session + "', " + std::to_string(r.frames().size()) + " frames of '" +
                 r.info().producer_name + "' from " + o.file + "; waiting for " +
                 std::to_string(static_cast<int>(o.consumers)) + (o.consumers == 1 ? " consumer" : " consumers"));
    if (recording::is_thinned(r.thinning()))
        console.warning(o.file + " is thinned (" + thinning_of(r) +
                        "): the crowd goes other ways than in the run, and the frame hash is that of the file");
    try {
        AgentsTaker agents(o.take_agents, o.session, o.waiting);
        const std::uint64_t left_at = play_to(r, publisher, agents, static_cast<int>(o.consumers));
        agents.finish();
        std::string summary =
            std::to_string(publisher.published_frames()) + " frames played, hash " + hash_text(publisher.frame_hash());
        if (left_at != 0) summary += "; the consumers said goodbye before frame " + std::to_string(left_at);
        console.line(summary);
        if (left_at == 0 && (!r.end() || r.end()->reason != recording::end_of_stream))
            console.warning("the recording is " + ending_of(r));
        return 0;
    } catch (const std::exception& error) {
        publisher.abort(exit_code_of<shm::Error>(error), error.what());
        throw;
    }
}

}  // namespace

int main(int argc, char** argv) {
    Options o;
    ToolArguments arguments("shm_replay", "Plays a recording as the producer of a session, or prints what it holds.");
    arguments.positional("FILE", o.file, "Recording written by shm_record");
    arguments.word("--session", o.session, "Name under which the consumers find the stream", {"NAME"});
    arguments.flag("--info", o.info, "Print what the file holds, and end");
    arguments.number("--depth", o.depth, "Frames the replay may be ahead, 1 to 63; 0: as recorded", "D", {0, 63},
                     Whole::yes);
    arguments.number("--consumers", o.consumers, "Consumers in lockstep to wait for before the first frame; 0: none",
                     "N", {0, 16}, Whole::yes);
    arguments.flag("--any-scene", o.any_scene,
                   "Do not tell the scene of the recording, so that any other may be played");
    arguments.flag("--take-agents", o.take_agents, "Take the frames of the way back, and ignore them");
    arguments.waiting(o.waiting);
    return run_tool(arguments, argc, argv, [&](Console& console) {
        if (!o.info && o.session.empty())
            throw ConfigurationError("--session NAME or --info is required (shm_replay --help shows the options).");
        catch_signals();
        Recording recording(o.file);
        if (!o.info) return replay(o, recording, console);
        std::cout << info_text(o, recording);
        return 0;
    });
}
