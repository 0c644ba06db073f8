#include "fluid_server/kinematic/kinematic_stream.hpp"

#include <algorithm>
#include <cmath>

#include "configs/numbers/splitmix.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/scene_frames.hpp"
#include "configs/scene/world.hpp"

namespace wade::fluid {

namespace {

// A number of [-1, 2) brought into [0, 1) by whole numbers.
constexpr double into_cell(double place) {
    return place < 0 ? place + 1 : place < 1 ? place : place - 1;
}

}  // namespace

KinematicStream::InCell KinematicStream::in_cell(const Strip& strip, std::int64_t cell) const {
    const std::uint64_t bits = mix_bits(strip.random_key + static_cast<std::uint64_t>(cell) * splitmix_step);
    const double along = static_cast<double>(bits >> 32) * 0x1p-32;
    const double across = static_cast<double>(bits & 0xffffffffU) * 0x1p-32;
    if (!lattice_) return {along, across};
    return {into_cell(strip.lattice_point + jitter_ * (along - 0.5)),
            into_cell(strip.lattice_point + jitter_ * (across - 0.5))};
}

KinematicStream::KinematicStream(const Scene& scene)
    : x_(scene.channel->x),
      periodic_(scene.channel->flow == Flow::recirculating),
      dry_start_(scene.channel->initial_river == InitialRiver::dry),
      transport_factor_(scene.fluid->kinematic.transport_factor),
      lattice_(scene.fluid->kinematic.arrangement == Arrangement::lattice),
      jitter_(scene.fluid->kinematic.jitter),
      gravity_(scene.world->gravity),
      particle_mass_(particle_mass(scene.fluid)) {
    make_strips(scene);
    place_at(0);
    for (Strip& strip : strips_) strip.first_at_start = strip.first_cell;
}

// Measured: seconds of CPU time a particle and frame. A strip may hold one more than its share.
Estimate KinematicStream::estimate(const Scene& scene) {
    constexpr double frame_cost = 1e-8;
    const auto river = static_cast<double>(river_particles(scene));
    const double strips = std::ceil(river * scene.fluid->particle_spacing / scene.channel->x.length()) + 1;
    const double n = river + strips;
    Estimate estimate;
    estimate.particles = static_cast<std::uint64_t>(n);
    estimate.memory = empty_server + sizeof(Strip) * strips + memory_of_frames(scene, estimate.particles);
    estimate.cpu_time = frame_cost * n * static_cast<double>(frames_of(scene));
    return estimate;
}

void KinematicStream::make_strips(const Scene& scene) {
    const Channel& channel = scene.channel;
    const double d = scene.fluid->particle_spacing;
    const double width = channel.z.length();
    const auto layers = static_cast<std::uint64_t>(std::max(1L, std::lround(channel.depth / d)));
    const double layer_depth = channel.depth / static_cast<double>(layers);
    const double pitch = d * std::sqrt(d / layer_depth);
    const auto across = static_cast<std::uint64_t>(std::max(1L, std::lround(width / pitch)));
    strip_width_ = width / static_cast<double>(across);
    const double cell_length = particle_volume(scene.fluid) / (layer_depth * strip_width_);
    const ProfiledStream stream{scene.fluid->kinematic.profile, channel.depth, channel.velocity,
                                scene.fluid->kinematic.roughness_length};
    const std::uint64_t all = layers * across;
    const std::uint64_t particles = river_particles(scene);
    const std::uint64_t seed_key = mix_bits(scene.seed + splitmix_step);
    for (std::uint64_t s = 0; s < all; ++s) {
        const std::uint64_t row = s / across;
        const auto layer = static_cast<double>(row);
        Strip strip;
        strip.y = static_cast<float>((layer + 0.5) * layer_depth);
        strip.z_lo = channel.z.lo + static_cast<double>(s % across) * strip_width_;
        strip.velocity = mean_velocity_between(stream, layer * layer_depth, (layer + 1) * layer_depth);
        strip.random_key = mix_bits(seed_key + s * splitmix_step);
        if (layers > 1) strip.lattice_point = row % 2 == 0 ? 0.25 : 0.75;
        // A round channel holds whole cells; the strips share them so that their sum is that of the river.
        strip.cells = static_cast<std::int64_t>((s + 1) * particles / all - s * particles / all);
        strip.cell_length =
            periodic_ ? x_.length() / static_cast<double>(std::max<std::int64_t>(strip.cells, 1)) : cell_length;
        strips_.push_back(strip);
    }
    const auto longest = static_cast<std::uint64_t>(std::ceil(x_.length() / cell_length)) + 1;
    capacity_ = static_cast<std::uint32_t>(periodic_ ? particles : all * longest);
}

// Distance from x.lo, m; beyond the length or below 0 if the particle is not in the channel.
double KinematicStream::place(const Strip& strip, std::int64_t cell, double along) const {
    const double upstream = (static_cast<double>(cell) + along) * strip.cell_length - strip.travel;
    if (!periodic_) return x_.length() + upstream;
    return upstream < 0 ? upstream + x_.length() : upstream;
}

void KinematicStream::find_cells(Strip& strip) const {
    if (periodic_) {
        strip.end_cell = strip.cells;
        return;
    }
    const auto cell_at = [&](double upstream) {
        return static_cast<std::int64_t>(std::floor(upstream / strip.cell_length));
    };
    const auto along = [&](std::int64_t cell) { return in_cell(strip, cell).along; };
    // Of the two cells that lie across an end of the channel the particle may be on either side.
    strip.first_cell = cell_at(strip.travel - x_.length());
    if (place(strip, strip.first_cell, along(strip.first_cell)) <= 0) ++strip.first_cell;
    strip.end_cell = cell_at(strip.travel);
    if (place(strip, strip.end_cell, along(strip.end_cell)) <= x_.length()) ++strip.end_cell;
    if (dry_start_) strip.first_cell = std::max<std::int64_t>(strip.first_cell, 0);
}

void KinematicStream::place_at(double time) {
    std::size_t offset = 0;
    for (Strip& strip : strips_) {
        const double travel = transport_factor_ * strip.velocity * time;
        strip.travel = periodic_ ? std::fmod(travel, x_.length()) : travel;
        find_cells(strip);
        strip.offset = offset;
        offset += static_cast<std::size_t>(strip.end_cell - strip.first_cell);
    }
}

std::size_t KinematicStream::count() const {
    const Strip& last = strips_.back();
    return last.offset + static_cast<std::size_t>(last.end_cell - last.first_cell);
}

shm::Diagnostics KinematicStream::advance_frame(const FrameInterval& interval) {
    place_at(interval.end());
    double n = 0, height = 0, speed = 0, speed2 = 0;
    std::int64_t recycled = 0;
    for (const Strip& strip : strips_) {
        const auto here = static_cast<double>(strip.end_cell - strip.first_cell);
        n += here;
        height += here * static_cast<double>(strip.y);
        speed += here * strip.velocity;
        speed2 += here * strip.velocity * strip.velocity;
        recycled += strip.first_cell - strip.first_at_start;
    }
    shm::Diagnostics d;
    d.sub_steps = 1;
    d.last_dt_s = interval.duration();
    d.kinetic_energy_j = 0.5 * particle_mass_ * speed2;
    d.potential_energy_j = particle_mass_ * gravity_ * height;
    d.recycled_particles = static_cast<std::uint64_t>(recycled);
    if (n > 0) {
        d.mean_depth_m = 2 * height / n;
        d.mean_speed_m_s = speed / n;
    }
    return d;
}

std::uint32_t KinematicStream::write_frame(const shm::FrameFields& slot) const {
    const auto strips = static_cast<std::ptrdiff_t>(strips_.size());
#pragma omp parallel for schedule(static) if (count() >= 4096)
    for (std::ptrdiff_t s = 0; s < strips; ++s) write_strip(strips_[static_cast<std::size_t>(s)], slot);
    return static_cast<std::uint32_t>(count());
}

void KinematicStream::write_strip(const Strip& strip, const shm::FrameFields& slot) const {
    const auto mass = static_cast<float>(particle_mass_);
    const auto velocity = static_cast<float>(-strip.velocity);
    std::size_t i = strip.offset;
    for (std::int64_t cell = strip.first_cell; cell < strip.end_cell; ++cell, ++i) {
        const InCell at = in_cell(strip, cell);
        slot.mass[i] = mass;
        slot.vx[i] = velocity;
        slot.vy[i] = 0;
        slot.vz[i] = 0;
        slot.px[i] = static_cast<float>(x_.lo + place(strip, cell, at.along));
        slot.py[i] = strip.y;
        slot.pz[i] = static_cast<float>(strip.z_lo + at.across * strip_width_);
    }
}

}  // namespace wade::fluid
