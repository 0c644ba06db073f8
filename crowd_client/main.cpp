// crowd_client SCENE.json: walks the crowd of a scene through the water that a fluid server sends.

#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/program/command_line.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/program/program.hpp"
#include "configs/program/run_control.hpp"
#include "crowd_client/outputs/played_events.hpp"
#include "crowd_client/outputs/run_folder.hpp"
#include "crowd_client/outputs/stopwatch.hpp"
#include "crowd_client/session/agents_stream.hpp"
#include "crowd_client/session/crowds_program.hpp"
#include "crowd_client/session/frame_time.hpp"
#include "crowd_client/session/progress.hpp"
#include "crowd_client/session/run_client.hpp"
#include "crowd_client/session/run_labels.hpp"
#include "shm_protocol/inside/segment.hpp"

namespace {

using namespace wade;
using namespace wade::crowd;

struct Run {
    CrowdWorld crowd;
    RunSummary summary;
    RunLabels labels;
    Stopwatch clock;
};

bool has_way_back(const Run& run) {
    return run.crowd.scene.coupling.agents_stream != AgentsStream::off;
}

// A second crowd, started by mistake, must not join the water and disturb the first one.
void demand_free_way_back(const Run& run) {
    if (!has_way_back(run) || !shm::has_living_producer(run.labels.session, shm::stream_agents)) return;
    throw shm::Error(
        shm::Failure::name_in_use,
        "Session '" + run.labels.session + "' has a crowd whose agents the water takes; choose another session.");
}

// Empty if the scene has no way back. The producer learns why there is none if it should have been there.
std::optional<AgentsPublisher> open_way_back(const Run& run, FrameSource& source, shm::Waiting waiting, int consumers) {
    if (!has_way_back(run)) return std::nullopt;
    // While the crowd waits for the water to take its agents, the water may die.
    waiting.interrupted = [&source] { return received_signal() != 0 || !source.producer_is_there(); };
    try {
        return AgentsPublisher(run.labels.session, run.crowd, source.info(), waiting, consumers);
    } catch (const std::exception& error) {
        source.abort(exit_code_of<shm::Error>(error), error.what());
        throw;
    }
}

// Whether the frames so far are those of the scene, so that the same events in the same scene lead to the same run.
struct Regularity {
    bool so_far = true;
    void see(const shm::StreamInfo& info, const shm::Frame& frame, const Scene& scene) {
        so_far = so_far && rate_note(scene, info).empty() && frame.tick == frame.frame * info.ticks_per_frame;
    }
};

void obey(const TauCommand& command, CrowdWorld& crowd, RunFolder& folder, bool repeatable, Console& console) {
    try {
        const TauEvent event = event_of(crowd, command);
        folder.record_event(event);
        add_event(crowd, event);
        console.line("from frame " + std::to_string(event.frame) + " on: " + event_json(event));
        if (!repeatable)
            console.warning(
                "the frames of this water are not those of the scene, so scene_as_played.json does not "
                "repeat this run; a recording does (shm_record)");
    } catch (const ConfigurationError& error) {
        console.line(error.what());
    }
}

// Takes part in the session to its end; errors pass through, with `run` complete up to the last frame.
void take_part(Run& run, RunFolder& folder, const RunOptions& options, RunControl& control, Console& console) {
    std::optional<AgentsPublisher> agents;
    const auto waiting = waiting_of<shm::Waiting>(options, console);
    // While the crowd waits for the water it still lives, or pauses with it, for those who wait for its agents.
    shm::Waiting for_water = waiting;
    for_water.interrupted = [&] {
        if (agents) agents->heartbeat();
        return received_signal() != 0;
    };
    for_water.paused = [&](double) {
        if (agents) agents->set_paused(true);
    };
    demand_free_way_back(run);
    const FrameMode mode = run.labels.latest_frames ? FrameMode::latest : FrameMode::lockstep;
    const std::unique_ptr<FrameSource> source = join_session(options.session, run.crowd.scene.hash, mode, for_water);
    run.labels.model = source->info().producer_name;
    console.line("joined session '" + options.session + "' of '" + run.labels.model + "'");
    if (const std::string note = rate_note(run.crowd.scene, source->info()); !note.empty()) console.line(note);
    agents = open_way_back(run, *source, waiting, static_cast<int>(options.extra("--agents-consumers")));
    run.clock = Stopwatch();

    Regularity regularity;
    RunControl::Hooks control_hooks;
    control_hooks.paused = [&](bool paused) {
        source->set_paused(paused);
        if (!agents) return;
        agents->set_paused(paused);
        agents->heartbeat();
    };
    control_hooks.interrupted = [&] { return received_signal() != 0 || !source->producer_is_there(); };
    control_hooks.message = [&](const std::string& text) { console.line(text); };

    ClientHooks hooks;
    hooks.interrupted = [] { return received_signal(); };
    hooks.quit = [&] { return control.quit_asked(); };
    hooks.before_frame = [&] {
        control.wait_while_paused(control_hooks);
        for (const TauCommand& command : control.take_tau_commands()) {
            obey(command, run.crowd, folder, regularity.so_far && !run.labels.latest_frames, console);
        }
    };
    hooks.on_step = [&](const CrowdWorld& crowd, const WaterView& water) { folder.record(crowd, water); };
    std::uint64_t steps_before = 0;
    bool told_of_gaps = false;
    hooks.on_frame = [&](const CrowdWorld& crowd, const shm::Frame& frame) {
        regularity.see(source->info(), frame, crowd.scene);
        const std::uint64_t steps = crowd.steps - std::exchange(steps_before, crowd.steps);
        if (static_cast<double>(steps) > crowd.scene.crowd.step_rate && !std::exchange(told_of_gaps, true)) {
            console.warning(std::to_string(steps) + " steps, more than a second, were walked through frame " +
                            std::to_string(frame.frame) + " alone; water that runs in real time leaves fewer gaps");
        }
        folder.keep_results(crowd, run.summary, run.labels);
        if (console.progress_due(static_cast<double>(crowd.steps) * crowd.dt)) {
            console.progress(progress_line(crowd, frame, run.clock.seconds()));
        }
    };
    run_client(run.crowd, *source, run.summary, hooks, agents ? &*agents : nullptr);
}

int run_scene(const ProgramStart& start, Console& console) {
    Run run;
    run.crowd = make_crowd(start.loaded.scene);
    run.labels = labels_of(start);
    if (run.labels.latest_frames && has_way_back(run)) {
        throw ConfigurationError(
            "--mode latest: frames may be missed, but the scene's /coupling/agents_stream answers each of them; "
            "allowed: --mode lockstep, or agents_stream \"off\".");
    }
    RunControl control(start.options.word("--commands"));
    const std::filesystem::path out = start.options.out.value_or(default_run_folder(run.crowd.scene.name));
    if (const std::string earlier = earlier_run(out); !earlier.empty()) {
        console.line("replaces the results of an earlier run in '" + out.string() + "': " + earlier);
    }
    RunFolder folder(out, run.crowd, run.labels, record_of(start.options));
    run.clock = Stopwatch();
    int code = static_cast<int>(ExitCode::ok);
    try {
        take_part(run, folder, start.options, control, console);
        if (run.summary.status == "stream_ended") console.warning(run.summary.message);
    } catch (const std::exception& error) {
        code = exit_code_of<shm::Error>(error);
        fail_summary(run.summary, error);
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

ProgramDescription description() {
    return {
        "crowd_client",
        "Walks the crowd of a scene through the water that a fluid server sends.",
        {{.name = "--water-every-s",
          .help = "Simulated time between two stored pictures of the water, s; 0: none",
          .number = NumberRange{0, 1e6},
          .preset = 5},
         {.name = "--danger-every-s",
          .help = "Simulated time over which the water is averaged for the danger levels of the paper's Table 2, s: a "
                  "map in danger.csv, more columns in agents.csv; 0: none",
          .number = NumberRange{0, 1e6},
          .preset = 0},
         {.name = "--no-trajectories",
          .help = "Write no trajectories.sqlite, for many runs of which only the end counts"},
         {.name = "--crowds",
          .help =
              "Many crowds in the water of one server: a JSON list of { \"name\": ..., \"set\": { pointer: value } }; "
              "each walks as if alone, into DIR/<name>/, and DIR/crowds.csv sums up (see docs/commands.md)",
          .word = Word{"FILE"}},
         {.name = "--mode",
          .help = "lockstep: every frame, and the producer waits for the crowd. latest: the newest frame, and the "
                  "producer never waits; frames may be dropped, so that two runs differ",
          .word = Word{"MODE", "lockstep", {"lockstep", "latest"}}},
         {.name = "--agents-consumers",
          .help = "With /coupling/agents_stream: consumers that the way back waits for, the water among them; 2 leaves "
                  "room for a recorder of the agents",
          .number = NumberRange{1, shm::max_consumers, true},
          .preset = 1},
         {.name = "--commands",
          .help = "Where lines with commands come from: pause, resume, step [N] (N frames of water), tau VALUE "
                  "[agent ID | group NAME], quit, an empty line to pause or resume. PLACE: a FIFO, made if it is "
                  "absent; -: stdin [the terminal, if stdin is one]. SIGUSR1 pauses or resumes, SIGUSR2 does one "
                  "frame",
          .word = Word{"PLACE"}}}};
}

}  // namespace

int main(int argc, char** argv) {
    Console console("crowd_client");
    try {
        const ProgramStart start = start_program(description(), argc, argv);
        const bool many = !start.loaded.canonical_json.empty() && !start.options.word("--crowds").empty();
        if (start.answer) {
            const std::string crowds = many ? check_of_crowds(start) : "";
            std::cout << *start.answer << (start.options.check ? crowds : "");
            return 0;
        }
        if (many) let_threads_spin_briefly(argv);
        catch_signals();
        if (many) return run_list_of_crowds(start, console);
        return run_scene(start, console);
    } catch (const std::exception& error) {
        console.line(error.what());
        return exit_code_of<shm::Error>(error);
    }
}
