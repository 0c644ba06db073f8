// The one profile of rasters that the programs read: what would change the meaning of the values is refused by name.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/files/map_system.hpp"
#include "configs/files/raster_file.hpp"
#include "scene_texts.hpp"

namespace wade::strict_raster_test {

// A tag of TIFF: its type, the number of its values, their bytes.
struct Tag {
    std::uint16_t type = 0;
    std::uint32_t count = 0;
    std::string bytes;
};
using Tags = std::map<std::uint16_t, Tag>;

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}
Tag shorts(const std::vector<std::uint16_t>& values) {
    return {3, static_cast<std::uint32_t>(values.size()), bytes_of(values)};
}
Tag longs(const std::vector<std::uint32_t>& values) {
    return {4, static_cast<std::uint32_t>(values.size()), bytes_of(values)};
}
Tag doubles(const std::vector<double>& values) {
    return {12, static_cast<std::uint32_t>(values.size()), bytes_of(values)};
}
Tag words(const std::string& text) {
    return {2, static_cast<std::uint32_t>(text.size() + 1), text + '\0'};
}
// Keys of GeoTIFF as {key, value} pairs.
Tag geo_keys(const std::vector<std::array<std::uint16_t, 2>>& keys) {
    std::vector<std::uint16_t> values{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
    for (const auto& [key, value] : keys) values.insert(values.end(), {key, 0, 1, value});
    return shorts(values);
}

// A file of little end with directories one after the other.
std::string tiff_of(const std::vector<Tags>& directories, const std::string& values) {
    std::string file("II*\0\0\0\0\0", 8);
    file += values;  // at 8
    std::size_t link = 4;
    const auto put = [&](std::size_t at, auto value) { std::memcpy(file.data() + at, &value, sizeof value); };
    for (const Tags& tags : directories) {
        if (file.size() % 2 != 0) file += '\0';
        put(link, static_cast<std::uint32_t>(file.size()));
        std::size_t at = file.size();
        file.resize(at + 2 + 12 * tags.size() + 4);
        link = file.size() - 4;
        put(at, static_cast<std::uint16_t>(tags.size()));
        at += 2;
        for (const auto& [number, tag] : tags) {
            put(at, number);
            put(at + 2, tag.type);
            put(at + 4, tag.count);
            if (tag.bytes.size() <= 4) {
                std::memcpy(file.data() + at + 8, tag.bytes.data(), tag.bytes.size());
            } else {
                put(at + 8, static_cast<std::uint32_t>(file.size()));
                file += tag.bytes;
            }
            at += 12;
        }
    }
    return file;
}

// 3 x 2 heights 1 to 6 at (500000, 5200080), cells of 2 m.
const std::string heights = bytes_of(std::vector<float>{1, 2, 3, 4, 5, 6});
Tags plain(std::uint32_t width = 3, std::uint32_t height = 2) {
    return {{256, longs({width})},
            {257, longs({height})},
            {258, shorts({32})},
            {259, shorts({1})},
            {262, shorts({1})},
            {273, longs({8})},
            {277, shorts({1})},
            {278, longs({height})},
            {279, longs({24})},
            {339, shorts({3})},
            {33550, doubles({2, 2, 0})},
            {33922, doubles({0, 0, 0, 500000, 5200080, 0})},
            {34735, geo_keys({{1024, 1}, {1025, 1}, {3072, 32632}, {3076, 9001}})}};
}

std::string refusal_of_tiff(const std::string& bytes) {
    try {
        static_cast<void>(read_geotiff(bytes, "a.tif"));
    } catch (const ConfigurationError& error) {
        return error.what();
    }
    return "";
}
// The plain file with one tag more or another one.
std::string refusal_with(std::uint16_t number, const Tag& tag) {
    Tags tags = plain();
    tags[number] = tag;
    return refusal_of_tiff(tiff_of({tags}, heights));
}
std::string refusal_of_keys(const std::vector<std::array<std::uint16_t, 2>>& keys) {
    return refusal_with(34735, geo_keys(keys));
}
std::string refusal_of_metadata(const std::string& items) {
    return refusal_with(42112, words("<GDALMetadata>" + items + "</GDALMetadata>"));
}

}  // namespace wade::strict_raster_test

