// splishsplash_producer SCENE.json: runs a scene of SPlisHSPlasH without its window and publishes the particles.
//
// The simulator's own files stay as they are: the exporter is registered from outside, before the simulator is set up.

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "SPlisHSPlasH/Utilities/SurfaceSampling.h"
#include "Simulator/SceneConfiguration.h"
#include "tools/splishsplash/ParticleExporter_Wade.h"

namespace {

std::atomic<int> received_signal = 0;

constexpr const char* usage =
    "Usage: splishsplash_producer SCENE.json --frames N [--session NAME] [--reproducible] [--log-dir DIR]\n"
    "Simulates a scene of SPlisHSPlasH and publishes frames 1 to N to a Wade session.\n"
    "  --frames N      frames to publish, from 1 on; the simulation ends earlier if the consumers leave\n"
    "  --session NAME  overrides /Wade/session of the scene\n"
    "  --reproducible  samples all boundaries on a regular pattern; those of emitters are random otherwise\n"
    "  --log-dir DIR   folder of the simulator's log, default splishsplash_log\n"
    "Exit codes: 0 ok, 1 unexpected, 2 bad usage or scene, 3 nobody came, 4 peer dead, 5 peer aborted,\n"
    "6 protocol violation, 7 step time-out, 8 name in use, 130 or 143 interrupted.\n";

struct Options {
    std::filesystem::path scene;
    std::uint64_t frames = 0;
    std::string session;
    bool reproducible = false;
    std::filesystem::path log_folder = "splishsplash_log";
};

std::uint64_t positive_integer(const std::string& option, const std::string& text) {
    if (text.empty() || text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos ||
        std::stoull(text) == 0) {
        throw std::invalid_argument(option + " is '" + text + "', allowed is 1 to 999999999");
    }
    return std::stoull(text);
}

Options read_options(const std::vector<std::string>& words) {
    Options options;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string& word = words[i];
        if (word.rfind("--", 0) != 0) {
            if (!options.scene.empty()) throw std::invalid_argument("more than one scene: '" + word + "'");
            options.scene = word;
            continue;
        }
        if (word == "--reproducible") {
            options.reproducible = true;
            continue;
        }
        if (word != "--frames" && word != "--session" && word != "--log-dir") {
            throw std::invalid_argument("unknown option '" + word + "'");
        }
        if (++i == words.size()) throw std::invalid_argument(word + " needs a value");
        if (word == "--frames") options.frames = positive_integer(word, words[i]);
        if (word == "--session") options.session = words[i];
        if (word == "--log-dir") options.log_folder = words[i];
    }
    if (options.scene.empty()) throw std::invalid_argument("a scene file is missing");
    if (options.frames == 0) throw std::invalid_argument("--frames is missing");
    // The simulator ends the process with code 1 if it cannot read its scene.
    if (!std::filesystem::is_regular_file(options.scene)) {
        throw std::invalid_argument("no such scene file: " + options.scene.string());
    }
    return options;
}

void catch_signals() {
    struct sigaction action = {};
    action.sa_handler = [](int signal) { received_signal = signal; };
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
}

// A random pattern is drawn from the system's entropy, so that no two runs are alike. Call before the boundaries are
// made, after emitters have added theirs.
void sample_boundaries_regularly() {
    for (auto* boundary : SPH::SceneConfiguration::getCurrent()->getScene().boundaryModels) {
        boundary->samplingMode = SPH::SurfaceSamplingMode::RegularTriangle;
    }
}

int run(const Options& options) {
    const auto start = std::chrono::steady_clock::now();
    SPH::SimulatorBase simulator;
    auto* exporter = new SPH::ParticleExporter_Wade(&simulator);  // the simulator deletes its exporters
    exporter->set_session(options.session);
    exporter->set_last_frame(options.frames);
    exporter->set_interrupted([] { return received_signal != 0; });
    simulator.addParticleExporter("enableWadeExport", "Wade exporter", "Publish the particles to a Wade session.",
                                  exporter);

    // The simulator takes relative paths from the folder of its program. Without a window it asks for a time to stop
    // at; the exporter ends the run. Its cache of boundary samples would be written beside the scene.
    simulator.init({"splishsplash_producer", std::filesystem::absolute(options.scene).string(), "--no-gui",
                    "--no-cache", "--no-initial-pause", "--stopAt", "1e9", "--output-dir",
                    std::filesystem::absolute(options.log_folder).string()},
                   "splishsplash_producer");
    simulator.initSimulation();
    if (options.reproducible) sample_boundaries_regularly();
    exporter->setActive(true);
    simulator.runSimulation();
    exporter->finish();
    const wade::splishsplash::ExportOutcome outcome = exporter->outcome();
    simulator.cleanup();

    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::cout << "splishsplash_producer: " << outcome.frames << " frames, " << outcome.particles
              << " particles in the last, frame hash " << std::hex << std::setfill('0') << std::setw(16)
              << outcome.frame_hash << std::dec << std::fixed << std::setprecision(1) << ", " << wall << " s of which "
              << outcome.publish_s << " s publishing and waiting"
              << (outcome.consumers_left ? ", the consumers have left" : "") << '\n';
    if (outcome.exit_code != 0) std::cerr << "splishsplash_producer: " << outcome.reason << '\n';
    return outcome.exit_code == 130 && received_signal == SIGTERM ? 143 : outcome.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() == 1 && (words[0] == "--help" || words[0] == "-h")) {
        std::cout << usage;
        return 0;
    }
    try {
        const Options options = read_options(words);
        catch_signals();
        return run(options);
    } catch (const std::invalid_argument& error) {
        std::cerr << "splishsplash_producer: " << error.what() << '\n' << usage;
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "splishsplash_producer: " << error.what() << '\n';
        return 1;
    }
}
