#include "run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"

namespace wade::validation {

double process_cpu_time() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double wall_time() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void check_is_dfsph(const Scene& scene) {
    if (scene.fluid->model == ModelKind::dfsph) return;
    throw ConfigurationError(scene.name + ": /fluid/model: this case measures particles of DFSPH; allowed: \"dfsph\".");
}

void note_cost(const Cost& cost, const fluid::FluidWorld& world, Result& result) {
    result.particles = world.particles().count;
    result.steps = cost.steps;
    result.particle_steps = cost.particle_steps;
    result.simulated_time = cost.simulated_time;
    result.solver_cpu_time = cost.cpu_time;
    result.solver_wall_time = cost.wall_time;
}

int frames_in(const Scene& scene, double time) {
    return static_cast<int>(std::lround(time * scene.frame_rate));
}

std::string assign(const std::string& pointer, double value) {
    std::ostringstream text;
    text.precision(17);
    text << pointer << '=' << value;
    return text.str();
}

Result medians_of(const std::vector<Result>& results) {
    Result all = results.at(0);
    for (Metric& metric : all.metrics) {
        std::vector<double> values;
        for (const Result& result : results) {
            const auto same = std::find_if(result.metrics.begin(), result.metrics.end(),
                                           [&](const Metric& other) { return other.name == metric.name; });
            values.push_back(same == result.metrics.end() ? std::nan("") : same->value);
        }
        if (std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); })) {
            metric.value = metric.low = metric.high = std::nan("");
            continue;
        }
        std::sort(values.begin(), values.end());
        const std::size_t half = values.size() / 2;
        metric.value = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
        metric.low = values.front(), metric.high = values.back();
    }
    for (std::size_t k = 1; k < results.size(); ++k) {
        all.steps += results[k].steps;
        all.particle_steps += results[k].particle_steps;
        all.simulated_time += results[k].simulated_time;
        all.solver_cpu_time += results[k].solver_cpu_time;
        all.solver_wall_time += results[k].solver_wall_time;
    }
    return all;
}

Scene scene_for(const Request& request, const std::string& name, const std::vector<std::string>& sizes) {
    const std::string capacity = "/fluid/max_particles=";
    std::vector<SceneOverride> overrides;
    bool capacity_given = false;
    const auto add = [&](const std::string& text) {
        capacity_given = capacity_given || text.starts_with(capacity);
        overrides.push_back(parse_override(text));
    };
    if (request.spacing > 0) {
        add(assign("/fluid/particle_spacing_m", request.spacing));
    }
    // A grid gets cells as large as the particles are apart, unless the request says otherwise.
    const bool on_grid = std::any_of(request.overrides.begin(), request.overrides.end(), [](const std::string& text) {
        return text.starts_with("/fluid/model=") &&
               (text.find("shallow_water") != std::string::npos || text.find("mixed") != std::string::npos);
    });
    if (request.spacing > 0 && on_grid) {
        add(assign("/fluid/shallow_water/cell_size_m", request.spacing));
    }
    std::for_each(sizes.begin(), sizes.end(), add);
    std::for_each(request.overrides.begin(), request.overrides.end(), add);
    if (!capacity_given) {
        overrides.push_back(parse_override(capacity + "100000000"));  // refuses nothing; the true need follows
    }
    Scene scene = load_scene(std::filesystem::path(WADE_CONFIGS) / name, overrides).scene;
    scene.world->gravity *= request.gravity_factor;
    if (!capacity_given) {
        const std::uint64_t needed = particles_needed(scene);
        const std::uint64_t slack = scene.channel->flow == Flow::emitter ? needed / 4 : 0;
        scene.fluid->max_particles = static_cast<int>(needed + slack);
    }
    return scene;
}

}  // namespace wade::validation