using namespace wade::strict_raster_test;
using Catch::Matchers::Contains;

TEST_CASE("a plain GeoTIFF is read, north up") {
    const wade::RasterFile file = wade::read_geotiff(tiff_of({plain()}, heights), "a.tif");
    CHECK(file.epsg == 32632);
    const wade::Raster& r = file.raster;
    CHECK((r.columns == 3 && r.rows == 2 && r.x == 500000 && r.z == 5200076 && r.cell == 2));
    CHECK((r.at(0, 1) == 1 && r.at(2, 1) == 3 && r.at(0, 0) == 4 && r.at(2, 0) == 6));
}

TEST_CASE("scale, offset and unit of GDAL are refused with the importer as the remedy; other metadata are not") {
    const auto item = [](const std::string& role, const std::string& value) {
        return "<Item name=\"X\" sample=\"0\" role=\"" + role + "\">" + value + "</Item>";
    };
    CHECK_THAT(refusal_of_metadata(item("scale", "0.01")),
               Contains("sets scale to \"0.01\"") && Contains("tools/wade site import FILE --out DIR"));
    CHECK_THAT(refusal_of_metadata(item("offset", "100")), Contains("sets offset to \"100\""));
    CHECK_THAT(refusal_of_metadata(item("unittype", "ft")), Contains("sets unittype to \"ft\""));
    CHECK_THAT(refusal_of_metadata("<Item role = 'SCALE' sample='0'>1e-2</Item>"), Contains("scale"));
    CHECK_THAT(refusal_of_metadata(item("scale", "&#49;")), Contains("scale"));
    CHECK_THAT(refusal_of_metadata(std::string(1'000'000, '<')), Contains("its metadata are no XML"));
    CHECK(refusal_of_metadata(item("scale", "1") + item("offset", "0") + item("unittype", "metre")).empty());
    CHECK(refusal_of_metadata("<Item name=\"STATISTICS_MEAN\">100</Item>" + item("description", "offset")).empty());
}

TEST_CASE("an internal mask is refused, an overview is not") {
    Tags mask = plain();
    mask[254] = longs({4});
    CHECK_THAT(refusal_of_tiff(tiff_of({plain(), mask}, heights)), Contains("internal mask; allowed: none"));
    mask[254] = longs({1});
    CHECK(refusal_of_tiff(tiff_of({plain(), mask}, heights)).empty());
}

TEST_CASE("rows from south to north, turned rows, heights that tags scale, and places without cells are refused") {
    CHECK_THAT(refusal_with(33550, doubles({2, -2, 0})), Contains("south up") && Contains("site import"));
    Tags matrix = plain();
    matrix.erase(33550);
    matrix.erase(33922);
    const auto with_matrix = [&](double row_x, double step_z) {
        matrix[34264] = doubles({2, row_x, 0, 500000, 0, step_z, 0, 5200080, 0, 0, 0, 0, 0, 0, 0, 1});
        return refusal_of_tiff(tiff_of({matrix}, heights));
    };
    CHECK(with_matrix(0, -2).empty());
    CHECK_THAT(with_matrix(0, 2), Contains("south up"));
    CHECK_THAT(with_matrix(0.1, -2), Contains("do not run from west to east"));
    CHECK_THAT(refusal_with(33550, doubles({2, 2, 0.3048})), Contains("scale or shift its heights"));
    CHECK_THAT(refusal_with(33922, doubles({0, 0, 0, 500000, 5200080, 12})), Contains("scale or shift its heights"));
    CHECK_THAT(refusal_with(33922, doubles({0, 0, 0, 500000, 5200080, 0, 3, 2, 0, 500006, 5200076, 0})),
               Contains("does not say where it lies"));
}

