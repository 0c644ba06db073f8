#include "fluid_server/server/serve.hpp"

#include <omp.h>

#include <chrono>
#include <csignal>
#include <exception>
#include <optional>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/program/run_control.hpp"
#include "configs/program/time_left.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/server/report.hpp"
#include "fluid_server/server/run_server.hpp"
#include "fluid_server/server/state_options.hpp"
#include "fluid_server/server/threads_in_use.hpp"

namespace wade::fluid {

namespace {

Pace pace_of(const std::string& word) {
    return word == "real_time" ? Pace::real_time : word == "variable" ? Pace::variable : Pace::fast;
}

std::string waits_for(int consumers) {
    if (consumers == 0) return "waiting for no crowd";
    return consumers == 1 ? "waiting for a crowd" : "waiting for " + std::to_string(consumers) + " consumers";
}

std::optional<AgentsInlet> agents_inlet(const Scene& scene, const std::string& session, const shm::Waiting& waiting) {
    if (scene.coupling->agents_stream == AgentsStream::off) return std::nullopt;
    shm::JoinOptions options;
    options.scene_hash = scene.hash;
    options.waiting = waiting;
    return AgentsInlet(session, scene.coupling->agents_stream == AgentsStream::parallel ? 1 : 0, options);
}

RunControl::Hooks control_hooks(shm::Publisher& publisher, RunClock& clock, Console& console) {
    return {[&](bool paused) {
                publisher.set_paused(paused);
                publisher.heartbeat();
                paused ? clock.pause() : clock.resume();
            },
            [&] { return received_signal() != 0 || !publisher.consumers_are_there(); },
            [&](const std::string& text) { console.line(text); }};
}

// What a run that threw leaves behind; rethrows, with where the state is after a numerical failure.
[[noreturn]] void end_badly(const ProgramStart& start, FluidModel& model, bool simulated, Console& console) {
    const std::string& save = start.options.word("--save-state");
    try {
        throw;
    } catch (const RunError& error) {
        if (error.code() != ExitCode::numerical_failure) throw;
        const std::string dump = dump_failure(model, start.loaded, start.options.out.value_or(""));
        throw RunError(error.code(), dump.empty() ? error.what() : error.what() + ("\n" + dump));
    } catch (const std::exception&) {
        try {
            if (simulated && !save.empty()) console.line(save_state(model, start.loaded, save));
        } catch (const std::exception& error) {
            console.warning(error.what());
        }
        throw;
    }
}

}  // namespace

std::vector<ProgramOption> server_options() {
    return {
        {"--consumers",
         "Consumers in lockstep to wait for before frame 1, 0 to 16; 0: wait for none, free-running readers take "
         "what they can",
         NumberRange{0, shm::max_consumers, true}, 1},
        {.name = "--clock",
         .help = "fast: send each frame as soon as it is ready. real_time: send frame f not before f / frame_rate_hz "
                 "of wall time. variable: a frame lasts as long as the wall time since the last one; not repeatable",
         .word = Word{"MODE", "fast", {"fast", "real_time", "variable"}}},
        {.name = "--from-state",
         .help = "Go on from the state in FILE instead of the scene's t = 0. Frames count from 1, the duration from "
                 "there. Spacing, kernel, rest density, channel and obstacles must be those of the state",
         .word = Word{"FILE"}},
        {.name = "--save-state",
         .help = "Write the state of the water into FILE at the end of the run, however it ends but for a numerical "
                 "failure, which leaves numerical_failure.state in --out or here",
         .word = Word{"FILE"}}};
}

std::vector<std::string> prepare_states(FluidModel& model, const RunOptions& options) {
    const std::string &from = options.word("--from-state"), &save = options.word("--save-state");
    if (!save.empty()) check_can_save_state(model, save);
    if (from.empty()) return {};
    return {start_from_state(model, from)};
}

void tell_waiting_crowd(const ProgramStart& start, int code, const std::string& why) noexcept {
    constexpr double at_most =
        1;  // s; a waiting crowd looks for the session every 5 ms, one started with the server soon does
    try {
        shm::StreamInfo info;
        info.producer_name = "fluid_server";
        info.capacity = 1;
        shm::Waiting waiting;
        waiting.attach_timeout_s = at_most;
        shm::Publisher no_water(start.options.session, info, waiting);
        try {
            no_water.wait_for_consumers(1);
        } catch (const shm::Error&) {
        }
        no_water.abort(code, why);
    } catch (const std::exception&) {  // what made the server fail is what it says
    }
}

void serve(const ProgramStart& start, FluidModel& model, Console& console) {
    const RunOptions& options = start.options;
    const auto consumers = static_cast<int>(options.extra("--consumers"));
    const Scene& scene = start.loaded.scene;
    RunClock clock(scene, pace_of(options.word("--clock")));
    auto waiting = waiting_of<shm::Waiting>(options, console);
    waiting.paused = [&](double seconds) { clock.discount(seconds); };
    shm::Publisher publisher(options.session, stream_info(scene, model), waiting);
    RunControl control("");
    const RunControl::Hooks hooks = control_hooks(publisher, clock, console);

    // Keeps the heartbeat while the server waits for the agents stream, so that consumers do not time out.
    shm::Waiting inlet_waiting = waiting;
    inlet_waiting.interrupted = [&] {
        publisher.heartbeat();
        return received_signal() != 0 || !publisher.consumers_are_there();
    };
    // A crowd that pauses also pauses the water for all its consumers.
    inlet_waiting.paused = [&](double seconds) {
        clock.discount(seconds);
        publisher.set_paused(true);
    };
    std::optional<AgentsInlet> agents = agents_inlet(scene, options.session, inlet_waiting);

    const auto begin = std::chrono::steady_clock::now();
    const auto wall = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
    ServerSummary summary;
    ServerRun run{model, publisher, clock, agents ? &*agents : nullptr, consumers};
    run.interrupted = [&] { return control.quit_asked() ? SIGINT : received_signal(); };
    run.hold = [&] {
        control.wait_while_paused(hooks);
        if (!control.take_tau_commands().empty()) console.warning("tau belongs to the crowd; tell it to crowd_client");
    };
    TimeLeft left(clock.end(), static_cast<double>(particles_expected(scene)));
    ThreadsInUse threads;
    run.on_frame = [&](const shm::Diagnostics&) {
        threads.frame_done();
        left.note(clock.simulated(), wall(), summary.particles);
        if (console.progress_due(clock.simulated())) console.progress(progress_line(run, summary, left));
    };
    console.line("session '" + options.session + "', scene '" + scene.name + "', " + std::to_string(threads.now()) +
                 " threads; " + waits_for(consumers));
    const auto write_results = [&] {
        try {
            if (options.out && summary.frames > 0) model.write_results(*options.out);
        } catch (const std::exception& error) {
            console.warning(error.what());
        }
    };
    try {
        run_server(run, summary);
    } catch (const std::exception&) {
        write_results();
        console.line(summary_text(run, summary, wall()));
        end_badly(start, model, summary.frames > 0, console);
    }
    write_results();
    console.line(summary_text(run, summary, wall()));
    const std::string& save = options.word("--save-state");
    if (!save.empty()) console.line(save_state(model, start.loaded, save));
}

}  // namespace wade::fluid
