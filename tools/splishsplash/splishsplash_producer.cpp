// splishsplash_producer SCENE.json: runs a scene of SPlisHSPlasH without its window and publishes the particles, or
// writes them with what they cost.
//
// The simulator's own files stay as they are: the exporter is registered from outside, before the simulator is set up.

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "SPlisHSPlasH/DFSPH/TimeStepDFSPH.h"
#include "SPlisHSPlasH/Simulation.h"
#include "SPlisHSPlasH/TimeManager.h"
#include "SPlisHSPlasH/Utilities/SurfaceSampling.h"
#include "Simulator/SceneConfiguration.h"
#include "Utilities/Version.h"
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
    "or splishsplash_producer SCENE.json --measure DIR --until-s T --frame-s E [--reproducible] [--log-dir DIR]\n"
    "Simulates T seconds of the model, and publishes nothing.\n"
    "  --measure DIR   writes DIR/frames.bin, every E seconds, and DIR/cost.json, see tools/splishsplash/README.md\n"
    "Exit codes: 0 ok, 1 unexpected, 2 bad usage or scene, 3 no consumer came, 4 peer dead, 5 peer aborted,\n"
    "6 protocol violation, 7 step time-out, 8 name in use, 130 or 143 interrupted.\n";

struct Options {
    std::filesystem::path scene;
    std::uint64_t frames = 0;
    std::string session;
    bool reproducible = false;
    std::filesystem::path log_folder = "splishsplash_log";
    std::filesystem::path measure_folder;  // empty: publish
    double until = 0, every = 0;           // s of the model
};

std::uint64_t positive_integer(const std::string& option, const std::string& text) {
    if (text.empty() || text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos ||
        std::stoull(text) == 0) {
        throw std::invalid_argument(option + " is '" + text + "', allowed is 1 to 999999999");
    }
    return std::stoull(text);
}

double positive_number(const std::string& option, const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !std::isfinite(value) || value <= 0) {
        throw std::invalid_argument(option + " is '" + text + "', allowed is a number above 0");
    }
    return value;
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
        if (word != "--frames" && word != "--session" && word != "--log-dir" && word != "--measure" &&
            word != "--until-s" && word != "--frame-s") {
            throw std::invalid_argument("unknown option '" + word + "'");
        }
        if (++i == words.size()) throw std::invalid_argument(word + " needs a value");
        if (word == "--frames") options.frames = positive_integer(word, words[i]);
        if (word == "--session") options.session = words[i];
        if (word == "--log-dir") options.log_folder = words[i];
        if (word == "--measure") options.measure_folder = words[i];
        if (word == "--until-s") options.until = positive_number(word, words[i]);
        if (word == "--frame-s") options.every = positive_number(word, words[i]);
    }
    if (options.scene.empty()) throw std::invalid_argument("a scene file is missing");
    if (options.measure_folder.empty()) {
        if (options.frames == 0) throw std::invalid_argument("--frames is missing");
    } else if (options.until == 0 || options.every == 0) {
        throw std::invalid_argument("--measure needs --until-s and --frame-s");
    }
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

// What a run costs and how far its densities are off, without set-up, measuring and writing.
struct Cost {
    std::uint64_t steps = 0;
    double particle_steps = 0, cpu = 0, wall = 0;              // s
    double density_iterations = 0, divergence_iterations = 0;  // summed
    double mean_error = 0, max_error = 0;                      // of max(0, rho / rho_0 - 1): summed over steps, largest
};

double processor_time() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void add_densities(const SPH::FluidModel& water, Cost& cost) {
    double sum = 0;
    for (unsigned int i = 0; i < water.numActiveParticles(); ++i) {
        const double error = std::max(0.0, static_cast<double>(water.getDensity(i) / water.getDensity0()) - 1);
        sum += error;
        cost.max_error = std::max(cost.max_error, error);
    }
    cost.mean_error += sum / std::max(1U, water.numActiveParticles());
}

// Time, number of particles, then x, y, z, vx, vy, vz and pressure of all, single precision, units of the model. The fields of
// the solver hold its two pressures over the density, times the time step for which each was found: squared, and as it is.
void write_frame(std::ofstream& file, SPH::FluidModel& water, double time, double step_before, double step_now) {
    const std::uint64_t count = water.numActiveParticles();
    file.write(reinterpret_cast<const char*>(&time), sizeof time);
    file.write(reinterpret_cast<const char*>(&count), sizeof count);
    std::vector<float> values(count);
    const auto write = [&](auto&& value) {
        for (unsigned int i = 0; i < count; ++i) values[i] = static_cast<float>(value(i));
        file.write(reinterpret_cast<const char*>(values.data()),
                   static_cast<std::streamsize>(values.size() * sizeof(float)));
    };
    for (int axis = 0; axis < 3; ++axis) write([&](unsigned int i) { return water.getPosition(i)[axis]; });
    for (int axis = 0; axis < 3; ++axis) write([&](unsigned int i) { return water.getVelocity(i)[axis]; });
    const auto& density = water.getField("p / rho^2");
    const auto& divergence = water.getField("p_v / rho^2");
    write([&](unsigned int i) {
        const double of_density = static_cast<double>(*static_cast<Real*>(density.getFct(i)));
        const double of_divergence = static_cast<double>(*static_cast<Real*>(divergence.getFct(i)));
        const double rho_0 = static_cast<double>(water.getDensity0());
        const double rho = static_cast<double>(water.getDensity(i));
        return rho * rho / rho_0 * (of_density / (step_now * step_now) + of_divergence / step_before);
    });
}

