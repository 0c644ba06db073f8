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
#include "configs/peer_support.hpp"
#include "configs/program.hpp"
#include "configs/scene_frames.hpp"
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
    std::string text = print("t %.1f s  step %llu  dt %.4f s  %zu particles", time,
                             static_cast<unsigned long long>(summary.steps), d.last_dt_s, world.particles().count);
    text += print("  density error %.3f %% (max %.2f %%)  iterations %u+%u", 100 * d.mean_density_error,
                  100 * d.max_density_error, d.divergence_iterations, d.density_iterations);
    // A dry river has neither.
    if (!std::isnan(d.mean_depth_m)) {
        text += print("  depth %.2f m", d.mean_depth_m);
    }
    if (!std::isnan(d.mean_speed_m_s)) {
        text += print("  %.2f m/s", d.mean_speed_m_s);
    }
    return text + print("  %.1f x real time  ETA %.0f s", rate, (world.scene().duration - time) / rate);
}

std::string summary_text(const FluidWorld& world, const ServerSummary& summary, double wall) {
    if (summary.frames == 0) {
        return print("no frame simulated in %.1f s of wall time", wall);
    }
    const double time = static_cast<double>(summary.frames) / world.scene().frame_rate;
    std::string text = print(
        "%llu frames, %.1f simulated s in %.1f s of wall time (%.2f x real time; solver alone %.1f s, %.2f M "
        "particle-steps/s)",
        static_cast<unsigned long long>(summary.frames), time, wall, time / wall, summary.solver_time,
        1e-6 * static_cast<double>(summary.particle_steps) / summary.solver_time);
    if (summary.resident_bytes > 0) {
        text += print("; memory %.0f MB", 1e-6 * static_cast<double>(summary.resident_bytes));
    }
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
    if (summary.crowd_left) {
        text += print("; the crowd said goodbye before frame %llu of %llu was sent",
                      static_cast<unsigned long long>(summary.frames),
                      static_cast<unsigned long long>(frames_of(world.scene())));
    }
    return text;
}

void run_scene(const ProgramStart& start, Console& console) {
    const Scene& scene = start.loaded.scene;
    if (start.options.threads > 0) {
        omp_set_num_threads(start.options.threads);
    }
    if (start.options.out) {
        console.copy_to(*start.options.out / "fluid_server.log");
    }
    shm::Publisher publisher(start.options.session, stream_info(scene),
                             waiting_of<shm::Waiting>(start.options, console));
    FluidWorld world(scene);
    console.line("session '" + start.options.session + "', scene '" + scene.name + "', " +
                 std::to_string(omp_get_max_threads()) + " threads; waiting for a crowd");
    const auto begin = std::chrono::steady_clock::now();
    const auto wall = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
    ServerSummary summary;
    const auto on_frame = [&](const shm::Diagnostics& diagnostics) {
        if (console.progress_due(static_cast<double>(summary.frames) / scene.frame_rate)) {
            console.progress(progress_line(world, summary, diagnostics, wall()));
        }
    };
    try {
        run_server(world, publisher, summary, on_frame, received_signal);
    } catch (const std::exception&) {
        console.line(summary_text(world, summary, wall()));
        throw;
    }
    console.line(summary_text(world, summary, wall()));
}

}  // namespace

int main(int argc, char** argv) {
    let_threads_spin_briefly(argv);
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
        return exit_code_of<shm::Error>(error);
    }
}
