#include "fluid_server/mixed/mixed_world.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/particle_volume.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/inflow.hpp"
#include "fluid_server/shallow_water/people.hpp"

namespace wade::fluid::mixed {

namespace {

// The scene of the particles: what happens at the ends of the channel is the shallow water's business, except for walls.
// The guards come on top of max_particles, half as deep again as the water, as they may carry a wave.
Scene scene_of_particles(Scene scene, double guard) {
    const double d = scene.fluid->particle_spacing;
    const double volume = 2 * (guard + d) * scene.channel->z.length() * (1.5 * deepest_water(scene) + d);
    scene.fluid->max_particles += static_cast<int>(std::ceil(volume / particle_volume(scene.fluid)));
    Channel& channel = scene.channel;
    channel.velocity = largest_velocity(channel);
    channel.velocity_history.clear();
    if (channel.flow != Flow::closed) channel.flow = Flow::emitter;
    return scene;
}

}  // namespace

MixedWorld::MixedWorld(const Scene& scene)
    : spacing_(scene.fluid->particle_spacing),
      shallow_(scene),
      columns_(shallow_),
      rule_(scene, shallow_.grid),
      guards_(shallow_, rule_.guard()),
      restriction_(shallow_),
      fluid_(scene_of_particles(scene, rule_.guard()), static_cast<ChannelEnds&>(*this)),
      bed_(bed_facets(scene.channel)) {
    momentum_.kept = keeps_momentum(scene);
    fluid_.push_with([this](const CellGrid& cells, Particles& particles, double duration, double gain) {
        push(cells, particles, duration, gain);
    });
    change_window(rule_.next({}, {}));
}

void MixedWorld::need(const std::optional<Interval>& agents) {
    change_window(rule_.next(window_, agents));
}

double MixedWorld::shallow_step(double remaining, PeopleInWater* people, std::optional<double> driven_by) {
    const shallow_water::StepReport report = shallow_water::step(shallow_, remaining, people, driven_by);
    columns_.drift(shallow_, report.dt);
    driving_ += report.driving_acceleration * report.dt;
    inflow_ += report.inflow;
    outflow_ += report.outflow;
    return report.dt;
}

MixedStep MixedWorld::step(double remaining) {
    MixedStep result;
    driving_ = 0;
    seconds_ = {};
    stage_ = MixedStages(seconds_);
    if (window_.empty()) {
        stage_(MixedStage::shallow_water, [&] { result.dt = shallow_step(remaining, &people_); });
    } else {
        stage_(MixedStage::particles, [&] { result.particles = fluid_.step(remaining); });
        result.dt = result.particles->dt;
    }
    result.driving_acceleration = driving_ / result.dt;
    result.stages = seconds_;
    return result;
}

void MixedWorld::begin_step(Particles& particles, double, double dt) {
    stage_.finished(MixedStage::particles);
    stage_(MixedStage::shallow_water, [&] {
        const std::optional<double> driven_by = driving_of_all(dt);
        for (double left = dt; left > 1e-9 * dt;) left -= shallow_step(left, nullptr, driven_by);
        acceleration_ = -driving_ / dt;
    });
    stage_(MixedStage::guards, [&] { guards_.update(particles, shallow_, dt); });
}

std::optional<double> MixedWorld::driving_of_all(double dt) {
    if (!momentum_.kept) return {};
    const double all = volume(), there = all - accounts_[0].owed - accounts_[1].owed;
    const double wanted = -velocity_at(shallow_.scene.channel, shallow_.time + dt) * all;
    const double lack = (wanted - momentum_.expected) / there;  // what is owed is nowhere to be driven
    momentum_.expected = wanted;
    return -lack / dt;
}

void MixedWorld::book_people(double taken_before) {
    momentum_.expected -= (people_.account.taken[0] - taken_before) / shallow_.scene.fluid->rest_density;
}

void MixedWorld::push(const CellGrid& cells, Particles& particles, double duration, double gain) {
    if (!people_.push()) return;
    const double share = duration / people_.frame_time, mass = static_cast<double>(fluid_.particle_mass());
    const auto counts = [&](float x) { return share_in_window(static_cast<double>(x), ends(), spacing_); };
    const double taken_before = people_.account.taken[0];
    NearParticles near;
    shallow_water::NearCells outside;
    for (const Push& push : people_.pushes) {
        find_near(push, cells, particles, top_of_column(push, ground_of_bed(bed_), spacing_), counts, near);
        shallow_water::find_near(shallow_, push, window_.begin, window_.end, outside);
        NearWater water;
        add_particles(near, particles, mass, water);
        shallow_water::add_cells(shallow_, outside, water);
        MomentumAccount now;
        const GroundVector impulse = impulse_now(push, share, water, now);
        now.taken = take_from(near, impulse, water.weight, mass, particles);
        // Cells have no midpoint: they get the whole of it at once.
        const GroundVector whole{gain * impulse[0], gain * impulse[1]};
        const GroundVector of_cells = shallow_water::take_from(shallow_, outside, whole, water.weight);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            people_.account.taken[axis] += gain * now.taken[axis] + of_cells[axis];
            people_.account.missing[axis] += gain * now.missing[axis];
        }
    }
    book_people(taken_before);
}