TEST_CASE("systems in feet, spelled, vertical or of the world are refused, beside a grid and in a GeoTIFF") {
    for (const int feet : {2263, 2227, 2264, 2274, 6541, 2236, 3435, 102000}) {
        CHECK_THAT(wade::fault_of_system(feet), Contains("no projected system in metres"));
    }
    for (const int metres : {32632, 32756, 25832, 2056, 31370, 27700, 2193, 3035, 28992, 5514, 32661}) {
        CHECK(wade::fault_of_system(metres).empty());
    }
    for (const int other : {4326, 4978, 5773, 5555, 3857, 6933, 2053, 1, 32600}) {
        CHECK_THAT(wade::fault_of_system(other), Contains("site import"));
    }
    CHECK_THAT(refusal_of_keys({{1024, 1}, {1025, 1}, {3072, 2263}}), Contains("EPSG:2263 is no projected system"));
    CHECK_THAT(refusal_of_keys({{1024, 1}, {3072, 32632}, {3076, 9003}}), Contains("unit of length is number 9003"));
    CHECK_THAT(refusal_of_keys({{1024, 1}, {3072, 32632}, {3076, 32767}}), Contains("unit of length"));
    CHECK_THAT(refusal_of_keys({{1024, 1}, {3072, 32767}, {3076, 9001}}), Contains("spells its coordinate system"));
    CHECK_THAT(refusal_of_keys({{1024, 1}, {3076, 9001}}), Contains("spells its coordinate system"));
    CHECK_THAT(refusal_of_keys({{1024, 1}, {3072, 32632}, {4096, 5773}}), Contains("vertical system"));
    CHECK_THAT(refusal_of_keys({{1024, 1}, {3072, 32632}, {4099, 9002}}), Contains("vertical system"));
    CHECK_THAT(refusal_of_keys({{1024, 2}, {2048, 4326}}), Contains("degrees"));
    CHECK_THAT(refusal_of_keys({{1024, 3}}), Contains("geocentric"));
}