void write_cost(const std::filesystem::path& file, const Cost& cost, SPH::FluidModel& water, double simulated) {
    const double steps = static_cast<double>(std::max<std::uint64_t>(1, cost.steps));
    std::ofstream out(file);
    out << std::setprecision(9) << "{\"engine\": \"SPlisHSPlasH " << SPLISHSPLASH_VERSION
        << "\", \"particles\": " << water.numActiveParticles() << ", \"particle_mass_kg\": " << water.getMass(0)
        << ", \"rest_density_kg_m3\": " << water.getDensity0() << ", \"steps\": " << cost.steps
        << ", \"particle_steps\": " << cost.particle_steps << ", \"simulated_s\": " << simulated
        << ", \"solver_cpu_s\": " << cost.cpu << ", \"solver_wall_s\": " << cost.wall
        << ", \"density_iterations\": " << cost.density_iterations / steps
        << ", \"divergence_iterations\": " << cost.divergence_iterations / steps
        << ", \"mean_density_error\": " << cost.mean_error / steps << ", \"max_density_error\": " << cost.max_error
        << "}\n";
    if (!out.flush()) throw std::runtime_error(file.string() + " cannot be written");
}

std::vector<std::string> simulator_arguments(const Options& options) {
    // The simulator takes relative paths from the folder of its program. Without a window it asks for a time to stop
    // at; we end the run. Its cache of boundaries is written beside the scene, where a measurement has a folder of its own.
    std::vector<std::string> words = {"splishsplash_producer",
                                      std::filesystem::absolute(options.scene).string(),
                                      "--no-gui",
                                      "--no-initial-pause",
                                      "--stopAt",
                                      "1e9",
                                      "--output-dir",
                                      std::filesystem::absolute(options.log_folder).string()};
    if (options.measure_folder.empty()) words.emplace_back("--no-cache");
    return words;
}

// The clocks run during the simulator's own time step only.
int measure(const Options& options) {
    SPH::SimulatorBase simulator;
    simulator.init(simulator_arguments(options), "splishsplash_producer");
    simulator.initSimulation();
    if (options.reproducible) sample_boundaries_regularly();
    simulator.deferredInit();
    SPH::Simulation* simulation = SPH::Simulation::getCurrent();
    auto* solver = dynamic_cast<SPH::TimeStepDFSPH*>(simulation->getTimeStep());
    if (solver == nullptr || simulation->numberOfFluidModels() != 1) {
        throw std::invalid_argument("--measure needs one fluid and simulationMethod 4 (DFSPH)");
    }
    SPH::FluidModel& water = *simulation->getFluidModel(0);
    SPH::TimeManager& clock = *SPH::TimeManager::getCurrent();
    std::filesystem::create_directories(options.measure_folder);
    std::ofstream file(options.measure_folder / "frames.bin", std::ios::binary);
    Cost cost;
    double time = 0;  // the simulator's own is a sum in single precision
    std::uint64_t frame = 0;
    while (time < options.until - 1e-6 * options.every && received_signal == 0) {
        const auto step_before = static_cast<double>(clock.getTimeStepSize());
        const double cpu = processor_time();
        const auto wall = std::chrono::steady_clock::now();
        simulator.timeStepNoGUI();
        cost.cpu += processor_time() - cpu;
        cost.wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
        time += step_before;
        ++cost.steps;
        cost.particle_steps += water.numActiveParticles();
        const auto iterations = [&](int which) {
            return solver->getValue<unsigned int>(static_cast<unsigned int>(which));
        };
        cost.density_iterations += iterations(SPH::TimeStepDFSPH::SOLVER_ITERATIONS);
        cost.divergence_iterations += iterations(SPH::TimeStepDFSPH::SOLVER_ITERATIONS_V);
        add_densities(water, cost);
        if (time >= static_cast<double>(frame + 1) * options.every - 1e-6 * options.every) {
            frame = static_cast<std::uint64_t>(time / options.every + 1e-6);
            write_frame(file, water, time, step_before, static_cast<double>(clock.getTimeStepSize()));
        }
    }
    if (!file.flush())
        throw std::runtime_error((options.measure_folder / "frames.bin").string() + " cannot be written");
    write_cost(options.measure_folder / "cost.json", cost, water, time);
    simulator.cleanup();
    return received_signal == 0 ? 0 : 128 + received_signal;
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

    simulator.init(simulator_arguments(options), "splishsplash_producer");
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
        return options.measure_folder.empty() ? run(options) : measure(options);
    } catch (const std::invalid_argument& error) {
        std::cerr << "splishsplash_producer: " << error.what() << '\n' << usage;
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "splishsplash_producer: " << error.what() << '\n';
        return 1;
    }
}
