#include "water.hpp"

#include <algorithm>
#include <cmath>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/shallow_water/model.hpp"
#include "fluid_server/steering/steering_world.hpp"

namespace wade::validation {

namespace {

// One frame of the scene; step(remaining): a step of at most that long, its length, s.
template <typename Step>
void advance_sub_steps(const Scene& scene, Cost& cost, Step&& step) {
    const double cpu = process_cpu_time(), wall = wall_time(), frame = 1 / scene.frame_rate;
    double remaining = frame;
    while (remaining > 1e-9 * frame) {
        remaining -= step(remaining);
        ++cost.steps;
    }
    cost.simulated_time += frame;
    cost.cpu_time += process_cpu_time() - cpu;
    cost.wall_time += wall_time() - wall;
}

// count: of particles or cells.
void note_work(const Cost& cost, const std::string& model, std::size_t count, Result& result) {
    result.model = model;
    result.particles = count;
    result.steps = cost.steps;
    result.particle_steps = cost.particle_steps;
    result.simulated_time = cost.simulated_time;
    result.solver_cpu_time = cost.cpu_time;
    result.solver_wall_time = cost.wall_time;
}

class Particles final : public Water {
 public:
    explicit Particles(const Scene& scene) : world_(scene) {}

    [[nodiscard]] const Scene& scene() const override { return world_.scene(); }
    void set_velocity(const VelocityField& field) override { world_.set_velocity(field); }
    void advance(Cost& cost) override {
        advance_frame(world_, cost,
                      [&](const fluid::StepReport& step) { driving_ += step.driving_acceleration * step.dt; });
    }
    void add_to(Columns& columns) const override {
        sample(world_.particles(), scene().fluid->particle_spacing, columns);
    }
    void for_each_parcel(const std::function<void(const Parcel&)>& body) const override {
        const fluid::Particles& p = world_.particles();
        const double volume = std::pow(scene().fluid->particle_spacing, 3);
        for (std::size_t i = 0; i < p.count; ++i) {
            body({static_cast<double>(p.x[i]), static_cast<double>(p.z[i]), volume, static_cast<double>(p.vx[i])});
        }
    }
    [[nodiscard]] fluid::RiverMeasures measures() const override {
        return fluid::measure_river(world_.particles(), static_cast<double>(world_.particle_mass()),
                                    scene().world->gravity);
    }
    [[nodiscard]] double front(double none) const override { return leading_x(world_.particles(), none); }
    [[nodiscard]] double position_clamps() const override { return static_cast<double>(world_.position_clamps()); }
    [[nodiscard]] double missed_layers() const override { return static_cast<double>(world_.emitter().layers_missed); }
    void note(const Cost& cost, Result& result) const override { note_cost(cost, world_, result); }

 private:
    fluid::FluidWorld world_;
};

// Particles that steer by their neighbours.
class Vehicles final : public Water {
 public:
    explicit Vehicles(const Scene& scene) : world_(scene) {}

    [[nodiscard]] const Scene& scene() const override { return world_.scene(); }
    void set_velocity(const VelocityField& field) override {
        fluid::Particles& p = world_.particles();
        for (std::size_t i = 0; i < p.count; ++i) {
            const auto v =
                field({static_cast<double>(p.x[i]), static_cast<double>(p.y[i]), static_cast<double>(p.z[i])});
            p.vx[i] = static_cast<float>(v[0]), p.vy[i] = static_cast<float>(v[1]), p.vz[i] = static_cast<float>(v[2]);
        }
    }
    void advance(Cost& cost) override {
        advance_sub_steps(scene(), cost, [&](double remaining) {
            const fluid::steering::SteeringStep step = world_.step(remaining);
            driving_ += step.driving_acceleration * step.dt;
            cost.particle_steps += static_cast<double>(world_.particles().count);
            return step.dt;
        });
    }
    void add_to(Columns& columns) const override {
        sample(world_.particles(), scene().fluid->particle_spacing, columns);
    }
    void for_each_parcel(const std::function<void(const Parcel&)>& body) const override {
        const double density = scene().fluid->rest_density;
        for (std::size_t i = 0; i < world_.particles().count; ++i) {
            const fluid::Vec3 place = world_.place(i);
            body({static_cast<double>(place[0]), static_cast<double>(place[2]), world_.mass(i) / density,
                  static_cast<double>(world_.particles().vx[i])});
        }
    }
    [[nodiscard]] fluid::RiverMeasures measures() const override {
        const double mass = scene().fluid->rest_density * std::pow(scene().fluid->particle_spacing, 3);
        return fluid::measure_river(world_.particles(), mass, scene().world->gravity);
    }
    [[nodiscard]] double front(double none) const override { return leading_x(world_.particles(), none); }
    [[nodiscard]] double position_clamps() const override { return static_cast<double>(world_.position_clamps()); }
    [[nodiscard]] double missed_layers() const override { return static_cast<double>(world_.emitter().layers_missed); }
    void note(const Cost& cost, Result& result) const override {
        note_work(cost, "steering", world_.particles().count, result);
    }

