// Prints what the programs read of a file of a site: read_site_file raster|map|series FILE. Exit code 2 for a file that is refused.

#include <cstdio>
#include <exception>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/files/geojson.hpp"
#include "configs/files/raster_file.hpp"
#include "configs/files/series_csv.hpp"

namespace {

void print_raster(const std::string& file) {
    const wade::RasterFile read = wade::read_raster(file);
    const wade::Raster& r = read.raster;
    std::printf("%zu %zu %.17g %.17g %.17g %d\n", r.columns, r.rows, r.x, r.z, r.cell, read.epsg.value_or(0));
    for (const double value : r.values) std::printf("%.17g\n", value);
}

void print_line(const wade::MapLine& line) {
    for (const wade::MapPoint& p : line) std::printf("%.17g %.17g ", p.x, p.z);
    std::printf("\n");
}

void print_map(const std::string& file) {
    for (const wade::MapFeature& feature : wade::read_geojson(file).features) {
        for (const wade::MapLine& ring : feature.polygon.rings) print_line(ring);
        if (!feature.line.empty()) print_line(feature.line);
    }
}

void print_series(const std::string& file) {
    const wade::Key key{"level_m", wade::KeyKind::number, "", "m", wade::from(-500).to(9000)};
    for (const wade::SeriesPoint& p : wade::read_series(file, key)) std::printf("%.17g %.17g\n", p.time, p.value);
}

}  // namespace

int main(int count, char** words) {
    if (count != 3) return 1;
    const std::string kind = words[1], file = words[2];
    try {
        if (kind == "raster") print_raster(file);
        if (kind == "map") print_map(file);
        if (kind == "series") print_series(file);
    } catch (const wade::ConfigurationError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
    return 0;
}
