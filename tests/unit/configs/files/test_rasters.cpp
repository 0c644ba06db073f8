// Rasters of others: numbers that are known are read, and what is damaged is refused without a crash.

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/files/geotiff.hpp"
#include "configs/files/raster_file.hpp"
#include "configs/numbers/splitmix.hpp"
#include "configs/scene/site.hpp"
#include "scene_texts.hpp"

namespace wade::raster_test {

const std::string small_grid =
    "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 2\nNODATA_value -1\n1 2 -1\n4 5.5 +6e0\n";

std::string refusal_of_grid(const std::string& text) {
    try {
        static_cast<void>(read_esri_ascii(text, "g.asc"));
    } catch (const ConfigurationError& error) {
        return error.what();
    }
    return "";
}

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

Raster wavy(std::size_t columns, std::size_t rows) {
    Raster raster{382249.79, 6354265.43, 0.99994, columns, rows, {}};
    for (std::size_t k = 0; k < columns * rows; ++k)
        raster.values.push_back(k == 7 ? no_value : double(float(20 + std::sin(0.01 * double(k)))));
    return raster;
}

void write_raster(const std::filesystem::path& file, const Raster& r, int epsg) {
    const std::vector<float> values(r.values.begin(), r.values.end());
    write_geotiff(file, {r.x, r.z, r.cell, r.cell, r.columns, r.rows, values}, epsg);
}

std::uint64_t raster_bits(std::uint64_t n) {
    return mix_bits(n * splitmix_step);
}

}  // namespace wade::raster_test

using namespace wade::raster_test;
using Catch::Matchers::Contains;

TEST_CASE("an ESRI ASCII grid: the northern row comes first, cells without data have no value") {
    const wade::RasterFile file = wade::read_esri_ascii(small_grid, "g.asc");
    const wade::Raster& r = file.raster;
    CHECK_FALSE(file.epsg);
    CHECK((r.columns == 3 && r.rows == 2 && r.x == 100 && r.z == 200 && r.cell == 2));
    CHECK((r.at(0, 1) == 1 && r.at(1, 1) == 2 && r.at(0, 0) == 4 && r.at(1, 0) == 5.5 && r.at(2, 0) == 6));
    CHECK(std::isnan(r.at(2, 1)));
}

TEST_CASE("an ESRI ASCII grid may give the centre of its lower left cell") {
    std::string text = small_grid;
    text.replace(text.find("xllcorner"), 9, "xllcenter");
    CHECK(wade::read_esri_ascii(text, "g.asc").raster.x == 99);
}

TEST_CASE("what is wrong with an ESRI ASCII grid is named") {
    const auto with = [](const std::string& old, const std::string& now) {
        std::string text = small_grid;
        return refusal_of_grid(text.replace(text.find(old), old.size(), now));
    };
    CHECK_THAT(with("5.5", "5,5"), Contains("row 2 from the top, column 2 is \"5,5\""));
    CHECK_THAT(with("+6e0", ""), Contains("cut short"));
    CHECK_THAT(with("+6e0", "6 7"), Contains("more than the 6 values"));
    CHECK_THAT(with("cellsize 2", "dx 2"), Contains("wade site import"));
    CHECK_THAT(with("cellsize 2", "cellsize -2"), Contains("cellsize is -2"));
    CHECK_THAT(with("ncols 3", "ncols 2.5"), Contains("ncols is 2.5"));
    CHECK_THAT(with("ncols 3", "ncols 900000000"), Contains("allowed: up to 100000000"));
    CHECK_THAT(with("ncols 3", "ncols 90000"), Contains("cut short"));
    CHECK_THAT(with("xllcorner", "xcorner"), Contains("\"xcorner\" is not one of"));
    CHECK_THAT(with("xllcorner 100", ""), Contains("no lower left corner"));
}

TEST_CASE("a GeoTIFF that is written is read with the same values, place and system") {
    const wade::test::TemporaryFolder folder;
    const wade::Raster raster = wavy(70, 130);
    const std::filesystem::path file = folder.path() / "a.tif";
    write_raster(file, raster, 32756);
    const wade::RasterFile read = wade::read_raster(file);
    CHECK(read.epsg == 32756);
    REQUIRE(read.raster.values.size() == raster.values.size());
    CHECK((read.raster.columns == 70 && read.raster.rows == 130 && read.raster.cell == raster.cell));
    // Northings are written from the top: the sum of height and corner rounds once.
    CHECK(read.raster.x == raster.x);
    CHECK(read.raster.z == Approx(raster.z).epsilon(1e-15));
    bool same = true;
    for (std::size_t k = 0; k < raster.values.size(); ++k)
        same = same && (k == 7 ? std::isnan(read.raster.values[k]) : read.raster.values[k] == raster.values[k]);
    CHECK(same);
    write_raster(file, raster, 0);
    CHECK_FALSE(wade::read_raster(file).epsg);
}

TEST_CASE("a file that is no raster is refused with what makes one") {
    const wade::test::TemporaryFolder folder;
    CHECK_THROWS_WITH(wade::read_raster(folder.write("a.tif", "hello")), Contains("neither a GeoTIFF nor"));
    CHECK_THROWS_WITH(wade::read_raster(folder.path() / "none.tif"), Contains("cannot be read"));
    CHECK_THROWS_WITH(wade::read_raster(folder.write("b.tif", std::string("II*\0\x08\0\0\0", 8))), Contains("no TIFF"));
    const std::string zeros = "ncols 2\nnrows 2\n" + std::string(100'000, '\0');
    CHECK_THROWS_WITH(wade::read_raster(folder.write("c.asc", zeros)), Contains("cannot be read: it is no text"));
}

TEST_CASE("a damaged raster is read or refused, never a crash") {
    const wade::test::TemporaryFolder folder;
    write_raster(folder.path() / "a.tif", wavy(40, 70), 32756);
    const std::string tiff = bytes_of(folder.path() / "a.tif");
    std::size_t refused = 0;
    const std::size_t tries = 3000;
    for (std::size_t i = 0; i < tries; ++i) {
        std::string text = i % 2 == 0 ? tiff : small_grid;
        const std::size_t changes = 1 + raster_bits(i) % 4;
        for (std::size_t k = 0; k < changes; ++k) {
            const std::uint64_t bits = raster_bits(i * 100 + k);
            // Half of them in the directory at the end, or in the header of the grid.
            const std::size_t at =
                bits % 2 == 0 ? (bits >> 8) % text.size() : text.size() - 1 - (bits >> 8) % (text.size() / 8);
            text[at] = static_cast<char>(bits >> 40);
        }
        if (i % 5 == 0) text.resize(raster_bits(i + 1) % text.size());
        try {
            const wade::RasterFile file =
                i % 2 == 0 ? wade::read_geotiff(text, "a.tif") : wade::read_esri_ascii(text, "g.asc");
            REQUIRE(file.raster.values.size() == file.raster.columns * file.raster.rows);
        } catch (const wade::ConfigurationError&) {
            ++refused;
        }
    }
    CHECK(refused > tries / 5);  // those that were cut short at the least
}
