#pragma once
// A particle exporter of SPlisHSPlasH that publishes each exported frame to a Wade session.
//
// Settings are the block "Wade" of the scene file (README.md lists its keys), the frame rate is dataExportFPS, and the
// exporter is switched on by "enableWadeExport". No exception leaves it: a failure ends the stream and the simulation.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "Simulator/Exporter/ExporterBase.h"

namespace wade::splishsplash {

// How the stream went so far.
struct ExportOutcome {
    int exit_code = 0;   // of this contract: 0 ok, 2 bad configuration, 3 to 8 and 130 as in docs/protocol.md
    std::string reason;  // one sentence if exit_code is not 0
    bool consumers_left = false;
    std::uint64_t frames = 0;
    std::uint64_t frame_hash = 0;
    std::uint32_t particles = 0;  // of the last frame
    double publish_s = 0;         // wall time spent here, waiting for consumers included
};

}  // namespace wade::splishsplash

namespace SPH {

class ParticleExporter_Wade final : public ExporterBase {
 public:
    explicit ParticleExporter_Wade(SimulatorBase* base);
    ~ParticleExporter_Wade() override;

    void step(const unsigned int frame) override;  // the simulator's frame number is not used: a stream counts its own
    void reset() override;                         // a simulation that starts anew is another stream

    // For programs that do not take these from the scene. Call before the first frame.
    void set_session(const std::string& session) { session_ = session; }
    void set_last_frame(std::uint64_t frame) { last_frame_ = frame; }  // marked as final; 0 = open end
    void set_interrupted(std::function<bool()> interrupted) { interrupted_ = std::move(interrupted); }

    // Waits until all have acknowledged the last frame and removes the segment.
    void finish();

    [[nodiscard]] const wade::splishsplash::ExportOutcome& outcome() const { return outcome_; }

 private:
    struct Stream;

    void open();
    void publish();
    void fail(const std::exception& error);
    void stop_simulation();

    std::string session_;
    std::uint64_t last_frame_ = 0;
    std::function<bool()> interrupted_;
    std::unique_ptr<Stream> stream_;
    bool ended_ = false;
    std::chrono::steady_clock::time_point computing_since_;
    wade::splishsplash::ExportOutcome outcome_;
};

}  // namespace SPH