TEST_CASE("files beside a raster that change what its values mean are refused") {
    const wade::test::TemporaryFolder folder;
    const std::string grid = "ncols 2\nnrows 1\nxllcorner 1000\nyllcorner 2000\ncellsize 2\n1 2\n";
    const auto with = [&](const std::string& name, const std::string& text) {
        const auto beside = folder.write(name, text), file = folder.write("g.asc", grid);
        std::string refusal;
        try {
            const wade::RasterFile read = wade::read_raster(file);
            refusal = read.epsg ? std::to_string(*read.epsg) : "";
        } catch (const wade::ConfigurationError& error) {
            refusal = error.what();
        }
        std::filesystem::remove(beside);
        return refusal;
    };
    CHECK_THAT(with("g.asc.aux.xml", "<PAMDataset><PAMRasterBand band=\"1\"><Scale>0.3048</Scale></PAMRasterBand>"),
               Contains("g.asc.aux.xml: it sets scale"));
    CHECK_THAT(with("g.asc.aux.xml", "<PAMDataset><SRS>PROJCS[]</SRS></PAMDataset>"), Contains("it sets srs"));
    CHECK(with("g.asc.aux.xml", "<PAMDataset><Metadata><MDI key=\"STATISTICS_MEAN\">3</MDI></Metadata></PAMDataset>")
              .empty());
    CHECK_THAT(with("g.asc.aux.xml", std::string(200'000, '<')), Contains("g.asc.aux.xml: its metadata are no XML"));
    CHECK_THAT(with("g.asc.aux.xml", "<PAMDataset><Scale"), Contains("is not closed by >"));
    CHECK_THAT(with("g.asc.aux.xml", std::string((4 << 20) + 1, ' ')), Contains("it is longer than 4 MiB"));
    CHECK_THAT(with("g.prj", std::string((1 << 20) + 1, ' ')), Contains("it is longer than 1 MiB"));
    CHECK_THAT(with("g.asc.msk", "II*"), Contains("masks cells"));
    const std::string spelled = "PROJCS[\"UTM 32N\",GEOGCS[\"WGS 84\",AUTHORITY[\"EPSG\",\"4326\"]],UNIT[\"metre\",1]";
    CHECK_THAT(with("g.prj", spelled + "]"), Contains("g.prj: it spells the raster's coordinate system"));
    CHECK(with("g.prj", spelled + ",\n AUTHORITY[\"EPSG\", \"32632\"]]\n") == "32632");
    CHECK_THAT(with("g.prj", spelled + ",AUTHORITY[\"EPSG\",\"2263\"]]"), Contains("EPSG:2263 is no projected system"));
    CHECK_THAT(with("g.prj", "GEOGCS[\"WGS 84\",AUTHORITY[\"EPSG\",\"4326\"]]"), Contains("spells"));
    CHECK_THAT(with("g.prj", "Projection UTM\nZone 32\nUnits METERS\n"), Contains("spells"));
}

TEST_CASE("a small file that claims many cells, a tile or row beyond measure, and lossy values are refused first") {
    CHECK_THAT(refusal_of_tiff(tiff_of({plain(20000, 9900)}, heights)), Contains("allowed: up to 100000000"));
    CHECK_THAT(refusal_of_tiff(tiff_of({plain(9900, 9900)}, heights)), Contains("9900 x 9900 cells in "));
    CHECK_THAT(refusal_of_tiff(tiff_of({plain(16'000'000, 1)}, heights)), Contains("64000000 bytes; allowed"));
    CHECK_THAT(refusal_with(259, shorts({7})), Contains("its compression is number 7 of TIFF"));
    CHECK_THAT(refusal_with(258, shorts({8})), Contains("8 bits a value"));
}

TEST_CASE("a strip or tile without bytes holds no data, and is refused where no value stands for that") {
    for (const bool tiled : {false, true}) {
        for (const auto& [offset, length] : {std::pair{0U, 0U}, std::pair{0U, 24U}}) {
            for (const std::uint16_t compression : std::array<std::uint16_t, 2>{1, 8}) {
                Tags tags = plain();
                tags[259] = shorts({compression});
                if (tiled) {
                    tags.erase(273);
                    tags.erase(278);
                    tags.erase(279);
                    tags[322] = tags[323] = longs({16});
                }
                tags[tiled ? 324 : 273] = longs({offset});
                tags[tiled ? 325 : 279] = longs({length});
                CHECK_THAT(refusal_of_tiff(tiff_of({tags}, heights)),
                           Contains(tiled ? "tile 0 has no bytes" : "strip 0 has no bytes") &&
                               Contains("tools/wade site import"));
                tags[42113] = words("-9999");
                CHECK(std::isnan(wade::read_geotiff(tiff_of({tags}, heights), "a.tif").raster.at(2, 1)));
            }
        }
    }
}

TEST_CASE("colours are refused as heights") {
    Tags palette = plain();
    palette[258] = shorts({8});
    palette[339] = shorts({1});
    palette[262] = shorts({3});
    palette[320] = shorts(std::vector<std::uint16_t>(3 * 256, 7));
    CHECK_THAT(refusal_of_tiff(tiff_of({palette}, heights)), Contains("PhotometricInterpretation 3, a palette"));
    for (const std::uint16_t colours : std::array<std::uint16_t, 4>{2, 4, 5, 8}) {
        CHECK_THAT(refusal_with(262, shorts({colours})), Contains("its values are colours"));
    }
    CHECK(refusal_with(262, shorts({0})).empty());
    CHECK(refusal_with(262, shorts({1})).empty());
}

TEST_CASE("a key of an ESRI ASCII grid stands once") {
    const auto refused = [](const std::string& header) {
        try {
            static_cast<void>(wade::read_esri_ascii(header + "cellsize 2\n1 2\n", "g.asc"));
        } catch (const wade::ConfigurationError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK_THAT(refused("ncols 2\nnrows 1\nncols 1\nxllcorner 0\nyllcorner 0\n"), Contains("ncols stands twice"));
    CHECK_THAT(refused("ncols 2\nnrows 1\nxllcorner 0\nxllcenter 1\nyllcorner 0\n"),
               Contains("xllcenter stands twice"));
    CHECK(refused("ncols 2\nnrows 1\nxllcorner 0\nyllcenter 1\n").empty());
}

TEST_CASE("infinite values are values, so that the checks of heights name them") {
    std::string values = heights;
    const float infinite = INFINITY;
    std::memcpy(values.data(), &infinite, sizeof infinite);
    CHECK(std::isinf(wade::read_geotiff(tiff_of({plain()}, values), "a.tif").raster.at(0, 1)));
}
