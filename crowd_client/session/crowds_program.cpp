#include "crowd_client/session/crowds_program.hpp"

#include <algorithm>
#include <exception>
#include <iostream>
#include <memory>
#include <thread>
#include <vector>

#include "configs/program/peer_support.hpp"
#include "configs/program/run_control.hpp"
#include "crowd_client/outputs/open_files.hpp"
#include "crowd_client/outputs/run_folder.hpp"
#include "crowd_client/outputs/stopwatch.hpp"
#include "crowd_client/session/crowd_list.hpp"
#include "crowd_client/session/frame_time.hpp"
#include "crowd_client/session/progress.hpp"
#include "crowd_client/session/run_crowds.hpp"
#include "crowd_client/session/run_labels.hpp"

namespace wade::crowd {
namespace {

// A crowd beside its CrowdRun of the same place.
struct Member {
    std::string name;
    RunLabels labels;
    Record kept;
    std::unique_ptr<RunFolder> folder;  // none once it is finished
};

struct Ensemble {
    std::filesystem::path out;
    std::vector<CrowdRun> runs;
    std::vector<Member> members;
    Stopwatch clock;
};

std::vector<ListedCrowd> listed(const ProgramStart& start) {
    return load_crowds(start.options.word("--crowds"), start.options.scene_file, start.options.overrides, start.loaded);
}

Ensemble make_ensemble(const ProgramStart& start) {
    Ensemble all;
    std::vector<ListedCrowd> crowds = listed(start);
    all.out = start.options.out.value_or(default_run_folder(start.loaded.scene.name));
    for (ListedCrowd& listed_crowd : crowds) {
        all.runs.push_back({.crowd = make_crowd(listed_crowd.loaded.scene), .summary = {}});
        RunLabels labels = labels_of(start);
        labels.canonical_scene = std::move(listed_crowd.loaded.canonical_json);
        const Record asked = record_of(start.options);
        all.members.push_back({std::move(listed_crowd.name), std::move(labels),
                               listed_crowd.pictures ? asked : without_pictures(asked), nullptr});
    }
    return all;
}

void open_folders(Ensemble& all, Console& console) {
    make_run_folder(all.out);
    const auto replaced = std::count_if(all.members.begin(), all.members.end(), [&](const Member& member) {
        return !earlier_run(all.out / member.name).empty();
    });
    if (replaced > 0) {
        console.line("replaces the results of an earlier run of " + std::to_string(replaced) + " of " +
                     std::to_string(all.members.size()) + " crowds in '" + all.out.string() + "'");
    }
    std::error_code ignored;
    std::filesystem::remove(all.out / "crowds.csv", ignored);
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
        Member& member = all.members[k];
        member.folder =
            std::make_unique<RunFolder>(all.out / member.name, all.runs[k].crowd, member.labels, member.kept);
    }
}

// Writes the last files of crowd k, once; an error is its failure, if it had none before.
void finish(Ensemble& all, std::size_t k, Console& console) {
    Member& member = all.members[k];
    CrowdRun& run = all.runs[k];
    const std::unique_ptr<RunFolder> folder = std::move(member.folder);
    if (!folder) return;
    const auto tell = [&](const std::string& text) { console.line("crowd \"" + member.name + "\": " + text); };
    if (run.failure) tell(run.summary.message);
    member.labels.wall_time = all.clock.seconds();
    try {
        folder->finish(run.crowd, run.summary, member.labels);
    } catch (const std::exception& error) {
        tell(error.what());
        if (!run.failure) run.failure = std::current_exception();
    }
}

CrowdsProgress progress_of(const Ensemble& all) {
    CrowdsProgress totals{.crowds = all.runs.size()};
    for (const CrowdRun& run : all.runs) {
        totals.time = std::max(totals.time, static_cast<double>(run.crowd.steps) * run.crowd.dt);
        if (run.over) continue;
        ++totals.walking;
        totals.active += run.crowd.active.size();
    }
    return totals;
}

void take_part(Ensemble& all, const ProgramStart& start, RunControl& control, Console& console) {
    const RunOptions& options = start.options;
    const FrameMode mode = options.word("--mode") == "latest" ? FrameMode::latest : FrameMode::lockstep;
    const auto waiting = waiting_of<shm::Waiting>(options, console);
    const std::unique_ptr<FrameSource> source = join_session(options.session, start.loaded.scene.hash, mode, waiting);
    for (Member& member : all.members) member.labels.model = source->info().producer_name;
    console.line("joined session '" + options.session + "' of '" + source->info().producer_name + "' with " +
                 std::to_string(all.runs.size()) + " crowds");
    if (const std::string note = rate_note(start.loaded.scene, source->info()); !note.empty()) console.line(note);
    all.clock = Stopwatch();

    RunControl::Hooks control_hooks;
    control_hooks.paused = [&](bool paused) { source->set_paused(paused); };
    control_hooks.interrupted = [&] { return received_signal() != 0 || !source->producer_is_there(); };
    control_hooks.message = [&](const std::string& text) { console.line(text); };

    CrowdsHooks hooks;
    hooks.interrupted = [] { return received_signal(); };
    hooks.quit = [&] { return control.quit_asked(); };
    hooks.before_frame = [&] {
        control.wait_while_paused(control_hooks);
        if (!control.take_tau_commands().empty()) {
            console.line("tau of many crowds cannot be changed by a command; give them events in the list of crowds");
        }
    };
    hooks.on_step = [&](std::size_t k, const WaterView& water) {
        all.members[k].folder->record(all.runs[k].crowd, water);
    };
    hooks.on_over = [&](std::size_t k) { finish(all, k, console); };
    hooks.on_frame = [&](const shm::Frame& frame) {
        const CrowdsProgress now = progress_of(all);
        if (console.progress_due(now.time)) console.progress(progress_line(now, frame, all.clock.seconds()));
    };
    const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    run_crowds(all.runs, *source, hooks, options.threads > 0 ? options.threads : processors);
}

// Crowds that are not over when the run ends badly get its reason.
void give_up(Ensemble& all, const std::exception& error) {
    for (CrowdRun& run : all.runs) {
        if (!run.over) fail_summary(run.summary, error);
    }
}

// The water ends for all at once, so that once is enough.
void warn_of_early_end(const Ensemble& all, Console& console) {
    const auto ended_early = [](const CrowdRun& run) { return run.summary.status == "stream_ended"; };
    const auto first = std::find_if(all.runs.begin(), all.runs.end(), ended_early);
    if (first == all.runs.end()) return;
    console.warning(first->summary.message +
                    "; crowds that it ended: " + std::to_string(std::count_if(first, all.runs.end(), ended_early)));
}

std::string csv_of(const Ensemble& all) {
    std::string csv = "name,seed,status,agents,arrived,dead,active,last_arrival_s,message\n";
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
        csv += all.members[k].name + ',' + crowds_csv_row(all.runs[k].crowd, all.runs[k].summary) + '\n';
    }
    return csv;
}

}  // namespace

