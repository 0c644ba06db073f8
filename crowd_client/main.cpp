// crowd_client SCENE.json: walks the crowd of a scene through the water that a fluid server sends.

#include <unistd.h>

#include <chrono>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "configs/command_line.hpp"
#include "configs/exit_code.hpp"
#include "configs/peer_support.hpp"
#include "configs/program.hpp"
#include "crowd_client/progress.hpp"
#include "crowd_client/run_client.hpp"
#include "crowd_client/run_folder.hpp"

namespace {

using namespace wade;
using namespace wade::crowd;

class Stopwatch {
 public:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

 private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

std::string host_name() {
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

// The command without what differs between two runs of the same thing: places and session names.
std::vector<std::string> portable_command(const std::vector<std::string>& arguments) {
    std::vector<std::string> portable;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string& a = arguments[i];
        if (i == 0) {
            portable.push_back(std::filesystem::path(a).filename().string());
        } else if (a == "--out" || a == "--session") {
            ++i;
        } else if (a.rfind("--out=", 0) != 0 && a.rfind("--session=", 0) != 0) {
            portable.push_back(a);
        }
    }
    return portable;
}

RunLabels labels_of(const ProgramStart& start) {
    RunLabels labels;
    labels.canonical_scene = start.loaded.canonical_json;
    labels.session = start.options.session;
    labels.reproducible = start.options.reproducible;
    labels.threads = start.options.threads;
    labels.command_line = labels.reproducible ? portable_command(start.options.arguments) : start.options.arguments;
    if (!labels.reproducible) {
        if (labels.threads == 0) labels.threads = static_cast<int>(std::thread::hardware_concurrency());
        labels.started_at = utc_now();
        labels.host = host_name();
    }
    return labels;
}

std::string status_for(const std::exception& error) {
    const auto* output = dynamic_cast<const OutputError*>(&error);
    return output != nullptr && output->disk_full() ? "disk_full" : status_of(exit_code_of<shm::Error>(error));
}

struct Run {
    CrowdWorld crowd;
    RunSummary summary;
    RunLabels labels;
    Stopwatch clock;
};

// Takes part in the session to its end; errors pass through, with `run` complete up to the last frame.
void take_part(Run& run, RunFolder& folder, const RunOptions& options, Console& console) {
    const std::unique_ptr<FrameSource> source = join_session(
        options.session, run.crowd.scene.hash, run.crowd.scene.frame_rate, waiting_of<shm::Waiting>(options, console));
    run.labels.model = source->info().producer_name;
    console.line("joined session '" + options.session + "' of '" + run.labels.model + "'");
    run.clock = Stopwatch();

    ClientHooks hooks;
    hooks.interrupted = [] { return received_signal(); };
    hooks.on_frame = [&](const CrowdWorld& crowd, const shm::Frame& frame, const WaterView& water) {
        folder.record(crowd, water);
        if (console.progress_due(static_cast<double>(crowd.frame) * crowd.dt)) {
            console.progress(progress_line(crowd, frame, run.clock.seconds()));
        }
    };
    run_client(run.crowd, *source, run.summary, hooks);
}

int run_scene(const ProgramStart& start, Console& console) {
    Run run;
    run.crowd = make_crowd(start.loaded.scene);
    run.labels = labels_of(start);
    RunFolder folder(start.options.out.value_or(default_run_folder(run.crowd.scene.name)), run.crowd, run.labels,
                     start.options.extra("--water-every-s"));
    run.clock = Stopwatch();
    int code = static_cast<int>(ExitCode::ok);
    try {
        take_part(run, folder, start.options, console);
        if (run.summary.status == "stream_ended") {
            run.summary.message = "the stream of water ended after frame " + std::to_string(run.summary.frames) +
                                  " of " + std::to_string(frames_of(run.crowd.scene));
            console.warning(run.summary.message);
        }
    } catch (const std::exception& error) {
        code = exit_code_of<shm::Error>(error);
        run.summary.status = status_for(error);
        run.summary.message = error.what();
        console.line(error.what());
    }
    const double wall_time = run.clock.seconds();
    run.labels.wall_time = wall_time;
    try {
        folder.finish(run.crowd, run.summary, run.labels);
    } catch (const std::exception& error) {
        console.line(error.what());
        if (code == static_cast<int>(ExitCode::ok)) code = exit_code_of<shm::Error>(error);
    }
    console.line(summary_text(run.crowd, run.summary, wall_time));
    std::cout << (folder.path() / "outcome.json").string() << std::endl;
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    Console console("crowd_client");
    try {
        const ProgramDescription program{
            "crowd_client",
            "Walks the crowd of a scene through the water that a fluid server sends.",
            {{"--water-every-s", "Simulated time between two stored pictures of the water, s; 0: none",
              NumberRange{0, 1e6}, 5}}};
        const ProgramStart start = start_program(program, argc, argv);
        if (start.answer) {
            std::cout << *start.answer;
            return 0;
        }
        catch_signals();
        return run_scene(start, console);
    } catch (const std::exception& error) {
        console.line(error.what());
        return exit_code_of<shm::Error>(error);
    }
}
