#include "tools/splishsplash/ParticleExporter_Wade.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "SPlisHSPlasH/EmitterSystem.h"
#include "SPlisHSPlasH/FluidModel.h"
#include "SPlisHSPlasH/Simulation.h"
#include "SPlisHSPlasH/TimeManager.h"
#include "Utilities/Logger.h"
#include "shm_protocol/publisher.hpp"
#include "tools/splishsplash/scene_settings.hpp"

namespace SPH {

namespace {

using namespace wade;
using namespace wade::splishsplash;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Numbers of parameters are int where they are kept and unsigned where they are used.
unsigned int parameter(int id) {
    return static_cast<unsigned int>(id);
}

std::array<float, 3> floats_of(const Vector3r& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

std::uint32_t capacity_of(Simulation& simulation) {
    std::uint64_t particles = 0;
    for (unsigned int m = 0; m < simulation.numberOfFluidModels(); ++m) {
        particles += simulation.getFluidModel(m)->numParticles();  // those yet to be emitted too
    }
    if (particles < 1 || particles > std::numeric_limits<std::uint32_t>::max()) {
        throw std::invalid_argument("the scene has room for " + std::to_string(particles) +
                                    " fluid particles, allowed is 1 to 2^32 - 1");
    }
    return static_cast<std::uint32_t>(particles);
}

std::string settings_block(SimulatorBase& base) {
    const nlohmann::json& scene = base.getSceneLoader()->getJSONData();
    const auto block = scene.find("Wade");
    return block == scene.end() ? "" : block->dump();
}

// 0 (not given) if several fluids differ.
double rest_density_of(Simulation& simulation) {
    const auto density = static_cast<double>(simulation.getFluidModel(0)->getDensity0());
    for (unsigned int m = 1; m < simulation.numberOfFluidModels(); ++m) {
        if (static_cast<double>(simulation.getFluidModel(m)->getDensity0()) != density) return 0;
    }
    return density;
}

std::uint32_t store_fluids(Simulation& simulation, const ModelUnits& units, const shm::FrameFields& slot) {
    std::size_t n = 0;
    for (unsigned int m = 0; m < simulation.numberOfFluidModels(); ++m) {
        const FluidModel& fluid = *simulation.getFluidModel(m);
        const unsigned int count = fluid.numActiveParticles();
        if (n + count > slot.px.size()) throw std::runtime_error("the fluids have outgrown the capacity of the stream");
        for (unsigned int i = 0; i < count; ++i, ++n) {
            const ModelParticle particle{static_cast<double>(fluid.getMass(i)), floats_of(fluid.getPosition(i)),
                                         floats_of(fluid.getVelocity(i))};
            store(units, particle, slot, n);
        }
    }
    return static_cast<std::uint32_t>(n);
}

std::uint64_t recycled_particles(Simulation& simulation) {
    std::uint64_t recycled = 0;
    for (unsigned int m = 0; m < simulation.numberOfFluidModels(); ++m) {
        recycled += simulation.getFluidModel(m)->getEmitterSystem()->numReusedParticles();
    }
    return recycled;
}

}  // namespace

struct ParticleExporter_Wade::Stream {
    ModelUnits units;
    shm::Publisher publisher;
    ModelClock clock;
};

ParticleExporter_Wade::ParticleExporter_Wade(SimulatorBase* base)
    : ExporterBase(base), computing_since_(std::chrono::steady_clock::now()) {}

ParticleExporter_Wade::~ParticleExporter_Wade() {
    finish();
}

void ParticleExporter_Wade::open() {
    Simulation& simulation = *Simulation::getCurrent();
    SceneSettings settings = read_settings(settings_block(*m_base));
    settings.units.frame_rate = static_cast<double>(m_base->getValue<Real>(parameter(SimulatorBase::DATA_EXPORT_FPS)));
    check(settings.units);
    shm::StreamInfo info =
        stream_info(settings.units, capacity_of(simulation), static_cast<double>(simulation.getParticleRadius()),
                    rest_density_of(simulation));
    info.depth = settings.depth;
    shm::Waiting waiting;
    waiting.attach_timeout_s = settings.attach_timeout_s;
    waiting.step_timeout_s = settings.step_timeout_s;
    waiting.interrupted = interrupted_;
    waiting.warn = [](const std::string& text) { LOG_WARN << "Wade: " << text; };
    const std::string& session = session_.empty() ? settings.session : session_;
    stream_ = std::make_unique<Stream>(Stream{settings.units, shm::Publisher(session, info, waiting), {}});
    LOG_INFO << "Wade: session " << session << " waits for a consumer";
    stream_->publisher.wait_for_consumers(1);
}

void ParticleExporter_Wade::publish() {
    if (!stream_) open();
    shm::Publisher& publisher = stream_->publisher;
    if (interrupted_ && interrupted_()) throw shm::Error(shm::Failure::interrupted, "interrupted by a signal");
    shm::Diagnostics diagnostics;
    diagnostics.solver_ns = static_cast<std::uint64_t>(1e9 * std::max(0.0, seconds_since(computing_since_)));
    const auto slot = publisher.begin_frame();
    if (!slot) {
        outcome_.consumers_left = true;
        stop_simulation();
        return;
    }
    Simulation& simulation = *Simulation::getCurrent();
    outcome_.particles = store_fluids(simulation, stream_->units, *slot);
    TimeManager& simulator_clock = *TimeManager::getCurrent();
    const auto step = static_cast<double>(simulator_clock.getTimeStepSize());
    const double time = stream_->clock.advance(static_cast<double>(simulator_clock.getTime()), step);
    const std::uint64_t tick = tick_of_time(stream_->units, time, slot->frame);
    diagnostics.last_dt_s = step * stream_->units.time_scale;
    diagnostics.recycled_particles = recycled_particles(simulation);
    const bool final = slot->frame == last_frame_;
    publisher.end_frame(outcome_.particles, diagnostics, final, tick);
    outcome_.frames = slot->frame;
    outcome_.frame_hash = publisher.frame_hash();
    if (final) stop_simulation();
}

void ParticleExporter_Wade::step(const unsigned int) {
    if (!m_active || ended_) return;
    const auto start = std::chrono::steady_clock::now();
    try {
        publish();
    } catch (const std::exception& error) {
        fail(error);
    }
    outcome_.publish_s += seconds_since(start);
    computing_since_ = std::chrono::steady_clock::now();
}

void ParticleExporter_Wade::reset() {
    if (stream_) stream_->publisher.abort(1, "the simulation was reset");
    stream_.reset();
    ended_ = false;
    outcome_ = {};
}

void ParticleExporter_Wade::finish() {
    if (!stream_) return;
    const auto start = std::chrono::steady_clock::now();
    try {
        stream_->publisher.close();
    } catch (const std::exception& error) {
        fail(error);
    }
    outcome_.publish_s += seconds_since(start);
    stream_.reset();
    ended_ = true;
}

void ParticleExporter_Wade::fail(const std::exception& error) {
    const auto* failure = dynamic_cast<const shm::Error*>(&error);
    const bool bad_argument = dynamic_cast<const std::invalid_argument*>(&error) != nullptr;
    outcome_.exit_code = failure ? failure->exit_code() : bad_argument ? 2 : 1;
    outcome_.reason = error.what();
    LOG_ERR << "Wade: " << outcome_.reason;
    if (stream_) stream_->publisher.abort(outcome_.exit_code, outcome_.reason);
    stream_.reset();
    stop_simulation();
}

void ParticleExporter_Wade::stop_simulation() {
    ended_ = true;
    // Both of the simulator's loops end when the time has passed this value, which must be above 0.
    m_base->setValue<Real>(parameter(SimulatorBase::STOP_AT), static_cast<Real>(1e-6));
}

}  // namespace SPH
