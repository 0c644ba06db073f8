#pragma once
// A state of the fluid as a file, little-endian:
//
//   offset  type     what
//        0  char[8]  "wadestat"
//        8  u32      version of this layout, 1
//       12  u32      bytes of the header, 128
//       16  u64      bytes of the file
//       24  u64      FNV-1a over the 64-bit words of the file, this word taken as 0
//       32  u64      particles n
//       40  u64      bytes of the scene
//       48  f64      time since t = 0, s
//       56  u64      frames since t = 0
//       64  u64      position clamps since t = 0
//       72  u64      1: there is an emitter, 0: none; the four values below are then 0
//       80  f64      x of the emitter's rearmost layer, m
//       88  u64      its stock, particles
//       96  u64      particles recycled
//      104  u64      layers missed
//      112  u64[2]   0
//      128  f32[n]   x, y, z, vx, vy, vz, shift_pressure, pressure (particle_arrays), one after another
//           u8[n]    kind
//           char[]   the scene as canonical JSON, with every default

#include <filesystem>
#include <string>
#include <string_view>

#include "fluid_server/states/fluid_state.hpp"

namespace wade::fluid {

// Replaces `file` by `content` in one step: a temporary file beside it is written, flushed to the disk and renamed.
// Throws RunError (exit code 1) with file and reason; an old file then stays.
void replace_file(const std::filesystem::path& file, std::string_view content);

// Writes the state; `scene_json` is the canonical JSON of state.scene. Throws as replace_file().
void write_state(const std::filesystem::path& file, const FluidState& state, const std::string& scene_json);

// Whether a state may be written there: nothing is there, or a state.
[[nodiscard]] bool is_state_or_new(const std::filesystem::path& file);

// Reads a state. Throws ConfigurationError (exit code 2) with file, field, value and what is allowed unless every part
// of the file is what it must be.
[[nodiscard]] FluidState read_state(const std::filesystem::path& file);

}  // namespace wade::fluid
