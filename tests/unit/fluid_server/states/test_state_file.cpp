#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/dfsph/dfsph_model.hpp"
#include "fluid_server/make_model.hpp"
#include "fluid_server/server/state_options.hpp"
#include "fluid_server/states/state_file.hpp"

using namespace wade;
using namespace wade::fluid;
using Catch::Matchers::Contains;

namespace {

LoadedScene loaded_scene(const std::string& flow) {
    const std::string text = R"({
        "name": "stored", "world": { "length_m": 10, "width_m": 4 },
        "channel": { "x_min_m": 0, "x_max_m": 10, "z_min_m": 0, "z_max_m": 4, "flow": ")" +
                             flow + R"(", "depth_m": 1)" +
                             (flow == "closed" ? R"(, "water_blocks": [
            { "x_min_m": 0, "x_max_m": 4, "z_min_m": 0, "z_max_m": 4, "depth_m": 1 }])"
                                               : R"(, "velocity_m_s": 2.5)") +
                             R"( }, "fluid": { "particle_spacing_m": 0.5, "max_particles": 1000 } })";
    return load_scene_text(text, "stored.json");
}

// A folder of its own that goes with the test.
struct Folder {
    Folder() {
        static int n = 0;
        path = std::filesystem::temp_directory_path() /
               ("wade-state-" + std::to_string(::getpid()) + "-" + std::to_string(++n));
        std::filesystem::create_directory(path);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::filesystem::path path;
};

std::string content(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string text;
    for (char c = 0; stream.get(c);) text += c;
    return text;
}

void put(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

std::string changed(std::string bytes, std::size_t at, char to) {
    bytes[at] = to;
    return bytes;
}

FluidState state_of(const LoadedScene& loaded, std::uint64_t frames) {
    DfsphModel model(loaded.scene);
    for (std::uint64_t f = 0; f < frames; ++f) model.advance_frame({f * 100'000, (f + 1) * 100'000, 3'000'000});
    return *model.state();
}

}  // namespace

TEST_CASE("a state comes back from its file with the same bits", "[fluid][state]") {
    const Folder folder;
    const std::filesystem::path file = folder.path / "water.state";
    for (const std::string flow : {"emitter", "closed"}) {
        const LoadedScene loaded = loaded_scene(flow);
        const FluidState state = state_of(loaded, 60);
        write_state(file, state, loaded.canonical_json);
        CHECK_FALSE(std::filesystem::exists(folder.path / "water.state.part"));
        const FluidState read = read_state(file);
        CHECK(read.scene.hash == loaded.scene.hash);
        CHECK(read.frame == 60);
        CHECK(read.time == state.time);
        CHECK(read.particles.count == state.particles.count);
        CHECK(read.emitter.has_value() == (flow == "emitter"));
        // All the rest: what is written again is the same file.
        const std::string bytes = content(file);
        write_state(folder.path / "again.state", read, loaded.canonical_json);
        CHECK(content(folder.path / "again.state") == bytes);
        CHECK(bytes.size() == 128 + 33 * state.particles.count + loaded.canonical_json.size());
    }
}

TEST_CASE("a file that is not a whole state is refused with field, value and what is allowed", "[fluid][state]") {
    const Folder folder;
    const std::filesystem::path file = folder.path / "water.state";
    const LoadedScene loaded = loaded_scene("closed");
    const FluidState state = state_of(loaded, 2);
    write_state(file, state, loaded.canonical_json);
    const std::string good = content(file);
    const auto refused = [&](const std::string& bytes, const std::string& text) {
        put(file, bytes);
        CHECK_THROWS_AS(read_state(file), ConfigurationError);
        CHECK_THROWS_WITH(read_state(file), Contains(file.string() + ": ") && Contains(text));
    };
    refused("", "size in bytes is 0; allowed: at least 128");
    refused(good.substr(0, 127), "size in bytes is 127");
    refused(good.substr(0, 128), "file bytes is " + std::to_string(good.size()) + "; allowed: 128");
    refused(good.substr(0, good.size() - 1), "it may have been cut off");
    refused(good + "x", "file bytes is");
    refused(changed(good, 0, 'W'), "\"wadestat\"");
    refused(changed(good, 8, 2), "version is 2; allowed: 1");
    refused(changed(good, 12, 64), "header bytes is 64; allowed: 128");
    refused(changed(good, 39, 1), "particles is");  // its most significant byte
    refused(changed(good, 40, static_cast<char>(good[40] + 1)), "scene bytes is");
    refused(changed(good, 72, 1), "checksum is");
    refused(changed(good, 500, static_cast<char>(good[500] ^ 1)), "checksum is");
    refused(changed(good, good.size() - 2, 'x'), "checksum is");

    const auto refused_state = [&](FluidState bad, const std::string& json, const std::string& text) {
        write_state(file, bad, json);
        CHECK_THROWS_WITH(read_state(file), Contains(file.string()) && Contains(text));
    };
    FluidState bad = state;
    bad.particles.vy[3] = std::numeric_limits<float>::quiet_NaN();
    refused_state(bad, loaded.canonical_json, "vy[3] is nan; allowed: finite numbers");
    bad = state;
    bad.particles.kind[5] = Kind::inflow;
    refused_state(bad, loaded.canonical_json, "kind[5] is 1; allowed: 0 (no emitter)");
    bad = state;
    bad.emitter = EmitterState{};
    refused_state(bad, loaded.canonical_json, "emitter is 1; allowed: 0");
    bad = state;
    bad.time = -1;
    refused_state(bad, loaded.canonical_json, "time is -1");
    refused_state(state, "{ \"duration_s\": \"long\" }", "/duration_s");

    CHECK_THROWS_WITH(read_state(folder.path / "none.state"), Contains("none.state: No such file"));
    CHECK_THROWS_WITH(read_state(folder.path), Contains(folder.path.string()));
}

TEST_CASE("a state that cannot be written is an error with file and reason and leaves no part", "[fluid][state]") {
    const Folder folder;
    const LoadedScene loaded = loaded_scene("closed");
    const FluidState state = state_of(loaded, 0);
    const std::filesystem::path place = folder.path / "no" / "water.state";
    CHECK_THROWS_WITH(write_state(place, state, loaded.canonical_json), Contains(place.string() + ": No such file"));
    std::filesystem::create_directory(folder.path / "folder");
    CHECK_THROWS_AS(write_state(folder.path / "folder", state, loaded.canonical_json), RunError);
    CHECK_FALSE(std::filesystem::exists(folder.path / "folder.part"));
}

TEST_CASE("a place for a state is checked before the run", "[fluid][state]") {
    const Folder folder;
    LoadedScene loaded = loaded_scene("emitter");
    DfsphModel model(loaded.scene);
    CHECK_NOTHROW(check_can_save_state(model, folder.path / "a.state"));
    CHECK_NOTHROW(check_can_save_state(model, "a.state"));
    CHECK_THROWS_WITH(check_can_save_state(model, folder.path / "no" / "a.state"), Contains("--save-state"));
    CHECK_THROWS_WITH(check_can_save_state(model, folder.path), Contains("--save-state"));
    loaded.scene.fluid->model = wade::ModelKind::kinematic;
    const auto stream = make_fluid_model(loaded.scene);
    CHECK_THROWS_WITH(check_can_save_state(*stream, folder.path / "a.state"), Contains("/fluid/model is kinematic"));
}