void MixedWorld::end_step(Particles& particles, std::span<const float> x_before, double dt) {
    stage_.finished(MixedStage::particles);
    stage_(MixedStage::account, [&] {
        book(particles, x_before);
        pay(dt);
    });
    stage_(MixedStage::restriction, [&] {
        restriction_.apply(shallow_, particles, window_, dt);
        pay_momentum(-std::expm1(-dt / restriction_.time()));
        shallow_water::update_primitive(shallow_);
    });
}

// What the grid sent through the ends of the window against what came in as particles.
void MixedWorld::book(const Particles& p, std::span<const float> x_before) {
    const double volume = particle_volume(shallow_.scene.fluid), middle = 0.5 * (ends()[0].x + ends()[1].x);
    std::array<double, 2> gained{}, carried{};  // by the window through each end
    for (std::size_t i = 0; i < p.count; ++i) {
        const double from = static_cast<double>(x_before[i]), to = static_cast<double>(p.x[i]);
        const double change = share_in_window(to, ends(), spacing_) - share_in_window(from, ends(), spacing_);
        if (change == 0) continue;
        const std::size_t e = to < middle ? 0 : 1;
        gained[e] += volume * change;
        carried[e] += volume * change * static_cast<double>(p.vx[i]);
    }
    for (std::size_t e = 0, w = 0; e < 2; ++e) {
        if (!ends()[e].open) continue;
        shallow_water::WatchedFace& face = shallow_.watched[w++];
        const double inwards = -ends()[e].side;
        EndAccount& account = accounts_[e];
        account.owed += inwards * face.volume - gained[e];
        account.most_owed = std::max(account.most_owed, std::abs(account.owed));
        account.passed += std::abs(face.volume);
        account.grid_momentum += face.momentum;
        account.particle_momentum += inwards * carried[e];
        account.passed_momentum += std::abs(face.momentum);
        face.volume = face.momentum = 0;
    }
}

std::array<std::size_t, 2> MixedWorld::cells_before(std::size_t e) const {
    const auto reach = static_cast<std::size_t>(std::ceil(rule_.guard() / shallow_.grid.dx));
    if (e == 0) return {window_.begin - std::min(reach, window_.begin), window_.begin};
    return {window_.end, std::min(window_.end + reach, shallow_.grid.nx)};
}

void MixedWorld::pay(double dt) {
    const double share = -std::expm1(-dt / restriction_.time());
    for (std::size_t e = 0; e < 2; ++e) {
        if (!ends()[e].open) continue;
        const auto [begin, end] = cells_before(e);
        accounts_[e].owed -= add_to_cells(shallow_, begin, end, share * accounts_[e].owed);
    }
}

void MixedWorld::pay_momentum(double share) {
    if (!momentum_.kept) return;
    const double outside =
        momentum_of_cells(shallow_, 0, window_.begin) + momentum_of_cells(shallow_, window_.end, shallow_.grid.nx);
    const double owed = momentum_.expected - outside - momentum_in_window(fluid_.particles(), ends(), spacing_);
    momentum_.owed = owed;
    momentum_.most_owed = std::max(momentum_.most_owed, std::abs(owed));
    for (std::size_t e = 0; e < 2; ++e) {
        const auto [begin, end] = cells_before(e);
        if (add_momentum_to_cells(shallow_, begin, end, 0.5 * share * owed)) momentum_.owed -= 0.5 * share * owed;
    }
}

double MixedWorld::volume() const {
    const std::size_t all = shallow_.grid.nx;
    double sum = accounts_[0].owed + accounts_[1].owed;
    if (window_.empty()) return sum + volume_of_cells(shallow_, 0, all);
    sum += volume_of_cells(shallow_, 0, window_.begin) + volume_of_cells(shallow_, window_.end, all);
    return sum + volume_in_window(fluid_.particles(), ends(), spacing_);
}

}  // namespace wade::fluid::mixed
