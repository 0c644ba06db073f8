// Bands of rows over ranks, here threads of this process: each bit is that of one process.
#include <algorithm>
#include <barrier>
#include <catch2/catch.hpp>
#include <cstring>
#include <functional>
#include <thread>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/shallow_water/model.hpp"
#include "tests/validation/site_scenes.hpp"
#include "waters.hpp"

namespace wade::fluid::shallow_water {
namespace bands_test {

// What the threads hand one another between two barriers.
struct Board {
    explicit Board(std::size_t ranks)
        : gate(static_cast<std::ptrdiff_t>(ranks)),
          lower(ranks),
          upper(ranks),
          values(ranks),
          merged(ranks),
          parts(ranks) {}
    std::barrier<> gate;
    std::vector<Ranks::Neighbour> lower, upper;
    std::vector<double> values;
    std::vector<std::span<std::uint64_t>> merged;
    std::vector<std::span<const std::uint64_t>> parts;
};

class Threads final : public Ranks {
 public:
    Threads(Board& board, int rank) : board_(board), rank_(rank), own_(static_cast<std::size_t>(rank)) {}
    [[nodiscard]] int rank() const override { return rank_; }
    [[nodiscard]] int count() const override { return static_cast<int>(board_.values.size()); }
    void exchange(const Neighbour& lower, const Neighbour& upper) override {
        board_.lower[own_] = lower, board_.upper[own_] = upper;
        meet([&] {
            const auto take = [](const Neighbour& side, const std::vector<Neighbour>& theirs) {
                if (side.rank < 0) return;
                const std::span<const double> said = theirs[static_cast<std::size_t>(side.rank)].to;
                std::copy(said.begin(), said.end(), side.from.begin());
            };
            take(lower, board_.upper);
            take(upper, board_.lower);
        });
    }
    [[nodiscard]] double largest(double value) override {
        board_.values[own_] = value;
        double most = 0;
        meet([&] { most = *std::max_element(board_.values.begin(), board_.values.end()); });
        return most;
    }
    void merge(std::span<std::uint64_t> words) override {
        board_.merged[own_] = words;
        std::vector<std::uint64_t> sum(words.size(), 0);
        meet([&] {
            for (const std::span<std::uint64_t> part : board_.merged) {
                for (std::size_t n = 0; n < sum.size(); ++n) sum[n] |= part[n];
            }
        });
        std::copy(sum.begin(), sum.end(), words.begin());
    }
    void gather(std::span<const std::uint64_t> part, const std::vector<int>& counts, std::span<std::uint64_t> all,
                bool for_all) override {
        board_.parts[own_] = part;
        meet([&] {
            if (!for_all && !first()) return;
            auto at = all.begin();
            for (std::size_t r = 0; r < counts.size(); ++r) {
                wrong |= board_.parts[r].size() != static_cast<std::size_t>(counts[r]);
                at = std::copy(board_.parts[r].begin(), board_.parts[r].end(), at);
            }
        });
    }
    void tell(std::span<const std::uint64_t>) override {}
    [[nodiscard]] bool hear(std::span<std::uint64_t>) override { return false; }
    void leave(int) override {}

    bool wrong = false;  // whether ranks were told other sizes than they have

