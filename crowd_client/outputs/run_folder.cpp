#include "crowd_client/outputs/run_folder.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "crowd_client/outputs/played_events.hpp"

namespace wade::crowd {

Record without_pictures(const Record& record) {
    return {.water_interval = 0, .danger_window = record.danger_window, .trajectories = false};
}

std::size_t files_kept_open(const Scene& scene, const Record& kept) {
    constexpr std::size_t of_a_database = 3;  // with its log and the index of that
    return (kept.trajectories ? of_a_database : 0) + (kept.water_interval > 0 ? 1 : 0) + (has_ragdolls(scene) ? 1 : 0);
}

std::string earlier_run(const std::filesystem::path& folder) {
    std::ifstream file(folder / "outcome.json");
    if (!file) return "";
    try {
        const nlohmann::json outcome = nlohmann::json::parse(file);
        return outcome.at("scene").get<std::string>() + ", " + std::to_string(outcome.at("arrived").get<int>()) +
               " of " + std::to_string(outcome.at("agents").get<int>()) + " arrived";
    } catch (const std::exception&) {
        return "an outcome.json that cannot be read";
    }
}

RunFolder::RunFolder(std::filesystem::path folder, const CrowdWorld& crowd, const RunLabels& labels, const Record& kept)
    : folder_(std::move(folder)), canonical_scene_(labels.canonical_scene) {
    make_run_folder(folder_);
    std::error_code ignored;
    for (const char* old : {"agents.csv", "water.bin", "figure.png", "events.jsonl", "scene_as_played.json",
                            "ragdoll.csv", "danger.csv", "danger.png"}) {
        std::filesystem::remove(folder_ / old, ignored);
    }
    write_whole_file(folder_ / "manifest.json", manifest_json(crowd, RunSummary{}, labels));
    write_whole_file(folder_ / "outcome.json", outcome_json(crowd, RunSummary{}, labels));
    if (kept.danger_window > 0) danger_.emplace(crowd.scene, crowd.agents.size(), kept.danger_window);
    // Twice the length of a line of agents.csv and of danger.csv, twice the other files and their blocks.
    const std::size_t lines = crowd.agents.size() + (danger_ ? danger_->cells().size() : 0);
    reserve_.emplace(folder_ / ".reserve", 400 * lines + 2 * labels.canonical_scene.size() + 65536);
    if (has_ragdolls(crowd.scene)) ragdolls_.emplace(folder_ / "ragdoll.csv");
    if (kept.trajectories) {
        trajectories_.emplace(folder_ / "trajectories.sqlite", crowd.scene);
        trajectories_->write(0, crowd.agents, crowd.active);
    } else {
        std::filesystem::remove(folder_ / "trajectories.sqlite", ignored);
    }
    if (kept.water_interval > 0) {
        water_.emplace(folder_ / "water.bin", crowd.scene);
        steps_per_snapshot_ = static_cast<std::uint64_t>(std::max(1LL, std::llround(kept.water_interval / crowd.dt)));
    }
}

void RunFolder::record(const CrowdWorld& crowd, const WaterView& water) {
    if (trajectories_) trajectories_->write(crowd.steps, crowd.agents, crowd.active);
    if (ragdolls_) ragdolls_->write(crowd.steps, crowd.ragdolls, crowd.agents);
    if (danger_) danger_->add(crowd.agents, crowd.active, water);
    if (!water_) return;
    // After the first and the last step, too, so that any time of the run has a picture at most one interval away.
    const bool due = crowd.steps == 1 || crowd.steps % steps_per_snapshot_ == 0;
    if (due || run_is_over(crowd)) {
        water_->write(crowd.steps, static_cast<double>(crowd.steps) * crowd.dt, water);
    }
}

void RunFolder::keep_results(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels) {
    const double begin = clock_.seconds();
    if (begin < next_results_) return;
    write_whole_file(folder_ / "agents.csv", agents_csv(crowd, danger_ ? &*danger_ : nullptr));
    if (danger_) write_whole_file(folder_ / "danger.csv", danger_csv(*danger_));
    write_whole_file(folder_ / "outcome.json", outcome_json(crowd, summary, labels));
    const double end = clock_.seconds();
    next_results_ = end + std::max(results_interval, 100 * (end - begin));
}

void RunFolder::record_event(const TauEvent& event) {
    played_.push_back(event);
    if (!events_) events_.emplace(folder_ / "events.jsonl");
    events_->append(event_json(event) + "\n");
    write_whole_file(folder_ / "scene_as_played.json", scene_with_events(canonical_scene_, played_));
}

void RunFolder::finish(const CrowdWorld& crowd, RunSummary& summary, const RunLabels& labels) {
    std::exception_ptr first;
    const auto attempt = [&](const std::function<void()>& write) {
        try {
            write();
        } catch (const std::exception& error) {
            if (!first) first = std::current_exception();
            fail_summary(summary, error);
        }
    };
    const auto write_ends = [&] {
        attempt([&] { write_whole_file(folder_ / "manifest.json", manifest_json(crowd, summary, labels)); });
        attempt([&] { write_whole_file(folder_ / "outcome.json", outcome_json(crowd, summary, labels)); });
    };
    // Closing the database needs space, too; on a full disk the texts come first.
    const bool disk_full = summary.status == "disk_full";
    if (trajectories_ && !disk_full) attempt([&] { trajectories_->close(); });
    reserve_.reset();
    if (danger_) danger_->close();
    attempt([&] { write_whole_file(folder_ / "agents.csv", agents_csv(crowd, danger_ ? &*danger_ : nullptr)); });
    if (danger_) attempt([&] { write_whole_file(folder_ / "danger.csv", danger_csv(*danger_)); });
    const std::string status_before = summary.status;
    write_ends();
    if (trajectories_ && disk_full) attempt([&] { trajectories_->close(); });
    if (summary.status != status_before) write_ends();
    if (first) std::rethrow_exception(first);
}

std::filesystem::path default_run_folder(const std::string& scene_name) {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char time_text[32];
    std::strftime(time_text, sizeof time_text, "%Y%m%d-%H%M%S", &utc);
    std::string name = scene_name.empty() ? "scene" : scene_name;
    std::replace(name.begin(), name.end(), '/', '_');
    const std::filesystem::path stem = std::filesystem::path("runs") / (name + "-" + time_text);
    std::filesystem::path folder = stem;
    for (int n = 2; std::filesystem::exists(folder); ++n) folder = stem.string() + "-" + std::to_string(n);
    return folder;
}

}  // namespace wade::crowd
