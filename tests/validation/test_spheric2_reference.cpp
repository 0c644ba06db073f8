// The table of SPHERIC test 2 and the reader of the whole series.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "spheric2_reference.hpp"

using namespace wade;
using namespace wade::validation;

namespace {

// A made-up series: a front passes H1 at 1 s and the pressure at P1 peaks at 2 s.
std::filesystem::path write_series(const std::string& header, int rows) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("wade-spheric2-" + std::to_string(::getpid()) + ".csv");
    std::ofstream out(file);
    out << header << '\n';
    for (int k = 0; k < rows; ++k) {
        const double t = 0.02 * k;
        out << t << ",0,0," << (t > 0.99 ? 0.06 : 0) << ",0.55," << (k == 100 ? 5000 : 100) << ",50\n";
    }
    return file;
}

}  // namespace

TEST_CASE("the table covers three seconds", "[spheric2]") {
    const Spheric2Reference table = spheric2_table();
    CHECK_FALSE(table.series);
    CHECK(table.time.back() == 3);
    for (const auto& height : table.height) {
        CHECK(height.size() == table.time.size());
    }
    for (const auto& pressure : table.pressure) {
        CHECK(pressure.size() == table.time.size());
    }
    CHECK(table.height[3][0] == 0.55);
}

TEST_CASE("an arrival lies between two samples", "[spheric2]") {
    CHECK(arrival_time({0, 1, 2}, {0, 0.01, 0.05}) == Approx(1.5));
    CHECK(arrival_time({0, 1}, {0.1, 0.1}) == 0);
    CHECK(std::isnan(arrival_time({0, 1}, {0, 0.02})));
}

TEST_CASE("a series is read by the names of its columns", "[spheric2]") {
    const std::filesystem::path file = write_series("t_s,H3_m,H2_m,H1_m,H4_m,P1_Pa,P3_Pa", 201);
    const Spheric2Reference series = spheric2_series(file);
    CHECK(series.series);
    CHECK(series.time.size() == 151);
    CHECK(series.arrival[0] == Approx(0.99).margin(0.011));
    CHECK(std::isnan(series.arrival[1]));
    CHECK(series.peak[0] == 5000);
    CHECK(series.peak_time[0] == Approx(2));
    CHECK(series.peak[1] == 50);
    std::filesystem::remove(file);
}

TEST_CASE("a series that is not one is refused", "[spheric2]") {
    CHECK_THROWS_AS(spheric2_series("no/such/file.csv"), ConfigurationError);
    const std::filesystem::path unnamed = write_series("t_s,H3_m,H2_m,H1_m,H4_m,P1_Pa,P2_Pa", 201);
    CHECK_THROWS_AS(spheric2_series(unnamed), ConfigurationError);
    const std::filesystem::path shorter = write_series("t_s,H3_m,H2_m,H1_m,H4_m,P1_Pa,P3_Pa", 100);
    CHECK_THROWS_AS(spheric2_series(shorter), ConfigurationError);
    std::filesystem::remove(shorter);
}