 private:
    template <typename Work>
    void meet(Work&& work) {
        board_.gate.arrive_and_wait();
        work();
        board_.gate.arrive_and_wait();
    }
    Board& board_;
    int rank_;
    std::size_t own_;
};

// Frames of a model, each as the bytes of its particles and the numbers that go with it.
struct Frames {
    std::vector<std::vector<float>> particles;
    std::vector<double> numbers;
    std::string remarks;
};

Frames frames_of(ShallowWaterModel& model, std::uint64_t frames, std::uint64_t rate, bool first) {
    Frames result;
    for (std::uint64_t f = 0; f < frames; ++f) {
        const shm::Diagnostics d = model.advance_frame({f, f + 1, rate});
        if (!first) continue;
        std::vector<std::vector<float>> fields(7, std::vector<float>(model.capacity()));
        shm::FrameFields slot{};
        std::size_t n = 0;
        for (auto* field : {&slot.mass, &slot.vx, &slot.vy, &slot.vz, &slot.px, &slot.py, &slot.pz})
            *field = fields[n++];
        const std::uint32_t count = model.write_frame(slot);
        for (std::vector<float>& field : fields) {
            field.resize(count);
            result.particles.push_back(field);
        }
        for (const double number : {d.last_dt_s, d.kinetic_energy_j, d.potential_energy_j})
            result.numbers.push_back(number);
        result.numbers.push_back(static_cast<double>(d.recycled_particles));
        for (const GaugedCell& cell : model.world().gauged)
            result.numbers.insert(result.numbers.end(), {cell.qx, cell.qz});
    }
    if (first) result.remarks = model.remarks();
    return result;
}

void check_bits(const Scene& scene, std::uint64_t frames, std::uint64_t rate,
                std::initializer_list<std::size_t> counts) {
    ShallowWaterModel alone(scene);
    const Frames wanted = frames_of(alone, frames, rate, true);
    for (const std::size_t ranks : counts) {
        INFO(ranks << " ranks");
        Board board(ranks);
        std::vector<Frames> found(ranks);
        std::vector<std::thread> threads;
        std::vector<std::uint8_t> wrong(ranks, 0);
        for (std::size_t r = 0; r < ranks; ++r) {
            threads.emplace_back([&, r] {
                Threads rank(board, static_cast<int>(r));
                ShallowWaterModel model(scene);
                model.spread_over(rank);
                found[r] = frames_of(model, frames, rate, r == 0);
                wrong[r] = rank.wrong;
            });
        }
        for (std::thread& thread : threads) thread.join();
        CHECK(std::count(wrong.begin(), wrong.end(), 0) == static_cast<std::ptrdiff_t>(ranks));
        CHECK(found[0].particles == wanted.particles);
        CHECK(found[0].numbers == wanted.numbers);
        CHECK(found[0].remarks == wanted.remarks);
    }
}

// Water that falls down between houses, with all that comes and goes, through a gate that opens.
Scene site_with_all() {
    Scene scene = validation::empty_site(30, 20, 0.5);
    scene.fluid->model = wade::ModelKind::shallow_water;
    const validation::Turn turn(15, 10, 25);
    Site& site = *scene.site;
    site.ground.slope_x = -0.1, site.ground.level = 4;
    site.roughness.n = 0.03;
    site.roughness.zones = {{turn.box(-4, 4, -4, 4), 0.1}};
    site.houses = {validation::house_of(turn.box(-3, 3, -2, 2)), validation::house_of(turn.box(5, 6, -9, 9))};
    site.sources = {{"hill", turn.box(-13, -10, -2, 2), {}, {{0, 0}, {5, 3}, {10, 1}}}};
    site.rain = {{0, 0}, {2, 3000}, {4, 0}};
    site.water = {{turn.box(-12, -6, -20, 20), 2.5}};
    site.barriers = {{.name = "gate", .line = {turn(-6, -12), turn(-6, 12)}, .opens_at = 1.5},
                     {.name = "levee", .line = {turn(8, -9), turn(8, 9)}, .crest = 1.8}};
    site.gauges = {{"low", {20, 6}}, {"high", {20, 14}}};
    site.outlets = {{"sea", OutletKind::free, {}, {{30, 2}, {30, 10}}, {}},
                    {"lake", OutletKind::stage, {}, {{30, 10}, {30, 14}}, {{0, 1.5}, {4, 2}}},
                    {"sea", OutletKind::wave, {}, {{30, 14}, {30, 18}}, {{0, 1.5}, {4, 2}}}};
    return scene;
}

}  // namespace bands_test

TEST_CASE("a site over ranks gives the bits of one process", "[bands]") {
    bands_test::check_bits(bands_test::site_with_all(), 5, 2, {2, 4});
}

TEST_CASE("what the first rank has of water that runs away is what was last there", "[bands]") {
    Scene scene = validation::empty_site(40, 12, 0.5);
    scene.fluid->model = wade::ModelKind::shallow_water;
    Site& site = *scene.site;
    site.ground.slope_x = -0.2, site.ground.level = 8;
    site.roughness.n = 0;  // so that lines fall dry
    site.water = {{validation::Turn(5, 6, 0).box(-3, 3, -5, 5), 8}};
    site.outlets = {{"sea", OutletKind::free, {}, {{40, 0}, {40, 12}}, {}}};
    for (const std::uint64_t rate : {5U, 7U, 8U}) bands_test::check_bits(scene, 12 * rate, rate, {2, 3});
}

TEST_CASE("channels over ranks give the bits of one process", "[bands]") {
    Scene scene = river(20, 12, 1, 1, 1.5);
    scene.obstacles.push_back({{8, 10}, {3, 7.2}, 2});
    for (const Flow flow : {Flow::recirculating, Flow::emitter, Flow::closed, Flow::periodic}) {
        scene.channel->flow = flow;
        scene.channel->sides = flow == Flow::periodic ? Sides::periodic : scene.channel->sides;
        if (flow == Flow::closed) scene.channel->water_blocks = {{{0, 6}, {0, 5}, 2}};
        INFO("flow " << static_cast<int>(flow));
        bands_test::check_bits(scene, 3, 6, {3});
    }
}

TEST_CASE("what cannot go over ranks is refused by name", "[bands]") {
    bands_test::Board board(1);
    bands_test::Threads alone(board, 0);
    Scene scene = basin(4, 1.5, 0.5);  // three rows
    ShallowWaterModel narrow(scene);
    CHECK_THROWS_WITH(narrow.spread_over(alone), Catch::Contains("3 rows") && Catch::Contains("4 rows a rank"));
    scene = basin(4, 4, 0.5);
    scene.coupling->two_way = true;
    ShallowWaterModel pushed(scene);
    CHECK_THROWS_WITH(pushed.spread_over(alone), Catch::Contains("/coupling/two_way"));
}

}  // namespace wade::fluid::shallow_water
