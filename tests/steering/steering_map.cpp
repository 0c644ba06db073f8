// steering_map OUT: what the weights of the steering water mean as properties of a fluid; tools/wade steering runs it.
//
// OUT/rest.csv        spacing, density and depth at rest over the radius of separation
// OUT/viscosity.csv   apparent viscosity between planes over the weight of cohesion and over the loss
// OUT/profiles.csv    the velocities between the planes
// OUT/settling.csv    time until the kinetic energy is 1e-4 of its largest over the losses
// OUT/energy.csv      kinetic energy in time
// OUT/dam.csv         dam break over a dry bed, error and CPU time beside DFSPH

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>

#include "configs/loading/scene_loader.hpp"
#include "configs/scene/world.hpp"
#include "tests/steering/measures.hpp"
#include "tests/validation/cases.hpp"

namespace {

using namespace wade;
using namespace wade::steering_map;

using Values = std::vector<std::pair<std::string, double>>;  // keys below /fluid/steering

// gravity: m/s^2, below 0 that of the scene.
SteeringWorld world_of(const std::string& file, const Values& values, double gravity = -1) {
    std::vector<SceneOverride> overrides;
    for (const auto& [key, value] : values) {
        overrides.push_back({"/fluid/steering/" + key, std::to_string(value), "steering_map"});
    }
    if (gravity >= 0) overrides.push_back({"/world/gravity_m_s2", std::to_string(gravity), "steering_map"});
    return SteeringWorld(load_scene(std::string(WADE_CONFIGS) + "/models/" + file, overrides).scene);
}

// Of the largest kinetic energy so far, the last time above 1e-4 of it; infinite if it is above at the end.
class RestWatch {
 public:
    void see(double time, double kinetic) {
        if (kinetic > largest_) largest_ = kinetic;
        if (kinetic > 1e-4 * largest_) above_ = time;
        last_ = time;
    }
    [[nodiscard]] double time() const { return above_ < last_ ? above_ : std::numeric_limits<double>::infinity(); }

