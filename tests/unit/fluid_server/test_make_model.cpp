#include <omp.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <memory>
#include <set>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/estimate.hpp"
#include "fluid_server/make_model.hpp"
#include "fluid_server/server/run_server.hpp"
#include "model_conformance.hpp"
#include "scenes.hpp"
#include "toy_model.hpp"

using namespace wade;
using namespace wade::fluid;
using namespace wade::fluid::test;

namespace {

// A value of its own, as a row of choices.hpp would give it.
constexpr ModelKind toy_kind = static_cast<ModelKind>(100);

template <typename Model>
ModelRow row_of(ModelKind kind = toy_kind) {
    return {kind, [](const Scene& scene) -> std::unique_ptr<FluidModel> { return std::make_unique<Model>(scene); },
            &Model::estimate};
}

// Waters that a model may be asked for, small; each may refuse some of them when the scene is read, as in a run.
const std::vector<std::pair<std::string, std::string>> waters{
    {"a river through an emitter",
     R"("flow": "emitter", "initial_river": "filled", "depth_m": 1, "velocity_m_s": 1.5)"},
    {"an emitter that floods a dry bed",
     R"("flow": "emitter", "initial_river": "dry", "depth_m": 1, "velocity_m_s": 1.5)"},
    {"a river that goes round",
     R"("flow": "recirculating", "initial_river": "filled", "depth_m": 1, "velocity_m_s": 1.5)"},
    {"a closed tank",
     R"("flow": "closed", "water_blocks": [{"x_min_m": 0, "x_max_m": 8, "z_min_m": 0, "z_max_m": 4, "depth_m": 1}])"}};

std::string scene_text(const std::string& model, const std::string& water) {
    return R"({"duration_s": 1, "frame_rate_hz": 30, "world": {"length_m": 24, "width_m": 4},
               "channel": {"x_min_m": 0, "x_max_m": 24, "z_min_m": 0, "z_max_m": 4, )" +
           water + R"(}, "fluid": {"model": ")" + model +
           R"(", "particle_spacing_m": 0.4, "max_particles": 4000, "mixed": {"x_min_m": 6, "x_max_m": 14}},
               "coupling": {"agents_stream": "serial"}})";
}

std::optional<Scene> scene_of(const std::string& model, const std::string& water) {
    // The window of the mixed model is no key of the others.
    std::string text = scene_text(model, water);
    const std::string window = R"(, "mixed": {"x_min_m": 6, "x_max_m": 14})";
    if (model != "mixed") text.erase(text.find(window), window.size());
    try {
        return load_scene_text(text, "conformance.json").scene;
    } catch (const ConfigurationError& error) {
        WARN(model << ": " << error.what());
        return std::nullopt;
    }
}

std::string joined(const std::vector<std::string>& rules) {
    std::string text;
    for (const std::string& rule : rules) text += rule + "; ";
    return text;
}

Scene toy_scene() {
    Scene scene = *scene_of("kinematic", waters.front().second);
    scene.fluid->model = toy_kind;
    return scene;
}

}  // namespace

TEST_CASE("every registered model keeps the rules of models, in every water that it takes", "[models]") {
    for (const ModelRow& row : models_of_water()) {
        int taken = 0;
        for (const auto& [name, water] : waters) {
            const std::optional<Scene> scene = scene_of(name_of(row.kind), water);
            if (!scene) continue;
            ++taken;
            CAPTURE(name_of(row.kind), name);
            CHECK(joined(broken_rules(row, *scene)) == "");
        }
        CHECK(taken >= 2);
    }
}

TEST_CASE("every word of scenes for a model has its row, but for the one that stands for a choice", "[models]") {
    std::set<std::string> registered;
    for (const ModelRow& row : models_of_water()) registered.insert(name_of(row.kind));
    CHECK(registered.size() == models_of_water().size());
    std::set<std::string> words;
    for (const std::string& word : names_of<ModelKind>()) words.insert(word);
    words.erase(name_of(ModelKind::automatic));
    CHECK(registered == words);
}

TEST_CASE("a model that is registered nowhere is refused with those that are", "[models]") {
    Scene scene = toy_scene();
    scene.name = "toy";
    CHECK_THROWS_AS(make_fluid_model(scene), ConfigurationError);
    CHECK_THROWS_WITH(make_fluid_model(scene), Catch::Contains("toy: /fluid/model") &&
                                                   Catch::Contains("dfsph, kinematic, shallow_water, steering, mixed"));
}

// The recipe of CONTRIBUTING.md, step by step, with a toy.
TEST_CASE("a new model runs through the loop of the server once it has a row", "[models][recipe]") {
    std::vector<ModelRow> rows(models_of_water().begin(), models_of_water().end());
    rows.push_back(row_of<Toy>());
    const Scene scene = toy_scene();
    CHECK(joined(broken_rules(rows.back(), scene)) == "");

    const std::unique_ptr<FluidModel> model = make_fluid_model(scene, rows);
    CHECK(estimate(scene, rows).particles == 24);
    shm::Publisher publisher("test-toy-model-" + std::to_string(::getpid()), stream_info(scene, *model), {});
    RunClock clock(scene, Pace::fast);
    ServerSummary summary;
    ServerRun run{*model, publisher, clock};
    run.consumers = 0;
    run_server(run, summary);
    CHECK(publisher.published_frames() == 30);
    CHECK(summary.particles == 24);
}

