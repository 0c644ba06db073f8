#pragma once
// How wrong and how dear each model was, measured: what the choice of the model rests on.
//
// table.csv is written by `tools/wade model-choice --table write` from the speed-against-error report and from what was
// measured beside it (tests/validation/data/model_choice.csv). A new model becomes a candidate by rows for it.

#include <string>
#include <string_view>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade::fluid::model_choice {

// Kinds of water by what makes it hard for a model; each was measured in a scene of its own.
enum class WaterKind {
    river,      // flows past the people from the start on
    dry_front,  // blocks of water that spread over a dry bed
    wet_front,  // waves that run over water
    inflow,     // an emitter floods a bed, the water leaves at a fall
    lee         // water round obstacles
};
inline constexpr std::size_t water_kinds = 5;

// As in the table: "river", "dry_front", "wet_front", "inflow", "lee".
[[nodiscard]] std::string_view name_of(WaterKind kind);

// A model with all that was set of it. Empty texts: the model does not know the value.
struct Settings {
    std::string model;                                         // as /fluid/model
    double spacing = 0;                                        // d, or the size of the cells, m, in water 1 m deep
    std::string tolerance, divergence_tolerance, cfl, kernel;  // divergence_tolerance: a number or "off"

    friend bool operator==(const Settings&, const Settings&) = default;
};

struct TableRow {
    WaterKind kind = WaterKind::river;
    Settings settings;
    double impulse_median = 0;      // relative error of the impulse on standing people, median over them
    double impulse_p95 = 0;         // 95th percentile
    double steps_per_s = 0;         // time steps per simulated second
    double particle_step_cost = 0;  // s of CPU time on the machine of the report
    double wave_speed = 0;          // sqrt(g depth) + v_F of the scene that was measured, m/s
};

// The depth of the water and the contact distance that the table was measured with, m.
inline constexpr double table_depth = 1;
inline constexpr double table_contact_distance = 0.25;

// Reads the table; lines that begin with '#' are skipped. Throws std::runtime_error, naming the line, for a wrong one.
[[nodiscard]] std::vector<TableRow> parse_table(std::string_view text);

// The text of table.csv, and its rows.
[[nodiscard]] std::string_view measured_table_text();
[[nodiscard]] const std::vector<TableRow>& measured_table();

}  // namespace wade::fluid::model_choice
