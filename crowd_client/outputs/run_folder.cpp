#include "crowd_client/outputs/run_folder.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <exception>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"
#include "crowd_client/outputs/writers/danger.hpp"

namespace wade::crowd {

std::size_t files_kept_open(const Scene& scene, const Record& kept) {
    std::size_t files = 0;
    for (const RegisteredOutput& output : outputs()) files += output.wanted(scene, kept) ? output.kept_open : 0;
    return files;
}

void allow_open_files(std::span<const std::size_t> per_crowd) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    constexpr rlim_t others = 48;  // the segment, streams, files that are written as a whole, and some to spare
    rlim_t needed = others;
    std::size_t fitting = 0;
    for (const std::size_t files : per_crowd) {
        needed += files;
        if (needed <= limit.rlim_max) ++fitting;
    }
    if (needed > limit.rlim_max) {
        throw ConfigurationError("--crowds: " + std::to_string(per_crowd.size()) + " crowds keep up to " +
                                 std::to_string(needed) + " files open, but this process may have " +
                                 std::to_string(limit.rlim_max) + " (ulimit -Hn); allowed: the first " +
                                 std::to_string(fitting) +
                                 " crowds of the list, or fewer files with \"pictures\": false.");
    }
    limit.rlim_cur = std::max(limit.rlim_cur, needed);
    ::setrlimit(RLIMIT_NOFILE, &limit);
}

std::string earlier_run(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "outcome.json";
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored))) return "";
    try {
        const Json outcome = Json::parse(read_text_file(file, file.string()));
        return outcome.at("scene").get<std::string>() + ", " +
               std::to_string(outcome.at("arrived").get<std::int64_t>()) + " of " +
               std::to_string(outcome.at("agents").get<std::int64_t>()) + " arrived";
    } catch (const std::exception&) {
        return "an outcome.json that cannot be read";
    }
}

RunFolder::RunFolder(std::filesystem::path folder, const CrowdWorld& crowd, const RunLabels& labels, const Record& kept,
                     Warn warn, std::span<const RegisteredOutput> list)
    : folder_(std::move(folder)) {
    make_run_folder(folder_);
    std::error_code ignored;
    for (const char* picture : {"figure.png", "danger.png"}) std::filesystem::remove(folder_ / picture, ignored);
    for (const RegisteredOutput& output : list) {
        for (const std::string_view file : output.files) {
            if (!file.empty()) std::filesystem::remove(folder_ / file, ignored);
        }
    }
    OutputPlace place{folder_, crowd, labels, kept, nullptr, warn ? std::move(warn) : [](const std::string&) {}};
    if (kept.danger_window > 0) {
        place.danger = std::make_shared<DangerRecord>(crowd.scene, crowd.agents.size(), kept.danger_window);
    }
    // Outputs that show the start of the run come first. Outputs that may fill the disk come last, after space is
    // reserved for the end.
    outputs_.resize(list.size());
    std::size_t bytes = 0;
    for (const Turn turn : {Turn::report, Turn::results, Turn::growing}) {
        if (turn == Turn::growing) reserve_.emplace(folder_ / ".reserve", bytes);
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (list[i].turn != turn || !list[i].wanted(crowd.scene, kept)) continue;
            outputs_[i] = {turn, list[i].make(place)};
            bytes += outputs_[i].writer->bytes_at_end();
        }
    }
    std::erase_if(outputs_, [](const Output& output) { return !output.writer; });
}

void RunFolder::record(const CrowdWorld& crowd, const WaterView& water) {
    for (const Output& output : outputs_) output.writer->on_step(crowd, water);
}

void RunFolder::keep_results(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels) {
    const double begin = clock_.seconds();
    if (begin < next_results_) return;
    for (const Output& output : outputs_) output.writer->keep({crowd, summary, labels});
    const double end = clock_.seconds();
    next_results_ = end + std::max(results_interval, 100 * (end - begin));
}

void RunFolder::record_event(const TauEvent& event) {
    for (const Output& output : outputs_) output.writer->on_event(event);
}

void RunFolder::finish(const CrowdWorld& crowd, RunSummary& summary, const RunLabels& labels) {
    std::exception_ptr first;
    const auto finish_all = [&](Turn turn) {
        for (const Output& output : outputs_) {
            if (output.turn != turn) continue;
            try {
                output.writer->finish({crowd, summary, labels});
            } catch (const std::exception& error) {
                if (!first) first = std::current_exception();
                fail_summary(summary, error);
            }
        }
    };
    // Closing growing files needs space, too; on a full disk the texts come first.
    const bool disk_full = summary.status == "disk_full";
    if (!disk_full) finish_all(Turn::growing);
    reserve_.reset();
    finish_all(Turn::results);
    const std::string status_before = summary.status;
    finish_all(Turn::report);
    if (disk_full) finish_all(Turn::growing);
    if (summary.status != status_before) finish_all(Turn::report);
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
