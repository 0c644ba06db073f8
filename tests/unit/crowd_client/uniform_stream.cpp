// uniform_stream SCENE.json: a producer of a uniform stream in the scene's channel, to look at the crowd without a
// solver.
//
// Rows of particles of the channel's depth move at v_F along -x; with a dry start the front comes in from x.hi. Each
// particle stays in its column, so the frames cost nothing to compute.

#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>

#include "configs/errors/exit_code.hpp"
#include "configs/program/command_line.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "shm_protocol/publisher.hpp"

namespace {

using namespace wade;

struct Lattice {
    double d = 0;
    int columns = 0, rows = 0, layers = 0;
};

Lattice lattice_of(const Scene& scene) {
    const double d = scene.fluid->particle_spacing;
    const auto count = [d](double length) { return std::max(1, static_cast<int>(std::lround(length / d))); };
    return {d, count(scene.channel->x.length()), count(scene.channel->z.length()), count(scene.channel->depth)};
}

std::uint32_t fill(const shm::FrameFields& fields, const Scene& scene, const Lattice& lattice, double time) {
    const Channel& channel = scene.channel;
    const double way = channel.velocity * time;
    const bool dry = channel.initial_river == InitialRiver::dry;
    const double front = dry ? channel.x.hi - way : channel.x.lo;
    const double row_pitch = channel.z.length() / lattice.rows;
    const double layer_pitch = channel.depth / lattice.layers;
    const double mass = scene.fluid->rest_density * lattice.d * row_pitch * layer_pitch;
    std::uint32_t n = 0;
    for (int i = 0; i < lattice.columns; ++i) {
        // Columns are shifted by the displacement modulo the spacing; each keeps to its own length of the channel.
        const double x = channel.x.hi - (i + 1) * lattice.d + lattice.d - std::fmod(way, lattice.d);
        if (x < front || x < channel.x.lo) continue;
        for (int j = 0; j < lattice.rows; ++j) {
            for (int k = 0; k < lattice.layers; ++k, ++n) {
                fields.mass[n] = static_cast<float>(mass);
                fields.vx[n] = static_cast<float>(-channel.velocity);
                fields.vy[n] = 0;
                fields.vz[n] = 0;
                fields.px[n] = static_cast<float>(x);
                fields.py[n] = static_cast<float>((k + 0.5) * layer_pitch);
                fields.pz[n] = static_cast<float>(channel.z.lo + (j + 0.5) * row_pitch);
            }
        }
    }
    return n;
}

void produce(const ProgramStart& start) {
    const Scene& scene = start.loaded.scene;
    const Lattice lattice = lattice_of(scene);
    shm::StreamInfo info;
    info.producer_name = "uniform_stream";
    info.capacity = static_cast<std::uint32_t>(lattice.columns * lattice.rows * lattice.layers);
    info.depth = static_cast<std::uint32_t>(scene.lockstep_depth);
    // Nanoseconds carry any frame rate.
    info.ticks_per_second = 1'000'000'000;
    info.ticks_per_frame = static_cast<std::uint64_t>(std::llround(1e9 / scene.frame_rate));
    info.scene_hash = scene.hash;
    shm::Waiting waiting;
    waiting.attach_timeout_s = start.options.attach_timeout;
    waiting.step_timeout_s = start.options.step_timeout;
    shm::Publisher publisher(start.options.session, info, waiting);
    publisher.wait_for_consumers(1);
    const auto frames = static_cast<std::uint64_t>(std::llround(scene.duration * scene.frame_rate));
    for (std::uint64_t f = 1; f <= frames; ++f) {
        const auto fields = publisher.begin_frame();
        if (!fields) break;
        const std::uint32_t count = fill(*fields, scene, lattice, static_cast<double>(f) / scene.frame_rate);
        shm::Diagnostics diagnostics;
        diagnostics.mean_depth_m = scene.channel->depth;
        diagnostics.mean_speed_m_s = scene.channel->velocity;
        publisher.end_frame(count, diagnostics, f == frames);
    }
    publisher.close();
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const ProgramStart start =
            start_program({"uniform_stream", "Sends a uniform stream, without a solver."}, argc, argv);
        if (start.answer) {
            std::cout << *start.answer;
            return 0;
        }
        produce(start);
        return 0;
    } catch (const RunError& error) {
        std::cerr << "uniform_stream: " << error.what() << '\n';
        return static_cast<int>(error.code());
    } catch (const shm::Error& error) {
        std::cerr << "uniform_stream: " << error.what() << '\n';
        return error.exit_code();
    } catch (const std::exception& error) {
        std::cerr << "uniform_stream: " << error.what() << '\n';
        return 1;
    }
}