namespace {

struct OfWrongName : Toy {
    using Toy::Toy;
    [[nodiscard]] std::string_view name() const override { return "toy"; }
};
struct WithoutMass : Toy {
    using Toy::Toy;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override {
        const std::uint32_t n = Toy::write_frame(slot);
        slot.mass[3] = 0;
        return n;
    }
};
struct OnTheBank : Toy {
    using Toy::Toy;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override {
        const std::uint32_t n = Toy::write_frame(slot);
        slot.pz[3] = 5;
        return n;
    }
};
struct Infinite : Toy {
    using Toy::Toy;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override {
        const std::uint32_t n = Toy::write_frame(slot);
        slot.vy[3] = HUGE_VALF;
        return n;
    }
};
struct TooMany : Toy {
    using Toy::Toy;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override { return Toy::write_frame(slot) + 1; }
};
struct Restless : Toy {
    using Toy::Toy;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override {
        const std::uint32_t n = Toy::write_frame(slot);
        slot.py[0] = 0.1F * static_cast<float>(++written_ % 2);
        return n;
    }
    mutable int written_ = 0;
};
struct OfThreads : Toy {
    explicit OfThreads(const Scene& scene) : Toy(scene), threads_(omp_get_max_threads()) {}
    std::uint32_t write_frame(const shm::FrameFields& slot) const override {
        const std::uint32_t n = Toy::write_frame(slot);
        slot.vx[0] = static_cast<float>(threads_);
        return n;
    }
    int threads_;
};
struct WithoutSteps : Toy {
    using Toy::Toy;
    shm::Diagnostics advance_frame(const FrameInterval& interval) override {
        shm::Diagnostics d = Toy::advance_frame(interval);
        d.sub_steps = 0;
        return d;
    }
};
struct OfLongSteps : Toy {
    using Toy::Toy;
    shm::Diagnostics advance_frame(const FrameInterval& interval) override {
        shm::Diagnostics d = Toy::advance_frame(interval);
        d.last_dt_s *= 2;
        return d;
    }
};
struct Modest : Toy {
    using Toy::Toy;
    [[nodiscard]] static Estimate estimate(const Scene&) { return {23, 1e6, 1}; }
};
struct WithoutEstimate : Toy {
    using Toy::Toy;
    [[nodiscard]] static Estimate estimate(const Scene&) { return {24, 0, 0}; }
};

template <typename Model>
std::string rules_broken_by() {
    return joined(broken_rules(row_of<Model>(), toy_scene()));
}

}  // namespace

TEST_CASE("a model that breaks one rule is told which", "[models]") {
    CHECK(rules_broken_by<OfWrongName>() == "its name is the word of scenes; ");
    CHECK(rules_broken_by<WithoutMass>() == "masses are positive; ");
    CHECK(rules_broken_by<OnTheBank>() == "particles are in the channel; ");
    CHECK(rules_broken_by<Infinite>() == "all numbers are finite; ");
    CHECK(rules_broken_by<TooMany>().find("frames fit the capacity; ") == 0);
    CHECK(rules_broken_by<Restless>().find("writing a frame changes nothing; ") == 0);
    CHECK(rules_broken_by<OfThreads>() == "one thread and two give the same bits; ");
    CHECK(rules_broken_by<WithoutSteps>() == "a frame is at least one step; ");
    CHECK(rules_broken_by<OfLongSteps>() == "a step is no longer than its frame; ");
    CHECK(rules_broken_by<Modest>() == "frames fit the estimate; ");
    CHECK(rules_broken_by<WithoutEstimate>() == "memory and time are estimated; ");
}

TEST_CASE("an estimate is told in units that a reader can use", "[estimate]") {
    CHECK(text_of({27619, 40.2e6, 178}) == "at most 27619 particles, 41 MB of memory, about 3.0 min of CPU time");
    CHECK(text_of({1, 9.4e6, 0.3}) == "at most 1 particles, 10 MB of memory, less than 1 s of CPU time");
    CHECK(text_of({100000000, 30.6e9, 4e6}) ==
          "at most 100000000 particles, 31 GB of memory, about 46 days of CPU time");
}

TEST_CASE("an estimate grows with the room for particles and the run, not with dry ground", "[estimate]") {
    const auto of = [](auto&& change) {
        Scene scene = test::tank(4, 2, 1, 0.25);
        scene.fluid->max_particles = 512;
        change(scene);
        return estimate(scene);
    };
    const Estimate as_is = of([](Scene&) {});
    CHECK(as_is.particles == 512);
    CHECK(of([](Scene& s) { s.fluid->max_particles = 100000000; }).memory > 2e10);
    // Dry ground takes no memory: a channel of 1e5 m x 1e5 m has 3e11 cells, 4 bytes each if they were kept.
    CHECK(of([](Scene& s) { s.channel->x.hi = s.channel->z.hi = 1e5; }).memory == Approx(as_is.memory).epsilon(0.01));
    CHECK(of([](Scene& s) { s.duration *= 10; }).cpu_time == Approx(10 * as_is.cpu_time));
    CHECK(of([](Scene& s) {
              s.fluid->model = ModelKind::shallow_water;
              s.fluid->shallow_water.cell_size = 1e-3;
          }).memory > 1e9);
}
