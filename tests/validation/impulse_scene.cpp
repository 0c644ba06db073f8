// Runs any scene, water and crowd in one process, and writes the impulse on each standing agent.

#include <omp.h>

#include <fstream>
#include <iostream>

#include "configs/errors/exit_code.hpp"
#include "configs/json/json.hpp"
#include "configs/program/command_line.hpp"
#include "impulse.hpp"
#include "run.hpp"

namespace {

using namespace wade;
using namespace wade::validation;
ProgramDescription description() {
    return {
        "impulse_scene",
        "Runs a scene, water and crowd in one process, and writes the impulse on each agent who stands (desired speed "
        "0 and tau 0) as JSON.",
        {{.name = "--write", .help = "File to write; none: standard output", .word = Word{"FILE"}}}};
}

Json document_of(const Scene& scene, const Result& result, const ImpulseRun& run) {
    Json standing = Json::array();
    for (const StandingAgent& agent : run.standing) {
        standing.push_back({agent.id, agent.impulse.x(), agent.impulse.y(), agent.load});
    }
    return {{"scene", scene.name},
            {"model", result.model},
            {"particles", result.particles},
            {"steps", result.steps},
            {"particle_steps", result.particle_steps},
            {"simulated_s", result.simulated_time},
            {"solver_cpu_s", result.solver_cpu_time},
            {"standing_columns", {"agent", "impulse_x_kg_m", "impulse_z_kg_m", "load_kg_m"}},
            {"standing", standing}};
}

void write(const Json& document, const std::string& file) {
    if (file.empty()) {
        std::cout << document.dump({.indent = 1}) << '\n';
        return;
    }
    const std::filesystem::path part = file + ".part";
    std::ofstream out(part);
    out << document.dump({.indent = 1}) << '\n';
    out.close();
    if (!out) throw RunError(ExitCode::unexpected, "cannot write " + file + ": is the disk full?");
    std::filesystem::rename(part, file);
}

void run_scene(const ProgramStart& start) {
    if (start.options.threads > 0) omp_set_num_threads(start.options.threads);
    Result result;
    const ImpulseRun run = run_impulse(start.loaded.scene, result);
    write(document_of(start.loaded.scene, result, run), start.options.word("--write"));
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const ProgramStart start = start_program(description(), argc, argv);
        if (start.answer) {
            std::cout << *start.answer;
            return 0;
        }
        run_scene(start);
        return 0;
    } catch (const RunError& error) {
        std::cerr << "impulse_scene: " << error.what() << '\n';
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        std::cerr << "impulse_scene: " << error.what() << '\n';
        return 1;
    }
}
