// shm_record SESSION FILE: writes every frame of a session into a file, in lockstep, as a follower that neither starts a
// stream nor keeps it alive unless it is told to lead.

#include <array>
#include <cstdio>
#include <optional>
#include <sstream>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/program/program.hpp"
#include "shm_protocol/subscriber.hpp"
#include "tools/shm/frame_payload.hpp"
#include "tools/shm/recording_writer.hpp"
#include "tools/shm/tool_arguments.hpp"

namespace {

using namespace wade;

struct Options {
    std::string session, file;
    std::string stream = "fluid";
    bool lead = false;
    double frames = 0;
    double compression = 1;
    double interval_s = 0;
    std::string region;
    bool quantised = false;
    shm::Waiting waiting;
};

// Heights that a region without them reaches over, m: more than any water, and steps of a millimetre.
constexpr std::array<float, 2> heights{-16, 48};

[[noreturn]] void refuse_region(const std::string& region) {
    throw ConfigurationError(
        "--region: " + region +
        " is not allowed; allowed: X0,X1,Z0,Z1 or X0,X1,Y0,Y1,Z0,Z1 in metres, each second number above "
        "the first (shm_record --help shows the options).");
}

recording::Thinning thinning_of(const Options& o) {
    recording::Thinning thinning{};
    thinning.interval_s = static_cast<float>(o.interval_s);
    if (o.region.empty()) {
        if (o.quantised)
            throw ConfigurationError(
                "--quantised needs --region, the box of the positions, rounded to 1/65535 of its "
                "edges (shm_record --help shows the options).");
        return thinning;
    }
    std::istringstream text(o.region + ",");
    std::vector<float> ends;
    float end = 0;
    char comma = 0;
    while (text >> end >> comma && comma == ',') ends.push_back(end);
    if (!text.eof()) refuse_region(o.region);
    if (ends.size() == 4) ends.insert(ends.begin() + 2, heights.begin(), heights.end());
    if (ends.size() != 6) refuse_region(o.region);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        thinning.low[axis] = ends[2 * axis];
        thinning.high[axis] = ends[2 * axis + 1];
        const float most = 1e6;
        if (!(-most <= ends[2 * axis] && ends[2 * axis] < ends[2 * axis + 1] && ends[2 * axis + 1] <= most))
            refuse_region(o.region);
    }
    if (o.quantised) thinning.velocity_step_m_s = recording::velocity_step;
    return thinning;
}

std::string megabytes(std::uint64_t bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f MB", 1e-6 * static_cast<double>(bytes));
    return text;
}

enum class Ending { stream, limit, signal };

// Takes frames until the stream ends, the limit is reached or a signal comes.
Ending record_frames(shm::Subscriber& subscriber, recording::RecordingWriter& writer, std::uint64_t limit) {
    for (;;) {
        try {
            const auto frame = subscriber.acquire();
            if (!frame) return Ending::stream;
            writer.append(*frame);  // before the acknowledgement: what was released is in the file
        } catch (const shm::Error& error) {
            if (error.failure() == shm::Failure::interrupted) return Ending::signal;
            throw;
        }
        subscriber.release();
        if (received_signal() != 0) return Ending::signal;
        if (limit > 0 && writer.frames() >= limit) return Ending::limit;
    }
}

std::string words_for(Ending ending) {
    switch (ending) {
        case Ending::stream:
            return "the stream ended";
        case Ending::limit:
            return "left after the frames asked for";
        case Ending::signal:
            return "left at a signal";
    }
    return "";
}

int record(Options& o, Console& console) {
    recording::RecordingWriter writer(o.file, static_cast<int>(o.compression), thinning_of(o));
    std::optional<shm::Subscriber> subscriber;
    connect(o.waiting, console);
    // The goodbye comes before the error of an interrupted wait, so that the run goes on without the recorder.
    o.waiting.interrupted = [&] {
        if (received_signal() != 0 && subscriber) subscriber->leave();
        return received_signal() != 0;
    };
    shm::JoinOptions join;
    join.waiting = o.waiting;
    join.kind = o.stream == "agents" ? shm::stream_agents : shm::stream_fluid;
    join.follows = !o.lead;
    subscriber.emplace(o.session, "recorder", join);
    console.line("recording session '" + o.session + "' of '" + subscriber->info().producer_name + "' into " + o.file);

    const auto summary = [&](const std::string& why) {
        if (writer.keeps_older()) {
            console.line("no frame came, so that " + o.file + " is still the recording that was there; " + why);
            return;
        }
        const bool all = writer.frames() == writer.taken();
        console.line(std::to_string(writer.frames()) + (all ? "" : " of " + std::to_string(writer.taken())) +
                     " frames, " + megabytes(writer.plain_bytes()) + " of particles in " +
                     megabytes(writer.file_bytes()) + "; " + why);
        if (writer.outside() > 0)
            console.line("outside of the region: " + std::to_string(writer.outside()) + " particles of all frames");
        if (writer.cut() > 0) console.warning(std::to_string(writer.cut()) + " velocities above 64 m/s were cut to it");
    };
    try {
        writer.begin(subscriber->info());
        const Ending ending = record_frames(*subscriber, writer, static_cast<std::uint64_t>(o.frames));
        subscriber->leave();
        const int code = ending == Ending::signal ? exit_code_of_signal() : 0;
        writer.finish(ending == Ending::stream ? recording::end_of_stream : recording::end_of_recorder, code,
                      words_for(ending));
        summary(words_for(ending));
        return code;
    } catch (const std::exception& error) {
        const int code = exit_code_of<shm::Error>(error);
        subscriber->abort(code, std::string("The recorder gave up: ") + error.what());
        try {
            writer.finish(recording::end_of_recorder, code, error.what());
        } catch (const std::exception&) {
            // The disk may be full; the frames before are in the file.
        }
        summary("cut short");
        throw;
    }
}

}  // namespace

int main(int argc, char** argv) {
    Options o;
    ToolArguments arguments("shm_record", "Records a session into a file, frame by frame, until its stream ends.");
    arguments.positional("SESSION", o.session, "Name of the session");
    arguments.positional("FILE", o.file, "Recording to be written; an older recording is replaced");
    arguments.word("--stream", o.stream, "What to record: the water or the way back",
                   {"KIND", "", {"fluid", "agents"}});
    arguments.flag("--lead", o.lead, "Let the stream start and go on for this program, as for a crowd");
    arguments.number("--frames", o.frames, "Leave after N frames, the run goes on; 0: stay to the end", "N", {0, 1e15},
                     Whole::yes);
    arguments.number("--compression", o.compression, "0 stores, 1 to 19 compress, faster to smaller", "LEVEL", {0, 19},
                     Whole::yes);
    arguments.number("--interval-s", o.interval_s, "Record a frame each T seconds only, and the last; 0: every frame",
                     "T", {0, 86400});
    arguments.word("--region", o.region,
                   "Record only what is in X0,X1,Z0,Z1 or X0,X1,Y0,Y1,Z0,Z1, m; Y0,Y1 are -16,48 if not given",
                   {"BOX"});
    arguments.flag("--quantised", o.quantised,
                   "Round places to 1/65535 of the region and velocities to 1/512 m/s: half the size, other bits");
    arguments.waiting(o.waiting);
    return run_tool(arguments, argc, argv, [&](Console& console) {
        catch_signals();
        return record(o, console);
    });
}