 private:
    double largest_ = 0, above_ = 0, last_ = 0;
};

void map_rest(const std::string& out) {
    std::ofstream csv(out + "/rest.csv");
    csv << "separation_radius_d,cohesion_weight,spacing_d,density,density_bottom,density_top,depth_over_filled,"
           "unevenness_d\n";
    const auto measure = [&](double radius, double cohesion) {
        SteeringWorld world =
            world_of("container.json", {{"separation/radius", radius}, {"cohesion/weight", cohesion}});
        run_for(world, 12);
        const Packing p = measure_packing(world);
        const double d = world.settings().spacing;
        csv << radius << ',' << cohesion << ',' << p.spacing / d << ',' << p.density << ',' << p.bottom << ',' << p.top
            << ',' << p.depth / 0.8 << ',' << p.unevenness / d << std::endl;
    };
    for (const double radius : {1.0, 1.05, 1.1, 1.12, 1.15, 1.2, 1.3}) measure(radius, 0.0);
    for (const double cohesion : {0.01, 0.03, 0.1}) measure(1.12, cohesion);
}

void map_viscosity(const std::string& out) {
    std::ofstream csv(out + "/viscosity.csv"), profiles(out + "/profiles.csv");
    csv << "cohesion_weight,loss_weight,wall_stress_over_U2,parabola_viscosity_over_U_d,residual,bingham_viscosity_"
           "over_U_d,"
           "yield_stress_over_U2,sheared,slip_over_U,peak_over_U\n";
    profiles << "cohesion_weight,loss_weight,wall_stress_over_U2,height_d,velocity_over_U,fit_over_U\n";
    // wall_stress: drive times half the height, over U^2.
    const auto measure = [&](double cohesion, double loss, double wall_stress) {
        const double height = 1.2, V = 1;
        // g sin 45 h / 2 = wall_stress U^2 with U^2 = g h + V^2.
        const double share = wall_stress * 2 * std::sqrt(2.0);
        const double gravity = share * V * V / (height * (1 - share));
        SteeringWorld world = world_of("planes.json", {{"cohesion/weight", cohesion}, {"loss/weight", loss}}, gravity);
        const Scene& scene = world.scene();
        const double U = world.settings().speed, d = world.settings().spacing;
        run_for(world, scene.duration / 2);
        Profile profile(12);
        run_for(world, scene.duration / 2, [&](double) { profile.add(world); });
        const double drive = scene.world->gravity * std::sqrt(0.5);
        const Parabola fit = fit_parabola(profile, height);
        const Bingham bingham = fit_bingham(profile, height, drive);
        double peak = 0;
        for (std::size_t k = 0; k < 12; ++k) {
            const double y = (static_cast<double>(k) + 0.5) * height / 12;
            peak = std::max(peak, profile.mean(k));
            profiles << cohesion << ',' << loss << ',' << wall_stress << ',' << y / d << ',' << profile.mean(k) / U
                     << ',' << (fit.slip + fit.curvature * y * (height - y)) / U << '\n';
        }
        profiles.flush();
        // Of a steady flow drive = 2 nu curvature.
        csv << cohesion << ',' << loss << ',' << wall_stress << ',' << drive / (2 * fit.curvature) / (U * d) << ','
            << fit.residual << ',' << bingham.viscosity / (U * d) << ',' << bingham.yield / (U * U) << ','
            << bingham.sheared << ',' << profile.mean(0) / U << ',' << peak / U << std::endl;
    };
    for (const double stress : {0.02, 0.05, 0.1, 0.2}) measure(0.0, 0.1, stress);
    for (const double cohesion : {0.01, 0.03, 0.1}) measure(cohesion, 0.1, 0.2);
    for (const double loss : {0.05, 0.2, 0.4, 0.8}) measure(0.0, loss, 0.2);
}

void map_settling(const std::string& out) {
    std::ofstream csv(out + "/settling.csv"), energy(out + "/energy.csv");
    csv << "loss_weight,wall_loss,time_to_rest_s,last_over_largest,energy_growth\n";
    energy << "loss_weight,wall_loss,time_s,kinetic_j\n";
    const auto measure = [&](double loss, double wall) {
        SteeringWorld world = world_of("container.json", {{"loss/weight", loss}, {"walls/loss", wall}});
        RestWatch watch;
        double largest = 0, last = 0, lowest_total = std::numeric_limits<double>::infinity(), growth = 0;
        run_for(world, world.scene().duration, [&](double t) {
            const fluid::steering::Energies e = world.energies();
            watch.see(t, e.kinetic);
            largest = std::max(largest, e.kinetic);
            last = e.kinetic;
            growth = std::max(growth, (e.total() - lowest_total) / std::abs(e.total()));
            lowest_total = std::min(lowest_total, e.total());
            if (std::lround(t * world.scene().frame_rate) % 6 == 0)
                energy << loss << ',' << wall << ',' << t << ',' << e.kinetic << '\n';
        });
        energy.flush();
        csv << loss << ',' << wall << ',' << watch.time() << ',' << last / largest << ',' << growth << std::endl;
    };
    for (const double loss : {0.0, 0.02, 0.05, 0.1, 0.3, 1.0}) measure(loss, 0.02);
    for (const double wall : {0.0, 0.2, 1.0}) measure(0.1, wall);
}

// The case dam_break of the validation with both waters.
void map_dam(const std::string& out) {
    std::ofstream csv(out + "/dam.csv"), profiles(out + "/dam_profiles.csv");
    csv << "model,spacing_m,particles,depth_l1,speed_l1,tip_lag,cpu_s,steps,particle_steps_per_cpu_s\n";
    profiles << "model,s,depth,exact_depth,velocity,exact_velocity\n";
    const double wave = std::sqrt(9.81);
    for (const double spacing : {0.2, 0.1, 0.05}) {
        for (const std::string model : {"dfsph", "steering"}) {
            validation::Request request;
            request.spacing = spacing;
            request.overrides = {"/fluid/model=" + model};
            const validation::Result r = validation::dam_break_case().run(request);
            const auto metric = [&](const char* name) {
                for (const validation::Metric& m : r.metrics) {
                    if (m.name == name) return m.value;
                }
                return std::numeric_limits<double>::quiet_NaN();
            };
            csv << model << ',' << spacing << ',' << r.particles << ',' << metric("depth_l1") << ','
                << metric("speed_l1") << ',' << metric("tip_lag") << ',' << r.solver_cpu_time << ',' << r.steps << ','
                << r.particle_steps / r.solver_cpu_time << std::endl;
            if (spacing != 0.1) continue;
            for (const std::vector<double>& row : r.curves.at(0).rows) {
                profiles << model << ',' << row[0] << ',' << row[1] << ',' << row[2] << ',' << row[3] / wave << ','
                         << row[4] / wave << '\n';
            }
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || std::strncmp(argv[1], "-", 1) == 0) {
        std::fprintf(stderr, "Usage: steering_map OUT [rest] [viscosity] [settling] [dam]\n");
        return 2;
    }
    const auto wanted = [&](const char* part) {
        for (int k = 2; k < argc; ++k) {
            if (std::strcmp(argv[k], part) == 0) return true;
        }
        return argc == 2;
    };
    try {
        if (wanted("rest")) map_rest(argv[1]);
        if (wanted("viscosity")) map_viscosity(argv[1]);
        if (wanted("settling")) map_settling(argv[1]);
        if (wanted("dam")) map_dam(argv[1]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "steering_map: %s\n", error.what());
        return 1;
    }
    return 0;
}
