#include "fluid_server/states/state_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <system_error>

#include "configs/errors/exit_code.hpp"
#include "configs/files/plain_file.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/numbers/fnv1a.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"

namespace wade::fluid {

namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian and written as it lies in memory");

constexpr char magic[8] = {'w', 'a', 'd', 'e', 's', 't', 'a', 't'};
constexpr std::uint32_t layout_version = 1;

struct Header {
    char magic[8];
    std::uint32_t version;
    std::uint32_t header_bytes;
    std::uint64_t file_bytes;
    std::uint64_t checksum;
    std::uint64_t particles;
    std::uint64_t scene_bytes;
    double time;
    std::uint64_t frame;
    std::uint64_t position_clamps;
    std::uint64_t has_emitter;
    double last_layer_x;
    std::uint64_t stock;
    std::uint64_t recycled;
    std::uint64_t layers_missed;
    std::uint64_t reserved[2];
};
static_assert(sizeof(Header) == 128 && offsetof(Header, time) == 48 && offsetof(Header, layers_missed) == 104);

constexpr std::uint64_t particle_bytes = particle_arrays.size() * sizeof(float) + sizeof(Kind);
// Limits of /fluid/max_particles and of the texts of scenes.
constexpr std::uint64_t most_particles = 100'000'000, most_scene_bytes = std::uint64_t{64} << 20;

std::uint64_t hash_of_words(std::string_view bytes, std::uint64_t hash = fnv1a_basis) {
    while (!bytes.empty()) {
        std::uint64_t word = 0;
        const std::size_t n = std::min(sizeof word, bytes.size());
        std::memcpy(&word, bytes.data(), n);
        hash = fnv1a_next(hash, word);
        bytes.remove_prefix(n);
    }
    return hash;
}

// Over the header, its checksum taken as 0, and all that follows.
std::uint64_t checksum(std::string bytes) {
    constexpr std::uint64_t zero = 0;
    std::memcpy(bytes.data() + offsetof(Header, checksum), &zero, sizeof zero);
    return hash_of_words(bytes);
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& field, const std::string& value,
                         const std::string& allowed) {
    throw ConfigurationError(file.string() + ": " + field + " is " + value + "; allowed: " + allowed);
}

void require(bool holds, const std::filesystem::path& file, const std::string& field, std::uint64_t value,
             const std::string& allowed) {
    if (!holds) refuse(file, field, std::to_string(value), allowed);
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
    throw ConfigurationError("cannot read the state of the fluid in " + file.string() + ": " + reason);
}

void read_at(const PlainFile& plain, const std::filesystem::path& file, std::uint64_t from, void* into,
             std::size_t bytes) {
    if (plain.read(from, into, bytes) != bytes) fail(file, "it ends before its size");
}

// The checksum of a file in pieces, so that a file that claims much takes no memory before it proves to be whole.
std::uint64_t checksum_of(const PlainFile& plain, const std::filesystem::path& file, Header h) {
    h.checksum = 0;
    std::uint64_t hash = hash_of_words({reinterpret_cast<const char*>(&h), sizeof h});
    std::string piece(std::size_t{1} << 20, '\0');
    for (std::uint64_t at = sizeof h; at < h.file_bytes; at += piece.size()) {
        piece.resize(std::min<std::uint64_t>(piece.size(), h.file_bytes - at));
        read_at(plain, file, at, piece.data(), piece.size());
        hash = hash_of_words(piece, hash);
    }
    return hash;
}

Header checked_header(const std::filesystem::path& file, const PlainFile& plain) {
    if (!plain.is_open()) fail(file, plain.problem());
    const std::uint64_t size = plain.bytes();
    Header h{};
    require(size >= sizeof h, file, "size in bytes", size, "at least 128; this is no state of the fluid");
    read_at(plain, file, 0, &h, sizeof h);
    if (std::memcmp(h.magic, magic, sizeof magic) != 0) {
        refuse(file, "the beginning", "something else", "\"wadestat\"; this is no state of the fluid");
    }
    require(h.version == layout_version, file, "version", h.version, std::to_string(layout_version));
    require(h.header_bytes == sizeof h, file, "header bytes", h.header_bytes, "128");
    require(h.file_bytes == size, file, "file bytes", h.file_bytes,
            std::to_string(size) + ", the size of the file; it may have been cut off");
    const std::uint64_t body = size - sizeof h;
    require(h.particles <= body / particle_bytes, file, "particles", h.particles,
            "0 to " + std::to_string(body / particle_bytes) + ", as many as the file has room for");
    require(h.particles <= most_particles, file, "particles", h.particles, "0 to " + std::to_string(most_particles));
    const std::uint64_t rest = body - h.particles * particle_bytes;
    require(h.scene_bytes == rest, file, "scene bytes", h.scene_bytes, std::to_string(rest) + ", the rest of the file");
    require(rest <= most_scene_bytes, file, "scene bytes", rest, "0 to " + std::to_string(most_scene_bytes));
    const std::uint64_t sum = checksum_of(plain, file, h);
    require(h.checksum == sum, file, "checksum", h.checksum,
            std::to_string(sum) + ", that of the content; the file is damaged");
    return h;
}

void check_values(const std::filesystem::path& file, const Header& h, const Scene& scene) {
    if (!std::isfinite(h.time) || h.time < 0) refuse(file, "time", std::to_string(h.time), "0 s and more");
    if (!std::isfinite(h.last_layer_x)) refuse(file, "x of the last layer", "not finite", "finite numbers");
    const bool emitter = scene.channel->flow == Flow::emitter;
    require(h.has_emitter == (emitter ? 1U : 0U), file, "emitter", h.has_emitter,
            emitter ? "1, as the scene in it has one" : "0, as the scene in it has none");
    const auto room = static_cast<std::uint64_t>(scene.fluid->max_particles);
    require(h.particles <= room, file, "particles", h.particles, "0 to " + std::to_string(room) + ", max_particles");
    require(h.stock <= room - h.particles, file, "stock", h.stock,
            "0 to " + std::to_string(room - h.particles) + ", max_particles less the particles");
}

void check_particles(const std::filesystem::path& file, const Particles& p, bool emitter) {
    for (const auto& [name, values] : particle_arrays) {
        for (std::size_t i = 0; i < p.count; ++i) {
            const float v = (p.*values)[i];
            if (!std::isfinite(v)) {
                refuse(file, std::string(name) + "[" + std::to_string(i) + "]", std::to_string(v), "finite numbers");
            }
        }
    }
    const auto last = static_cast<unsigned>(emitter ? Kind::inflow : Kind::fluid);
    for (std::size_t i = 0; i < p.count; ++i) {
        const auto kind = static_cast<unsigned>(p.kind[i]);
        require(kind <= last, file, "kind[" + std::to_string(i) + "]", kind, emitter ? "0 and 1" : "0 (no emitter)");
    }
}

template <typename T>
void append(std::string& bytes, const std::vector<T>& values, std::size_t n) {
    bytes.append(reinterpret_cast<const char*>(values.data()), n * sizeof(T));
}

}  // namespace