std::string check_of_crowds(const ProgramStart& start) {
    return start.options.word("--crowds") + ": valid; " + std::to_string(listed(start).size()) + " crowds\n";
}

int run_list_of_crowds(const ProgramStart& start, Console& console) {
    Ensemble all = make_ensemble(start);
    std::vector<std::size_t> files;
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
        files.push_back(files_kept_open(all.runs[k].crowd.scene, all.members[k].kept));
    }
    allow_open_files(files);
    RunControl control(start.options.word("--commands"));
    int code = static_cast<int>(ExitCode::ok);
    const auto note = [&](const std::exception& error) {
        console.line(error.what());
        if (code == static_cast<int>(ExitCode::ok)) code = exit_code_of<shm::Error>(error);
    };
    try {
        open_folders(all, console);
        take_part(all, start, control, console);
    } catch (const std::exception& error) {
        note(error);
        give_up(all, error);
    }
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
        finish(all, k, console);
        if (all.runs[k].failure && code == static_cast<int>(ExitCode::ok))
            code = static_cast<int>(ExitCode::unexpected);
    }
    warn_of_early_end(all, console);
    try {
        write_whole_file(all.out / "crowds.csv", csv_of(all));
    } catch (const std::exception& error) {
        note(error);
    }
    const auto ended_well =
        std::count_if(all.runs.begin(), all.runs.end(), [](const CrowdRun& run) { return run.over && !run.failure; });
    console.line(std::to_string(ended_well) + " of " + std::to_string(all.runs.size()) +
                 " crowds are over without error");
    std::cout << (all.out / "crowds.csv").string() << std::endl;
    return code;
}

}  // namespace wade::crowd
