// bench_coupling: the cost of a frame between the solver and the agents, beside the solver and the crowd's step.
//
// A river of 100 x 27 x 1 m with all agents in it, the worst case: every particle is near an agent. Also the cost of
// the body response (`measured`) and of the momentum exchange with the water (two_way).

#include <omp.h>

#include <functional>
#include <string>

#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water/water_view.hpp"
#include "fluid_server/dfsph/dfsph_model.hpp"
#include "fluid_server/people/pushes.hpp"
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

// The same people with three responses to the same water; only the last one exchanges momentum with it.
struct Answers {
    crowd::CrowdWorld paper, measured, two_way;

    explicit Answers(const std::function<Scene(const std::string& response, const std::string& pushes)>& scene_with)
        : paper(crowd::make_crowd(scene_with("paper", "false"))),
          measured(crowd::make_crowd(scene_with("measured", "false"))),
          two_way(crowd::make_crowd(scene_with("measured", "true"))) {}
};

// Passes the impulse that people got in the last step to the water, which loses it.
void hand_over(const crowd::CrowdWorld& crowd, std::vector<crowd::Vector2d>& before, fluid::PeopleInWater& people) {
    people.pushes.clear();
    before.resize(crowd.agents.size(), crowd::Vector2d::Zero());
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
        const crowd::Vector2d impulse = crowd.pushing->given[id] - before[id];
        before[id] = crowd.pushing->given[id];
        if (impulse.isZero(0)) continue;
        const auto &place = crowd.agents.position[id], &velocity = crowd.agents.velocity[id];
        people.pushes.push_back({{place.x(), place.y()},
                                 {velocity.x(), velocity.y()},
                                 {impulse.x(), impulse.y()},
                                 crowd.pushing->submerged[id],
                                 crowd.feeling->spread});
    }
}

// 5,000 people, waist-deep and braced against 0.8 m/s, so that they stay on their feet.
void bench_people(const Options& options, std::vector<Result>& results) {
    constexpr std::uint64_t particles = 100'000;
    const auto scene_with = [&](const std::string& response, const std::string& pushes) {
        return river_with_crowd(
            particles, 100, 50,
            {{"/crowd/response", response}, {"/coupling/two_way", pushes}, {"/channel/velocity_m_s", "0.8"}},
            response == "paper" ? R"("tau": 0.2)" : R"("skill": "braced")");
    };
    const Scene scene = scene_with("measured", "true");
    const int frames = options.quick ? 15 : 45;
    for (const int threads : options.thread_counts()) {
        omp_set_num_threads(threads);
        fluid::FluidWorld water(scene);
        fluid::PeopleInWater people;
        const auto bed = fluid::bed_facets(scene.channel);
        const double spacing = scene.fluid->particle_spacing, mass = static_cast<double>(water.particle_mass());
        double pushing_s = 0;
        water.push_with([&](const fluid::CellGrid& grid, fluid::Particles& p, double duration, double gain) {
            const double start = cpu_seconds();
            fluid::push_particles(people, 30 * duration, gain, grid, fluid::ground_of_bed(bed), spacing, mass, p);
            pushing_s += cpu_seconds() - start;
        });
        Answers crowds(scene_with);
        for (crowd::CrowdWorld* c : {&crowds.paper, &crowds.measured, &crowds.two_way}) c->threads = threads;
        std::vector<crowd::Vector2d> before;
        std::vector<double> share, solver, pushing, paper, measured, two_way, ratio;
        for (int f = 0; f < frames; ++f) {
            hand_over(crowds.two_way, before, people);
            pushing_s = 0;
            timed_in_parallel(solver, threads, [&] {
                for (double left = 1.0 / 30; left > 1e-9;) left -= water.step(left).dt;
            });
            pushing.push_back(1e3 * pushing_s / threads);
            const fluid::Particles& p = water.particles();
            const std::vector<float> masses(p.count, water.particle_mass());
            const auto some = [&](const std::vector<float>& v) { return std::span<const float>(v).first(p.count); };
            crowd::WaterView view;
            view.mass = masses, view.px = some(p.x), view.py = some(p.y), view.pz = some(p.z);
            view.vx = some(p.vx), view.vy = some(p.vy), view.vz = some(p.vz);
            timed_in_parallel(paper, threads, [&] { crowd::step(crowds.paper, view); });
            timed_in_parallel(measured, threads, [&] { crowd::step(crowds.measured, view); });
            timed_in_parallel(two_way, threads, [&] { crowd::step(crowds.two_way, view); });
            ratio.push_back(measured.back() / paper.back());
            const double more = pushing.back() + two_way.back() - measured.back();
            share.push_back(100 * more / (solver.back() - pushing.back() + measured.back()));
        }
        const auto median = [](std::vector<double>& v) { return quantile(v, 0.5); };
        const std::uint64_t size = water.particles().count;
        const auto agents = static_cast<double>(crowds.two_way.active.size());
        Result cost = result_of("coupling/two_way", size, threads, share, "percent_of_frame");
        cost.extra = {{"agents", agents},
                      {"solver_ms", median(solver)},
                      {"pushing_ms", median(pushing)},
                      {"crowd_step_ms", median(two_way)},
                      {"one_way_crowd_step_ms", median(measured)}};
        Result bodies = result_of("coupling/measured", size, threads, ratio, "times_paper");
        bodies.extra = {{"agents", agents}, {"paper_crowd_step_ms", median(paper)}};
        for (Result* result : {&cost, &bodies}) {
            print(*result);
            results.push_back(std::move(*result));
        }
    }
}

void run(const Options& options, std::vector<Result>& results) {
    if (options.wanted("coupling/two_way") || options.wanted("coupling/measured")) bench_people(options, results);
    if (!options.wanted("coupling/contacts")) return;
    bench({21'600, 10, 5, 1, 60}, options, results);
    bench({100'000, 100, 50, 0.5, 30}, options, results);
    if (!options.quick) bench({1'000'000, 100, 50, 0, 5}, options, results);
}

}  // namespace

int main(int argc, char** argv) {
    return run_program("bench_coupling", argc, argv, run);
}