void replace_file(const std::filesystem::path& file, std::string_view content) {
    std::filesystem::path part = file;
    part += ".part";
    const int descriptor = open_anew(part);
    int error = descriptor < 0 ? errno : 0;
    while (error == 0 && !content.empty()) {
        const ssize_t written = ::write(descriptor, content.data(), content.size());
        if (written > 0) content.remove_prefix(static_cast<std::size_t>(written));
        if (written < 0 && errno != EINTR) error = errno;
    }
    // Some devices cannot be flushed; that is no loss of content.
    if (error == 0 && ::fsync(descriptor) != 0 && errno != EINVAL && errno != EROFS) error = errno;
    if (descriptor >= 0 && ::close(descriptor) != 0 && error == 0) error = errno;
    if (error == 0 && ::rename(part.c_str(), file.c_str()) != 0) error = errno;
    if (error == 0) return;
    if (descriptor >= 0) ::unlink(part.c_str());
    throw RunError(ExitCode::unexpected, "cannot write " + file.string() + ": " + std::strerror(error));
}

void write_state(const std::filesystem::path& file, const FluidState& state, const std::string& scene_json) {
    const Particles& p = state.particles;
    const EmitterState emitter = state.emitter.value_or(EmitterState{});
    Header h{};
    std::memcpy(h.magic, magic, sizeof magic);
    h.version = layout_version;
    h.header_bytes = sizeof h;
    h.file_bytes = sizeof h + p.count * particle_bytes + scene_json.size();
    h.particles = p.count;
    h.scene_bytes = scene_json.size();
    h.time = state.time;
    h.frame = state.frame;
    h.position_clamps = state.position_clamps;
    h.has_emitter = state.emitter ? 1 : 0;
    h.last_layer_x = emitter.last_layer_x;
    h.stock = emitter.stock;
    h.recycled = emitter.recycled;
    h.layers_missed = emitter.layers_missed;

    std::string bytes(sizeof h, '\0');
    bytes.reserve(h.file_bytes);
    for (const auto& [name, values] : particle_arrays) append(bytes, p.*values, p.count);
    append(bytes, p.kind, p.count);
    bytes += scene_json;
    std::memcpy(bytes.data(), &h, sizeof h);
    h.checksum = checksum(bytes);
    std::memcpy(bytes.data(), &h, sizeof h);
    replace_file(file, bytes);
}

bool is_state_or_new(const std::filesystem::path& file) {
    if (!std::filesystem::exists(std::filesystem::symlink_status(file))) return true;
    char begin[sizeof magic] = {};
    return PlainFile(file).read(0, begin, sizeof begin) == sizeof begin && std::memcmp(begin, magic, sizeof magic) == 0;
}

FluidState read_state(const std::filesystem::path& file) {
    const PlainFile plain(file);
    const Header h = checked_header(file, plain);
    FluidState state;
    std::string scene(h.scene_bytes, '\0');
    read_at(plain, file, h.file_bytes - h.scene_bytes, scene.data(), scene.size());
    state.scene = load_scene_text(scene, file.string() + ": scene").scene;
    check_values(file, h, state.scene);
    state.time = h.time;
    state.frame = h.frame;
    state.position_clamps = h.position_clamps;
    if (h.has_emitter == 1) state.emitter = EmitterState{h.last_layer_x, h.stock, h.recycled, h.layers_missed};
    state.particles = Particles(h.particles);
    state.particles.count = h.particles;
    std::uint64_t at = sizeof h;
    const auto take = [&](auto& values) {
        const std::size_t bytes = h.particles * sizeof values[0];
        read_at(plain, file, at, values.data(), bytes);
        at += bytes;
    };
    for (const auto& [name, values] : particle_arrays) take(state.particles.*values);
    take(state.particles.kind);
    check_particles(file, state.particles, state.emitter.has_value());
    return state;
}

}  // namespace wade::fluid
