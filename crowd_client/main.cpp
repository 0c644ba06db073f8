// crowd_client SCENE.json: walks the crowd of a scene through the water that a fluid server sends.

#include <exception>
#include <iostream>

#include "configs/program/command_line.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/program/program.hpp"
#include "crowd_client/session/run_party.hpp"
#include "shm_protocol/error.hpp"
#include "shm_protocol/layout.hpp"

namespace {

using namespace wade;

ProgramDescription description() {
    return {
        "crowd_client",
        "Walks the crowd of a scene through the water that a fluid server sends.",
        {{.name = "--water-every-s",
          .help = "Simulated time between two stored pictures of the water, s; 0: none",
          .number = NumberRange{0, 1e6},
          .preset = 5},
         {.name = "--danger-every-s",
          .help = "Simulated time over which the water is averaged for the danger levels of the paper's Table 2, s: a "
                  "map in danger.csv, more columns in agents.csv; 0: none",
          .number = NumberRange{0, 1e6},
          .preset = 0},
         {.name = "--terms-every-s",
          .help =
              "Simulated time between two rows of what moves each person, the terms of Eq. 5 to 9 and of the body, in "
              "terms.csv, s; 0: none",
          .number = NumberRange{0, 1e6},
          .preset = 0},
         {.name = "--no-trajectories",
          .help = "Write no trajectories.sqlite, for many runs of which only the end counts"},
         {.name = "--step-times", .help = "Say at the end how long each stage of a step took"},
         {.name = "--crowds",
          .help =
              "Many crowds in the water of one server: a JSON list of { \"name\": ..., \"set\": { pointer: value } }; "
              "each walks as if alone, into DIR/<name>/, and DIR/crowds.csv sums up (see docs/commands.md)",
          .word = Word{"FILE"}},
         {.name = "--mode",
          .help = "lockstep: every frame, and the producer waits for the crowd. latest: the newest frame, and the "
                  "producer never waits; frames may be dropped, so that two runs differ",
          .word = Word{"MODE", "lockstep", {"lockstep", "latest"}}},
         {.name = "--agents-consumers",
          .help = "With /coupling/agents_stream: consumers that the way back waits for, the water among them; 2 leaves "
                  "room for a recorder of the agents",
          .number = NumberRange{1, shm::max_consumers, true},
          .preset = 1},
         {.name = "--commands",
          .help = "Where lines with commands come from: pause, resume, step [N] (N frames of water), tau VALUE "
                  "[agent ID | group NAME], quit, an empty line to pause or resume. PLACE: a FIFO, made if it is "
                  "absent; -: stdin [the terminal, if stdin is one]. SIGUSR1 pauses or resumes, SIGUSR2 does one "
                  "frame",
          .word = Word{"PLACE"}}}};
}

}  // namespace

int main(int argc, char** argv) {
    Console console("crowd_client");
    try {
        const ProgramStart start = start_program(description(), argc, argv);
        if (start.answer) {
            const std::string more = start.options.check ? crowd::check_party(start) : "";
            std::cout << *start.answer << more;
            return 0;
        }
        if (!start.options.word("--crowds").empty()) let_threads_spin_briefly(argv);
        catch_signals();
        return crowd::run_party(start, console);
    } catch (const std::exception& error) {
        console.line(error.what());
        return exit_code_of<shm::Error>(error);
    }
}
