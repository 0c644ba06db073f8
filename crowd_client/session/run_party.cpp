#include "crowd_client/session/run_party.hpp"

#include <algorithm>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "configs/program/peer_support.hpp"
#include "configs/program/run_control.hpp"
#include "configs/program/time_left.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "crowd_client/outputs/writers/played_events.hpp"
#include "crowd_client/session/frame_time.hpp"
#include "crowd_client/session/party.hpp"
#include "crowd_client/session/progress.hpp"
#include "crowd_client/water_warnings.hpp"
#include "shm_protocol/inside/segment.hpp"
#include "shm_protocol/subscriber.hpp"

namespace wade::crowd {
namespace {

constexpr double patience_to_refuse = 5;  // s, time for the water to appear and be told that the crowd cannot join

FrameMode mode_of(const RunOptions& options) {
    return options.word("--mode") == "latest" ? FrameMode::latest : FrameMode::lockstep;
}

// Tells the water of the session why this crowd will not come, if the water waits for its first consumers. Does not
// disturb running water, nor a crowd that runs with it.
void refuse_water(const ProgramStart& start, const std::exception& error, Console& console) {
    const RunOptions& options = start.options;
    if (mode_of(options) == FrameMode::latest) return;  // no water waits for it
    auto waiting = waiting_of<shm::Waiting>(options, console);
    waiting.attach_timeout_s = std::min(waiting.attach_timeout_s, patience_to_refuse);
    try {
        shm::Subscriber::refuse(options.session, "crowd", {.scene_hash = start.loaded.scene.hash, .waiting = waiting},
                                exit_code_of<shm::Error>(error), error.what());
    } catch (const std::exception&) {
        // There is no water to be told.
    }
}

// A step towards the run that happens before the crowd has joined.
template <typename Work>
void before_joining(const ProgramStart& start, Console& console, Work&& work) {
    try {
        work();
    } catch (const std::exception& error) {
        console.line(error.what());
        refuse_water(start, error, console);
        throw;
    }
}

// Whether the frames so far match the scene, so that the same events in the same scene lead to the same run.
struct Regularity {
    bool so_far = true;
    void see(const shm::StreamInfo& info, const shm::Frame& frame, const Scene& scene) {
        so_far = so_far && rate_note(scene, info).empty() && frame.tick == frame.frame * info.ticks_per_frame;
    }
};

CrowdsProgress progress_of(const Party& party) {
    CrowdsProgress totals{.crowds = party.runs.size()};
    for (const CrowdRun& run : party.runs) {
        totals.time = std::max(totals.time, time_of(run.crowd));
        if (run.over) continue;
        ++totals.walking;
        totals.active += run.crowd.active.size();
    }
    return totals;
}

// The run of a party through the water.
class Voyage {
 public:
    Voyage(Party& party, const ProgramStart& start, RunControl& control, Console& console)
        : party_(party),
          start_(start),
          control_(control),
          console_(console),
          left_(start.loaded.scene.duration, static_cast<double>(particles_expected(start.loaded.scene))) {}

    void take_part() {
        const RunOptions& options = start_.options;
        demand_free_way_back();
        tell_warnings();
        join();
        party_.clock = Stopwatch();
        const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
        const int threads = options.threads > 0 ? options.threads : processors;
        run_crowds(party_.runs, *source_, hooks(), party_.many ? threads : 1, agents_ ? &*agents_ : nullptr);
    }

 private:
    [[nodiscard]] CrowdRun& only() { return party_.runs.front(); }
    [[nodiscard]] bool has_way_back() {
        return !party_.many && only().crowd.scene.coupling->agents_stream != AgentsStream::off;
    }

    // A second crowd, started by mistake, must not join the water and disturb the first one.
    void demand_free_way_back() {
        const std::string& session = start_.options.session;
        if (!has_way_back() || !shm::has_living_producer(session, shm::stream_agents)) return;
        throw shm::Error(
            shm::Failure::name_in_use,
            "Session '" + session + "' has a crowd that gives its agents to the water; choose another session.");
    }

    void join() {
        const RunOptions& options = start_.options;
        const auto waiting = waiting_of<shm::Waiting>(options, console_);
        // While the crowd waits for the water, it keeps its own stream alive, or paused, so that consumers do not time
        // out.
        shm::Waiting for_water = waiting;
        for_water.interrupted = [&] {
            if (agents_) agents_->heartbeat();
            return received_signal() != 0;
        };
        for_water.paused = [&](double) {
            if (agents_) agents_->set_paused(true);
        };
        source_ = join_session(options.session, start_.loaded.scene.hash, mode_of(options), for_water);
        const std::string& model = source_->info().producer_name;
        for (Member& member : party_.members) member.labels.model = model;
        console_.line("joined session '" + options.session + "' of '" + model + "'" +
                      (party_.many ? " with " + std::to_string(party_.runs.size()) + " crowds" : ""));
        suit_to_water();
        const std::string note = rate_note(start_.loaded.scene, source_->info());
        if (!note.empty()) console_.line(note);
        if (has_way_back()) open_way_back(waiting);
    }

