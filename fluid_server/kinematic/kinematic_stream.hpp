#pragma once
// A stream of given depth and velocity: nothing is solved.
//
//    x.lo                              x.hi
//      |    front | .  |.   |  . | .  |  .|    Layers, one above the other, of strips, one beside the other. A strip
//      |    front |  . |  . |.   |   .|.  |    is a row of cells of one length with a particle somewhere in each; it
//      |============== bed ===============|    moves as a whole.
//
// The position in its cell is a random number of (seed, strip, cell), and the strips' place is a function of the time,
// so that a frame depends on nothing but its tick. In the arrangement `lattice` the particle is at a quarter of its cell
// along and across, in every other layer at three quarters (body-centred; a single layer: in the middle), and deviates
// from there by up to half of `jitter` cells; where that would lead out of the cell, it comes in at the other side. There are depth / spacing layers, rounded; a particle has the mass
// rest_density * spacing^3 and the mean velocity of its layer, and a cell is as long as it takes to have the mass
// rest_density * depth over each square metre of the bed.

#include <vector>

#include "configs/scene/interval.hpp"
#include "fluid_server/estimate.hpp"
#include "fluid_server/fluid_model.hpp"
#include "fluid_server/kinematic/velocity_profile.hpp"

namespace wade::fluid {

class KinematicStream final : public FluidModel {
 public:
    // Needs a scene that flows (emitter or recirculating).
    explicit KinematicStream(const Scene& scene);

    [[nodiscard]] static Estimate estimate(const Scene& scene);

    [[nodiscard]] std::string_view name() const override { return "kinematic"; }
    [[nodiscard]] std::uint32_t capacity() const override { return capacity_; }
    shm::Diagnostics advance_frame(const FrameInterval& interval) override;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override;

 private:
    struct Strip {
        float y = 0;
        double z_lo = 0;         // m
        double cell_length = 0;  // m
        double velocity = 0;     // m/s towards -x, the mean of the layer
        std::uint64_t random_key = 0;
        double lattice_point = 0.5;   // along and across, in cells
        std::int64_t cells = 0;       // of a recirculating channel
        double travel = 0;            // m since t = 0, less than a round in a recirculating channel
        std::int64_t first_cell = 0;  // cells in the channel at the time of the frame; cell 0 is the first behind the
        std::int64_t end_cell = 0;    // front of a dry start, counted upstream
        std::int64_t first_at_start = 0;
        std::size_t offset = 0;  // of its particles in the frame
    };

    // Where in its cell a particle is, both in [0, 1).
    struct InCell {
        double along, across;
    };

    void make_strips(const Scene& scene);
    [[nodiscard]] InCell in_cell(const Strip& strip, std::int64_t cell) const;
    void place_at(double time);
    void find_cells(Strip& strip) const;
    [[nodiscard]] std::size_t count() const;
    [[nodiscard]] double place(const Strip& strip, std::int64_t cell, double in_cell) const;
    void write_strip(const Strip& strip, const shm::FrameFields& slot) const;

    Interval x_;
    bool periodic_;
    bool dry_start_;
    double transport_factor_;
    bool lattice_;
    double jitter_;
    double gravity_;
    double particle_mass_;
    double strip_width_ = 0;
    std::uint32_t capacity_ = 1;
    std::vector<Strip> strips_;
};

}  // namespace wade::fluid