 private:
    fluid::steering::SteeringWorld world_;
};

namespace swe = fluid::shallow_water;

class GridOfCells final : public Water {
 public:
    explicit GridOfCells(const Scene& scene) : world_(scene) {}

    [[nodiscard]] const Scene& scene() const override { return world_.scene; }

    // At the middle of each column.
    void set_velocity(const VelocityField& field) override {
        for_each_cell([&](std::size_t c, double x, double z) {
            const auto v = field({x, world_.bed.height[c] + 0.5 * world_.water.h[c], z});
            world_.water.qx[c] = world_.water.h[c] * v[0];
            world_.water.qz[c] = world_.water.h[c] * v[2];
        });
        swe::update_primitive(world_);
    }

    void advance(Cost& cost) override {
        advance_sub_steps(scene(), cost, [&](double remaining) {
            const swe::StepReport report = swe::step(world_, remaining);
            driving_ += report.driving_acceleration * report.dt;
            cost.particle_steps += static_cast<double>(world_.grid.cells());
            return report.dt;
        });
    }

    void add_to(Columns& columns) const override {
        const double length = columns.length(), width = world_.grid.dx / length;
        const auto last = static_cast<double>(columns.count());
        for_each_cell([&](std::size_t c, double x, double) {
            const double place = (x - columns.x.lo) / length;
            const double from = std::max(place - 0.5 * width, 0.0), to = std::min(place + 0.5 * width, last);
            for (double k = std::floor(from); k < to; ++k) {
                const double area = world_.grid.dz * length * (std::min(to, k + 1) - std::max(from, k));
                columns.volume[static_cast<std::size_t>(k)] += area * world_.water.h[c];
                columns.momentum[static_cast<std::size_t>(k)] += area * world_.water.qx[c];
            }
        });
        columns.samples += 1;
    }

    void for_each_parcel(const std::function<void(const Parcel&)>& body) const override {
        for_each_cell([&](std::size_t c, double x, double z) {
            if (world_.water.h[c] <= world_.constants.dry) return;
            body({x, z, world_.water.h[c] * world_.grid.cell_area(), world_.primitive.u[c]});
        });
    }

    [[nodiscard]] fluid::RiverMeasures measures() const override {
        const swe::Measures all = swe::measure(world_);
        return {all.mean_depth, all.mean_speed, all.kinetic_energy, all.potential_energy};
    }

    // The edge of the first cell that holds a thousandth of the deepest water: the front of a grid ends in a film.
    [[nodiscard]] double front(double none) const override {
        double first = none;
        for_each_cell([&](std::size_t c, double x, double) {
            if (world_.water.h[c] > 100 * world_.constants.dry) first = std::min(first, x - 0.5 * world_.grid.dx);
        });
        return first;
    }

    void note(const Cost& cost, Result& result) const override {
        note_work(cost, "shallow_water", world_.grid.cells(), result);
    }

 private:
    template <typename Body>
    void for_each_cell(Body&& body) const {
        const swe::Grid& grid = world_.grid;
        for (std::size_t k = 0; k < grid.nz; ++k) {
            for (std::size_t i = 0; i < grid.nx; ++i) {
                body(grid.row(static_cast<std::ptrdiff_t>(k)) + i, grid.x.lo + (static_cast<double>(i) + 0.5) * grid.dx,
                     grid.z.lo + (static_cast<double>(k) + 0.5) * grid.dz);
            }
        }
    }

    swe::ShallowWater world_;
};

}  // namespace

double Water::volume() const {
    double sum = 0;
    for_each_parcel([&](const Parcel& parcel) { sum += parcel.volume; });
    return sum;
}

std::unique_ptr<Water> make_water(const Scene& scene) {
    if (scene.fluid->model == ModelKind::dfsph) return std::make_unique<Particles>(scene);
    if (scene.fluid->model == ModelKind::shallow_water) return std::make_unique<GridOfCells>(scene);
    if (scene.fluid->model == ModelKind::steering) return std::make_unique<Vehicles>(scene);
    throw ConfigurationError(scene.name +
                             ": /fluid/model: this case needs water that is solved for; allowed: \"dfsph\", "
                             "\"shallow_water\" and \"steering\".");
}

}  // namespace wade::validation