    // People sample and push the water as its stream describes it.
    void suit_to_water() {
        const shm::StreamInfo& info = source_->info();
        const StreamWater water{choice_named<ModelKind>(info.producer_name),
                                2 * info.particle_radius,
                                {info.column_width[0], info.column_width[1]}};
        for (CrowdRun& run : party_.runs) {
            try {
                suit_to_stream(run.crowd, water);
            } catch (const std::exception& error) {
                source_->abort(exit_code_of<shm::Error>(error), error.what());
                throw;
            }
        }
    }

    // Opens the agents stream; if that fails, tells the producer of the water why, and throws.
    void open_way_back(shm::Waiting waiting) {
        // While the crowd waits for the water to take its agents, the water may die.
        waiting.interrupted = [this] { return received_signal() != 0 || !source_->producer_is_there(); };
        try {
            agents_.emplace(start_.options.session, only().crowd, source_->info(), waiting,
                            static_cast<int>(start_.options.extra("--agents-consumers")));
        } catch (const std::exception& error) {
            source_->abort(exit_code_of<shm::Error>(error), error.what());
            throw;
        }
    }

    RunHooks hooks() {
        RunHooks hooks;
        hooks.interrupted = [] { return received_signal(); };
        hooks.quit = [this] { return control_.quit_asked(); };
        hooks.before_frame = [this] { take_commands(); };
        hooks.on_step = [this](std::size_t k, const WaterView& water) {
            party_.members[k].folder->record(party_.runs[k].crowd, water);
        };
        if (party_.many) {
            hooks.on_over = [this](std::size_t k) { finish(party_, k, console_); };
            hooks.on_frame = [this](const shm::Frame& frame) {
                tell_warnings();
                const CrowdsProgress now = progress_of(party_);
                left_.note(now.time, party_.clock.seconds(), frame.count);
                if (console_.progress_due(now.time)) console_.progress(progress_line(now, frame, left_.pace()));
            };
        } else {
            hooks.on_frame = [this](const shm::Frame& frame) { note_frame(frame); };
        }
        hooks.warn = [this](const std::string& text) { console_.warning(text); };
        return hooks;
    }

    void take_commands() {
        RunControl::Hooks pause;
        pause.paused = [this](bool paused) {
            source_->set_paused(paused);
            if (!agents_) return;
            agents_->set_paused(paused);
            agents_->heartbeat();
        };
        pause.interrupted = [this] { return received_signal() != 0 || !source_->producer_is_there(); };
        pause.message = [this](const std::string& text) { console_.line(text); };
        control_.wait_while_paused(pause);
        const std::vector<TauCommand> commands = control_.take_tau_commands();
        if (party_.many && !commands.empty()) {
            console_.line("tau of many crowds cannot be changed by a command; give them events in the list of crowds");
            return;
        }
        for (const TauCommand& command : commands) obey(command);
    }

    void obey(const TauCommand& command) {
        try {
            const TauEvent event = event_of(only().crowd, command);
            party_.members.front().folder->record_event(event);
            add_event(only().crowd, event);
            console_.line("from frame " + std::to_string(event.frame) + " on: " + event_json(event));
            if (regularity_.so_far && source_->in_lockstep()) return;
            console_.warning(
                "the frames of this water are not those of the scene, so scene_as_played.json does not "
                "repeat this run; a recording does (shm_record)");
        } catch (const ConfigurationError& error) {
            console_.line(error.what());
        }
    }

    // Prints each warning of the crowds once.
    void tell_warnings() {
        for (std::size_t k = 0; k < party_.runs.size(); ++k) {
            const std::vector<std::string>& warnings = party_.runs[k].crowd.warnings;
            for (std::size_t& told = party_.members[k].warnings_told; told < warnings.size(); ++told) {
                if (!said_.insert(warnings[told]).second) continue;
                console_.warning((party_.many ? "crowd \"" + party_.members[k].name + "\": " : "") + warnings[told]);
            }
        }
    }

