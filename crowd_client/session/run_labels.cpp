#include "crowd_client/session/run_labels.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <string_view>
#include <thread>

namespace wade::crowd {
namespace {

constexpr std::array<std::string_view, 3> options_of_place{"--out", "--session", "--commands"};

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

bool names_a_place(std::string_view option) {
    return std::find(options_of_place.begin(), options_of_place.end(), option) != options_of_place.end();
}

}  // namespace

std::vector<std::string> portable_command(const std::vector<std::string>& arguments) {
    std::vector<std::string> portable;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string& a = arguments[i];
        if (i == 0) {
            portable.push_back(std::filesystem::path(a).filename().string());
        } else if (names_a_place(a)) {
            ++i;
        } else if (!names_a_place(std::string_view(a).substr(0, a.find('=')))) {
            portable.push_back(a);
        }
    }
    return portable;
}

Record record_of(const RunOptions& options) {
    return {.water_interval = options.extra("--water-every-s"),
            .danger_window = options.extra("--danger-every-s"),
            .trajectories = !options.has("--no-trajectories"),
            .terms_interval = options.extra("--terms-every-s")};
}

RunLabels labels_of(const ProgramStart& start) {
    RunLabels labels;
    labels.canonical_scene = start.loaded.canonical_json;
    labels.session = start.options.session;
    labels.latest_frames = start.options.word("--mode") == "latest";
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

}  // namespace wade::crowd
