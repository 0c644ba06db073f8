// bench_coupling: what a frame costs on its way from the solver to the agents, beside the solver and the crowd's step.
//
// A river of 100 x 27 x 1 m with all agents in it, the worst case: every particle is near an agent.

#include <omp.h>

#include <string>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water/water_view.hpp"
#include "fluid_server/dfsph/dfsph_model.hpp"
#include "shm_protocol/inside/bytes/hash.hpp"
#include "tests/bench/bench_options.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/scenes.hpp"

namespace {

using namespace wade;
using namespace wade::bench;

struct Size {
    std::uint64_t particles;
    int columns, rows;  // of agents
    double warm_up;     // s
    int frames;
};

// A frame as it lies in shared memory.
struct Slot {
    std::vector<float> mass, vx, vy, vz, px, py, pz;

    explicit Slot(std::size_t n) : mass(n), vx(n), vy(n), vz(n), px(n), py(n), pz(n) {}
    shm::FrameFields fields() { return {1, mass, vx, vy, vz, px, py, pz, {}, {}, {}, {}, {}, {}, {}}; }
    [[nodiscard]] std::vector<std::span<const float>> arrays(std::size_t n) const {
        std::vector<std::span<const float>> all;
        for (const auto* a : {&mass, &vx, &vy, &vz, &px, &py, &pz}) all.emplace_back(a->data(), n);
        return all;
    }
    [[nodiscard]] crowd::WaterView view(std::size_t n) const {
        crowd::WaterView view;
        const auto all = arrays(n);
        view.mass = all[0], view.vx = all[1], view.vy = all[2], view.vz = all[3];
        view.px = all[4], view.py = all[5], view.pz = all[6];
        return view;
    }
};

// Milliseconds of each stage, one value a frame.
struct Stages {
    std::vector<double> solver, write, hash, bins, contacts, met, step;
};

// Processor time, so that other programs of the machine do not count: that of this thread for what runs in one.
template <typename Body>
void timed(std::vector<double>& series, Body&& body) {
    const double start = own_seconds();
    body();
    series.push_back(1e3 * (own_seconds() - start));
}

// That of all threads over their number, which is the wall time where each has a processor.
template <typename Body>
void timed_in_parallel(std::vector<double>& series, int threads, Body&& body) {
    const double start = cpu_seconds();
    body();
    series.push_back(1e3 * (cpu_seconds() - start) / threads);
}

void measure(const Size& size, int threads, fluid::DfsphModel& model, crowd::CrowdWorld& crowd, Slot& slot,
             std::uint64_t& frame, int frames, Stages& stages) {
    omp_set_num_threads(threads);
    volatile std::uint64_t sink = 0;
    for (int f = 0; f < frames; ++f, ++frame) {
        timed_in_parallel(stages.solver, threads, [&] { model.advance_frame({frame, frame + 1, 30}); });
        timed_in_parallel(stages.write, threads, [&] { model.write_frame(slot.fields()); });
        const crowd::WaterView water = slot.view(size.particles);
        timed(stages.hash, [&] { sink = shm::chain_hash(1, frame, slot.arrays(size.particles)); });
        // The parts once more by themselves; the step holds them, too.
        std::vector<Eigen::Vector2d> places;
        for (const std::uint32_t id : crowd.active) places.push_back(crowd.agents.position[id]);
        const double distance = crowd::contact_distance(crowd.scene.coupling);
        timed(stages.bins, [&] { crowd::bin_water(crowd.water, water, places); });
        timed(stages.contacts, [&] {
            crowd.contacts.resize(places.size());
            for (std::size_t k = 0; k < places.size(); ++k)
                crowd.contacts[k] = crowd::find_contact(crowd.water, places[k], distance, crowd.touching);
        });
        timed(stages.met, [&] {
            double sum = 0;
            for (const auto& place : places) sum += crowd::water_at(crowd.water, place, 1000).depth;
            sink = static_cast<std::uint64_t>(sum);
        });
        timed(stages.step, [&] { crowd::step(crowd, water); });
    }
    static_cast<void>(sink);
}

Result result_of_stages(const Size& size, int threads, Stages stages) {
    std::vector<double> coupling;
    for (std::size_t f = 0; f < stages.bins.size(); ++f)
        coupling.push_back(stages.bins[f] + stages.contacts[f] + stages.met[f]);
    Result r = result_of("coupling/contacts", size.particles, threads, coupling, "ms_per_frame");
    const auto median = [](std::vector<double>& v) { return quantile(v, 0.5); };
    const double solver = median(stages.solver), step = median(stages.step), bins = median(stages.bins);
    const double each = median(stages.contacts) + median(stages.met);
    const auto particles = static_cast<double>(size.particles), agents = size.columns * 1.0 * size.rows;
    r.extra = {{"agents", agents},
               {"percent_of_frame", 100 * r.median / (solver + step)},
               {"bins_ns_per_particle", 1e6 * bins / particles},
               {"contacts_ns_per_agent", 1e6 * median(stages.contacts) / agents},
               {"water_met_ns_per_agent", 1e6 * median(stages.met) / agents},
               {"bins_ms", bins},
               {"contacts_ms", each},
               {"solver_ms", solver},
               {"crowd_step_ms", step},
               {"write_frame_ms", median(stages.write)},
               {"write_frame_percent_of_solver", 100 * median(stages.write) / solver},
               {"hash_ms", median(stages.hash)}};
    return r;
}

void bench(const Size& size, const Options& options, std::vector<Result>& results) {
    const Scene scene = river_with_crowd(size.particles, size.columns, size.rows);
    fluid::DfsphModel model(scene);
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    Slot slot(model.capacity());
    std::uint64_t frame = 0;
    for (; frame < static_cast<std::uint64_t>(30 * size.warm_up); ++frame) model.advance_frame({frame, frame + 1, 30});
    for (const int threads : options.thread_counts()) {
        Stages stages;
        measure(size, threads, model, crowd, slot, frame, options.quick ? std::min(size.frames, 15) : size.frames,
                stages);
        results.push_back(result_of_stages(size, threads, std::move(stages)));
        print(results.back());
    }
}

void run(const Options& options, std::vector<Result>& results) {
    if (!options.wanted("coupling/contacts")) return;
    bench({21'600, 10, 5, 1, 60}, options, results);
    bench({100'000, 100, 50, 0.5, 30}, options, results);
    if (!options.quick) bench({1'000'000, 100, 50, 0, 5}, options, results);
}

}  // namespace

int main(int argc, char** argv) {
    return run_program("bench_coupling", argc, argv, run);
}