    // For a single crowd.
    void note_frame(const shm::Frame& frame) {
        tell_warnings();
        const CrowdWorld& crowd = only().crowd;
        regularity_.see(source_->info(), frame, crowd.scene);
        const std::uint64_t steps = crowd.steps - std::exchange(steps_before_, crowd.steps);
        if (static_cast<double>(steps) > crowd.scene.crowd->step_rate && !std::exchange(told_of_gaps_, true)) {
            console_.warning(std::to_string(steps) + " steps, more than a second, were walked through frame " +
                             std::to_string(frame.frame) + " alone; water that runs in real time leaves fewer gaps");
        }
        const Member& member = party_.members.front();
        member.folder->keep_results(crowd, only().summary, member.labels);
        const double time = time_of(crowd);
        left_.note(time, party_.clock.seconds(), frame.count);
        if (!console_.progress_due(time)) return;
        console_.progress(progress_line(crowd, frame, left_.pace(), left_.seconds()));
    }

    Party& party_;
    const ProgramStart& start_;
    RunControl& control_;
    Console& console_;
    std::unique_ptr<FrameSource> source_;
    std::optional<AgentsPublisher> agents_;
    Regularity regularity_;
    TimeLeft left_;
    std::set<std::string> said_;
    std::uint64_t steps_before_ = 0;
    bool told_of_gaps_ = false;
};

// The water ends for all at once, so that once is enough.
void warn_of_early_end(const Party& party, Console& console) {
    const auto ended_early = [](const CrowdRun& run) { return run.summary.status == "stream_ended"; };
    const auto count = std::count_if(party.runs.begin(), party.runs.end(), ended_early);
    if (count == 0) return;
    const auto first = std::find_if(party.runs.begin(), party.runs.end(), ended_early);
    console.warning(first->summary.message +
                    (party.many ? "; crowds that it ended: " + std::to_string(count) : std::string()));
}

void say_goodbye(const Party& party, Console& console) {
    if (party.many) {
        const auto ended_well = std::count_if(party.runs.begin(), party.runs.end(),
                                              [](const CrowdRun& run) { return run.over && !run.failure; });
        console.line(std::to_string(ended_well) + " of " + std::to_string(party.runs.size()) +
                     " crowds are over without error");
    } else {
        const CrowdRun& run = party.runs.front();
        console.line(summary_text(run.crowd, run.summary, party.members.front().labels.wall_time.value_or(0)));
        if (const std::string text = step_times_text(run.crowd); !text.empty()) console.line(text);
    }
    std::cout << (party.out / (party.many ? "crowds.csv" : "outcome.json")).string() << std::endl;
}

}  // namespace

int run_party(const ProgramStart& start, Console& console) {
    int code = static_cast<int>(ExitCode::ok);
    const auto note = [&](const std::exception& error) {
        if (code == static_cast<int>(ExitCode::ok)) code = exit_code_of<shm::Error>(error);
    };
    Party party;
    std::optional<RunControl> control;
    try {
        before_joining(start, console, [&] {
            party = make_party(start);
            control.emplace(start.options.word("--commands"));
        });
    } catch (const std::exception& error) {
        return exit_code_of<shm::Error>(error);
    }
    bool has_folders = false;
    try {
        before_joining(start, console, [&] { open_folders(party, console); });
        has_folders = true;
        Voyage(party, start, *control, console).take_part();
    } catch (const std::exception& error) {
        if (has_folders) console.line(error.what());
        note(error);
        give_up(party, error);
    }
    for (std::size_t k = 0; k < party.runs.size(); ++k) {
        finish(party, k, console);
        const std::exception_ptr failure = party.runs[k].failure;
        if (!failure || code != static_cast<int>(ExitCode::ok)) continue;
        code = static_cast<int>(ExitCode::unexpected);
    }
    if (!has_folders) return code;
    warn_of_early_end(party, console);
    try {
        sum_up(party);
    } catch (const std::exception& error) {
        console.line(error.what());
        note(error);
    }
    say_goodbye(party, console);
    return code;
}

std::string check_party(const ProgramStart& start) {
    const Party party = make_party(start);
    std::string said;
    for (std::size_t k = 0; k < party.runs.size(); ++k) {
        const CrowdWorld& crowd = party.runs[k].crowd;
        std::vector<std::string> warnings = crowd.warnings;
        for (std::string& warning : water_warnings(crowd.scene)) warnings.push_back(std::move(warning));
        for (const std::string& warning : warnings) {
            const std::string who = party.many ? "crowd \"" + party.members[k].name + "\": " : "";
            said += "warning: " + who + warning + "\n";
        }
    }
    const std::string list = start.options.word("--crowds");
    if (party.many) said += list + ": valid; " + std::to_string(party.runs.size()) + " crowds\n";
    return said + size_of_party(party) + "\n";
}

}  // namespace wade::crowd
