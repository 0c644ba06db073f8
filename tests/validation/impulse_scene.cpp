// Runs any scene, water and crowd in one process, and writes what the water did to those who stand. A scene whose model is
// "auto" is run as chosen.

#include <omp.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "configs/command_line.hpp"
#include "configs/exit_code.hpp"
#include "fluid_server/model_choice/model_choice.hpp"
#include "impulse.hpp"
#include "run.hpp"

namespace {

using namespace wade;
using namespace wade::validation;
using Json = nlohmann::ordered_json;

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
        std::cout << document.dump(1) << '\n';
        return;
    }
    const std::filesystem::path part = file + ".part";
    std::ofstream out(part);
    out << document.dump(1) << '\n';
    out.close();
    if (!out) throw RunError(ExitCode::unexpected, "cannot write " + file + ": is the disk full?");
    std::filesystem::rename(part, file);
}

Json choice_of(const fluid::model_choice::ModelChoice& choice) {
    Json document{{"chosen", fluid::model_choice::label(choice.chosen)},
                  {"kind", fluid::model_choice::name_of(choice.chosen.worst)},
                  {"estimated_median", choice.chosen.median},
                  {"estimated_p95", choice.chosen.p95},
                  {"went_up", choice.went_up},
                  {"lines", choice.lines}};
    if (choice.pilot) {
        document["pilot"] = {{"difference", choice.pilot->difference},
                             {"allowed", choice.pilot->allowed},
                             {"particle_steps", choice.pilot->particle_steps}};
    }
    return document;
}

void run_scene(const ProgramStart& start) {
    if (start.options.threads > 0) omp_set_num_threads(start.options.threads);
    Scene scene = start.loaded.scene;
    Json chosen;
    const double cpu = process_cpu_time();
    if (fluid::model_choice::is_open(scene)) {
        const auto choice = fluid::model_choice::choose_model(start.loaded, start.options.scene_file.string());
        scene = choice.scene.scene;
        chosen = choice_of(choice);
        chosen["cpu_s"] = process_cpu_time() - cpu;
    }
    Result result;
    const ImpulseRun run = run_impulse(scene, result);
    Json document = document_of(scene, result, run);
    if (!chosen.is_null()) document["choice"] = chosen;
    write(document, start.options.word("--write"));
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
