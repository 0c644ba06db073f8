#pragma once
// SPHERIC test 2: what was measured. The experiment is MARIN's; K. M. T. Kleefsman, G. Fekken, A. E. P. Veldman,
// B. Iwanowski and B. Buchner, A volume-of-fluid based simulation method for wave impact problems, J. Comput. Phys. 206
// (2005), 363-393; data published by SPHERIC, R. Issa and D. Violeau, Test-case 2: 3D dambreaking (2006).
//
// A short table derived from the published series is part of the program. The series itself is not: users who have it
// name its folder in the environment variable WADE_SPHERIC2_DATA.

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

namespace wade::validation {

struct Spheric2Reference {
    bool series = false;                          // the whole series, not the table
    std::vector<double> time;                     // s
    std::array<std::vector<double>, 4> height{};  // m, gauges H1 to H4
    std::array<std::vector<double>, 2> pressure;  // Pa, sensors P1 and P3; averages over the 20 ms round `time`
    std::array<double, 3> arrival{};              // s, at H1 to H3
    std::array<double, 2> peak{};                 // Pa, of P1 and P3, of averages over 20 ms
    std::array<double, 2> peak_time{};            // s
};

// A gauge is reached when its height first exceeds this, m. About one layer of particles at the coarsest spacing; the
// gauges' noise is 0.001 m.
inline constexpr double spheric2_arrival_height = 0.03;

// Returns the first time, s, when a height exceeds spheric2_arrival_height, linear between the samples; NaN: never.
double arrival_time(const std::vector<double>& time, const std::vector<double>& height);

// The table: every 0.25 s from 0 to 3 s.
Spheric2Reference spheric2_table();

// Reads the series from a CSV file; its header names at least t_s, H1_m to H4_m, P1_Pa and P3_Pa, in rows 20 ms apart
// up to 3 s and more, pressures averaged over the 20 ms round t_s. Throws ConfigurationError with file and reason.
Spheric2Reference spheric2_series(const std::filesystem::path& file);

// spheric_test2_50Hz_boxavg.csv in the folder that WADE_SPHERIC2_DATA names; the table if it is not set.
Spheric2Reference spheric2_reference();

}  // namespace wade::validation
