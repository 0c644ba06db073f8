#include "crowd_client/session/party.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/program/memory.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_memory.hpp"
#include "crowd_client/outputs/run_folder.hpp"
#include "crowd_client/outputs/writers/report.hpp"
#include "crowd_client/session/crowd_list.hpp"
#include "crowd_client/session/run_labels.hpp"

namespace wade::crowd {
namespace {

void add_member(Party& party, const ProgramStart& start, LoadedScene loaded, std::string name, bool pictures) {
    Member member;
    member.name = std::move(name);
    member.place = party.many ? party.out / member.name : party.out;
    member.labels = labels_of(start);
    member.labels.canonical_scene = std::move(loaded.canonical_json);
    member.kept = pictures ? record_of(start.options) : without_pictures(record_of(start.options));
    if (party.many) member.kept.path_interval = 1;
    party.runs.push_back({.crowd = make_crowd(loaded.scene)});
    std::vector<std::string>& warnings = party.runs.back().crowd.warnings;
    warnings.insert(warnings.begin(), loaded.warnings.begin(), loaded.warnings.end());
    if (start.options.has("--step-times")) party.runs.back().crowd.times = std::make_shared<StepTimes>();
    party.members.push_back(std::move(member));
}

// Total size of crowds.
struct Size {
    std::size_t crowds = 0;
    double agents = 0, memory = empty_client;  // bytes
};

Size operator+(Size size, const Scene& scene) {
    for (const AgentGroup& group : scene.crowd->groups) size.agents += group.count;
    return {size.crowds + 1, size.agents, size.memory + memory_of_crowd(scene)};
}

std::string text_of(const Size& size) {
    return std::string(size.crowds > 1 ? "the crowds: " : "the crowd: ") +
           std::to_string(static_cast<long>(size.agents)) + " agents, " + memory_text(size.memory) + " of memory";
}

void demand_memory(const Size& size, const std::string& source) {
    check_memory(size.memory, available_memory(), source + ": " + text_of(size),
                 "take a smaller world, fewer agents, fewer /crowd/markers_per_cell, or /crowd/markers redrawn");
}

void check_mode(const Party& party, const ProgramStart& start) {
    const bool way_back = party.runs.front().crowd.scene.coupling->agents_stream != AgentsStream::off;
    if (start.options.word("--mode") != "latest" || !way_back) return;
    throw ConfigurationError(
        "--mode latest: frames may be missed, but the scene's /coupling/agents_stream answers each of them; "
        "allowed: --mode lockstep, or agents_stream \"off\".");
}

void tell_of_earlier_runs(const Party& party, Console& console) {
    std::size_t replaced = 0;
    std::string last;
    for (const Member& member : party.members) {
        const std::string earlier = earlier_run(member.place);
        if (earlier.empty()) continue;
        ++replaced;
        last = earlier;
    }
    if (replaced == 0) return;
    const std::string of_many = " of " + std::to_string(replaced) + " of " + std::to_string(party.members.size()) +
                                " crowds in '" + party.out.string() + "'";
    console.line("replaces the results of an earlier run" +
                 (party.many ? of_many : " in '" + party.out.string() + "': " + last));
}

// Writes outcome.json, as far as possible, for a folder that could not be opened, so that a reader finds the run there.
void leave_outcome(const Member& member, const CrowdRun& run) {
    try {
        write_whole_file(member.place / "outcome.json", outcome_json(run.crowd, run.summary, member.labels));
    } catch (const OutputError&) {
        // The console and the exit code say what happened.
    }
}

std::string csv_of(const Party& party) {
    std::string csv =
        "name,seed,status,agents,arrived,dead,active,sheltered,indoors,upper_floor,last_arrival_s,message\n";
    for (std::size_t k = 0; k < party.runs.size(); ++k) {
        csv += party.members[k].name + ',' + crowds_csv_row(party.runs[k].crowd, party.runs[k].summary) + '\n';
    }
    return csv;
}

}  // namespace

std::string size_of_party(const Party& party) {
    Size size;
    for (const CrowdRun& run : party.runs) size = size + run.crowd.scene;
    const Crowd& first = *party.runs.front().crowd.scene.crowd;
    if (first.response != ResponseKind::measured) return text_of(size);
    return text_of(size) + "; walking in water by the law \"" + name_of(first.walking_in_water) + "\"";
}

Party make_party(const ProgramStart& start) {
    const RunOptions& options = start.options;
    Party party;
    party.many = !options.word("--crowds").empty();
    party.out = options.out.value_or(default_run_folder(start.loaded.scene.name));
    if (!party.many) {
        demand_memory(Size{} + start.loaded.scene, options.scene_file.string());
        add_member(party, start, start.loaded, "", true);
        check_mode(party, start);
        return party;
    }
    std::vector<ListedCrowd> listed =
        load_crowds(options.word("--crowds"), options.scene_file, options.overrides, start.loaded);
    Size size;
    for (const ListedCrowd& crowd : listed) size = size + crowd.loaded.scene;
    demand_memory(size, options.word("--crowds"));
    for (ListedCrowd& crowd : listed) {
        add_member(party, start, std::move(crowd.loaded), std::move(crowd.name), crowd.pictures);
    }
    return party;
}

void open_folders(Party& party, Console& console) {
    if (party.many) {
        std::vector<std::size_t> files;
        for (std::size_t k = 0; k < party.runs.size(); ++k) {
            files.push_back(files_kept_open(party.runs[k].crowd.scene, party.members[k].kept));
        }
        allow_open_files(files);
        make_run_folder(party.out);
    }
    tell_of_earlier_runs(party, console);
    std::error_code ignored;
    if (party.many) std::filesystem::remove(party.out / "crowds.csv", ignored);
    for (std::size_t k = 0; k < party.runs.size(); ++k) {
        Member& member = party.members[k];
        member.folder = std::make_unique<RunFolder>(member.place, party.runs[k].crowd, member.labels, member.kept,
                                                    [&console](const std::string& text) { console.warning(text); });
    }
}

void finish(Party& party, std::size_t k, Console& console) {
    Member& member = party.members[k];
    CrowdRun& run = party.runs[k];
    if (std::exchange(member.finished, true)) return;
    const auto tell = [&](const std::string& text) {
        console.line(party.many ? "crowd \"" + member.name + "\": " + text : text);
    };
    if (party.many && run.failure) tell(run.summary.message);
    member.labels.wall_time = party.clock.seconds();
    const std::unique_ptr<RunFolder> folder = std::move(member.folder);
    if (!folder) return leave_outcome(member, run);
    try {
        folder->finish(run.crowd, run.summary, member.labels);
    } catch (const std::exception& error) {
        tell(error.what());
        if (!run.failure) run.failure = std::current_exception();
    }
}

void give_up(Party& party, const std::exception& error) {
    for (CrowdRun& run : party.runs) {
        if (!run.over || !party.many) fail_summary(run.summary, error);
    }
}

void sum_up(const Party& party) {
    if (party.many) write_whole_file(party.out / "crowds.csv", csv_of(party));
}

}  // namespace wade::crowd
