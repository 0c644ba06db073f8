// fluid_server SCENE.json: computes the water of a scene and sends it, frame by frame, to the programs in its session.

#include <omp.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "configs/checks/scene_checks.hpp"
#include "configs/program/command_line.hpp"
#include "configs/program/memory.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/program/program.hpp"
#include "fluid_server/make_model.hpp"
#include "fluid_server/model_choice/model_choice.hpp"
#include "fluid_server/neighbours/sweeps.hpp"
#include "fluid_server/ranks.hpp"
#include "fluid_server/server/serve.hpp"
#include "shm_protocol/error.hpp"

namespace {

using namespace wade;
using namespace wade::fluid;

ProgramDescription description() {
    return {
        "fluid_server",
        "Computes the water of a scene and sends it to a crowd.\n"
        "SIGUSR1 or an empty line on the terminal: pause or resume. SIGUSR2 or the line \"step [N]\": one more frame, "
        "then pause. \"quit\": end.\n"
        "With /fluid/model \"auto\" it chooses the model: --check says what and why, --print-config prints the scene "
        "as "
        "written, and a run writes it as chosen into --out, scene_as_chosen.json, which repeats the run without a "
        "choice.",
        server_options(), "none: no log; what a failure leaves goes here"};
}

// A scene prepared for its run. A run and --check call the same prepare(), so that --check prints all that a run would.
struct Prepared {
    std::vector<std::string> lines;  // what was chosen and why, and where the water goes on from
    Estimate estimate;
    std::unique_ptr<fluid::FluidModel> model;
};

// Replaces a scene with the model "auto" by the scene with the chosen model. Throws ConfigurationError if the scene
// cannot run; checks the memory before it allocates any. ranks: null, or the ranks that the water is spread over.
Prepared prepare(ProgramStart& start, Ranks* ranks) {
    Prepared prepared;
    const RunOptions& options = start.options;
    for (const std::string& warning : start.loaded.warnings) prepared.lines.push_back("warning: " + warning);
    if (ranks != nullptr && model_choice::is_open(start.loaded.scene)) {
        throw ConfigurationError(options.scene_file.string() +
                                 ": /fluid/model is auto; allowed over ranks: shallow_water");
    }
    if (model_choice::is_open(start.loaded.scene)) {
        model_choice::ModelChoice choice = model_choice::choose_model(start.loaded, options.scene_file.string());
        start.loaded = std::move(choice.scene);
        prepared.lines.insert(prepared.lines.end(), choice.lines.begin(), choice.lines.end());
        if (options.out && !options.check) {
            prepared.lines.push_back("the scene as chosen: " +
                                     model_choice::write_chosen(start.loaded, *options.out).string());
        }
    }
    const Scene& scene = start.loaded.scene;
    prepared.estimate = estimate(scene);
    check_memory(prepared.estimate.memory, available_memory(),
                 options.scene_file.string() + ": the water (" + text_of(prepared.estimate) + ")",
                 "lower /fluid/max_particles, or take larger particles, larger cells or a smaller channel");
    for (const std::string& gap : narrow_gaps(scene)) prepared.lines.push_back("warning: " + gap);
    for (const std::string& warning : rate_warnings(scene)) prepared.lines.push_back("warning: " + warning);
    prepared.model = make_fluid_model(scene);
    for (const std::string& line : prepare_states(*prepared.model, options)) prepared.lines.push_back(line);
    if (ranks == nullptr) return prepared;
    prepared.model->spread_over(*ranks);
    prepared.lines.push_back("over " + std::to_string(ranks->count()) + " ranks of MPI");
    return prepared;
}

void answer(ProgramStart& start, Ranks* ranks) {
    std::vector<std::string> lines;
    if (start.options.check) {
        const Prepared prepared = prepare(start, ranks);
        lines = prepared.lines;
        lines.push_back("the water: " + text_of(prepared.estimate));
    }
    std::cout << *start.answer;
    for (const std::string& line : lines) std::cout << line << '\n';
}

// Returns the exit code of an error before any consumer could join, else 0; later errors pass through.
int run(ProgramStart& start, Console& console, Ranks* ranks) {
    if (start.options.threads > 0) omp_set_num_threads(start.options.threads);
    Prepared prepared;
    try {
        if (start.options.out) console.copy_to(*start.options.out / "fluid_server.log");
        prepared = prepare(start, ranks);
    } catch (const std::exception& error) {
        const int code = exit_code_of<shm::Error>(error);
        console.line(error.what());
        tell_waiting_crowd(start, code, error.what());
        return code;
    }
    for (const std::string& line : prepared.lines) console.line(line);
    serve(start, *prepared.model, console);
    return 0;
}

#ifdef WADE_RANKS
// What ranks beyond the first do: frame by frame what the first one does, which alone has a session and says what fails.
void follow(int argc, char** argv, Ranks& ranks) {
    // mpirun sends it to all when a rank has died, and kills later: meanwhile the first rank can see which one it was.
    std::signal(SIGTERM, SIG_IGN);
    Prepared prepared;
    std::array<std::uint64_t, 3> said{};
    try {
        ProgramStart start = start_program(description(), argc, argv);
        if (start.options.threads > 0) omp_set_num_threads(start.options.threads);
        if (!start.answer || start.options.check) prepared = prepare(start, &ranks);
        while (ranks.hear(said)) prepared.model->advance_frame({said[0], said[1], said[2]});
    } catch (const RunError&) {  // as the first rank's
        while (ranks.hear(said)) {
        }
    }
}
#endif

int lead(int argc, char** argv, Ranks* ranks) {
    Console console("fluid_server");
    try {
        ProgramStart start = start_program(description(), argc, argv);
        if (start.answer) {
            answer(start, ranks);
            return 0;
        }
        catch_signals();
        return run(start, console, ranks);
    } catch (const std::exception& error) {
        console.line(error.what());
        return exit_code_of<shm::Error>(error);
    }
}

}  // namespace

int main(int argc, char** argv) {
    let_threads_spin_briefly(argv);
    if (std::getenv("WADE_NARROW_VECTORS") != nullptr) use_widest_vectors(false);
#ifdef WADE_RANKS
    const std::unique_ptr<Ranks> ranks = join_ranks();
    int code = 0;
    ranks->first() ? static_cast<void>(code = lead(argc, argv, ranks.get())) : follow(argc, argv, *ranks);
    ranks->leave(code);
    return code;
#else
    return lead(argc, argv, nullptr);
#endif
}
