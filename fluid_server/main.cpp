// fluid_server SCENE.json: simulates the water of a scene and sends it, frame by frame, to those who joined its
// session.

#include <omp.h>

#include <chrono>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "configs/command_line.hpp"
#include "configs/exit_code.hpp"
#include "configs/program.hpp"
#include "fluid_server/fluid_world.hpp"
#include "fluid_server/run_server.hpp"

namespace {

using namespace wade;
using namespace wade::fluid;

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
    char buffer[512];
    std::va_list values;
    va_start(values, format);
    std::vsnprintf(buffer, sizeof buffer, format, values);
    va_end(values);
    return buffer;
}

std::string progress_line(const FluidWorld& world, const ServerSummary& summary, const shm::Diagnostics& d,
                          double wall) {
    const double time = static_cast<double>(summary.frames) / world.scene().frame_rate;
    const double rate = time / wall;
    return print(
        "t %.1f s  step %llu  dt %.4f s  %zu particles  density error %.3f %% (max %.2f %%)  iterations %u+%u  "
        "depth %.2f m  %.2f m/s  %.1f x real time  ETA %.0f s",
        time, static_cast<unsigned long long>(summary.steps), d.last_dt_s, world.particles().count,
        100 * d.mean_density_error, 100 * d.max_density_error, d.divergence_iterations, d.density_iterations,
        d.mean_depth_m, d.mean_speed_m_s, rate, (world.scene().duration - time) / rate);
}

std::string summary_text(const FluidWorld& world, const ServerSummary& summary, double wall) {
    const double time = static_cast<double>(summary.frames) / world.scene().frame_rate;
    std::string text = print(
        "%llu frames, %.1f simulated s in %.1f s of wall time (%.2f x real time; solver alone %.1f s, %.2f M "
        "particle-steps/s)",
        static_cast<unsigned long long>(summary.frames), time, wall, time / wall, summary.solver_time,
        1e-6 * static_cast<double>(summary.particle_steps) / summary.solver_time);
    if (world.scene().channel.flow == Flow::recirculating) {
        text += print("; mean driving acceleration %.2e m/s2", summary.driving_impulse / time);
    }
    if (world.recycled() > 0) {
        text += print("; %llu particles recycled", static_cast<unsigned long long>(world.recycled()));
    }
    if (world.position_clamps() > 0) {
        text += print("; %llu position clamps", static_cast<unsigned long long>(world.position_clamps()));
    }
    if (world.layers_missed() > 0) {
        text += print("; warning: the stock was empty for %llu layers of the emitter, raise fluid.max_particles",
                      static_cast<unsigned long long>(world.layers_missed()));
    }
    return text;
}

shm::Waiting waiting_of(const RunOptions& options, Console& console) {
    shm::Waiting waiting;
    waiting.attach_timeout_s = options.attach_timeout;
    waiting.step_timeout_s = options.step_timeout;
    waiting.interrupted = [] { return received_signal() != 0; };
    waiting.warn = [&console](const std::string& text) { console.warning(text); };
    return waiting;
}

void run_scene(const ProgramStart& start, Console& console) {
    const Scene& scene = start.loaded.scene;
    if (start.options.threads > 0) {
        omp_set_num_threads(start.options.threads);
    }
    if (start.options.out) {
        console.copy_to(*start.options.out / "fluid_server.log");
    }
    shm::Publisher publisher(start.options.session, stream_info(scene), waiting_of(start.options, console));
    FluidWorld world(scene);
    console.line("session '" + start.options.session + "', scene '" + scene.name + "', " +
                 std::to_string(omp_get_max_threads()) + " threads; waiting for a crowd");
    const auto begin = std::chrono::steady_clock::now();
    const auto wall = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
    ServerSummary summary;
    run_server(
        world, publisher, summary,
        [&](const shm::Diagnostics& diagnostics) {
            if (console.progress_due(static_cast<double>(summary.frames) / scene.frame_rate)) {
                console.progress(progress_line(world, summary, diagnostics, wall()));
            }
        },
        received_signal);
    console.line(summary_text(world, summary, wall()));
}

int exit_code_of(const std::exception& error) {
    if (const auto* run = dynamic_cast<const RunError*>(&error)) {
        return static_cast<int>(run->code());
    }
    if (const auto* peer = dynamic_cast<const shm::Error*>(&error)) {
        return peer->failure() == shm::Failure::interrupted ? exit_code_of_signal() : peer->exit_code();
    }
    const bool usage = dynamic_cast<const std::invalid_argument*>(&error) != nullptr;
    return static_cast<int>(usage ? ExitCode::bad_configuration : ExitCode::unexpected);
}

}  // namespace

int main(int argc, char** argv) {
    let_threads_wait_passively(argv);
    Console console("fluid_server");
    try {
        const ProgramStart start =
            start_program({"fluid_server", "Simulates the water of a scene and sends it to a crowd."}, argc, argv);
        if (start.answer) {
            std::cout << *start.answer;
            return 0;
        }
        catch_signals();
        run_scene(start, console);
        return 0;
    } catch (const std::exception& error) {
        console.line(error.what());
        return exit_code_of(error);
    }
}
