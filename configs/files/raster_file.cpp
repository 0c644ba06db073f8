#include "configs/files/raster_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "configs/files/text_file.hpp"

namespace wade {

namespace {

// The words of a grid, one after the other.
class GridText {
 public:
    GridText(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    // The next word; empty at the end.
    std::string_view next() {
        while (at_ < text_.size() && is_space(text_[at_])) ++at_;
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
        return text_.substr(begin, at_ - begin);
    }
    std::string_view peek() {
        const std::size_t here = at_;
        const std::string_view word = next();
        at_ = here;
        return word;
    }

    [[noreturn]] void fail(const std::string& sentence) const { throw ConfigurationError(name_ + ": " + sentence); }

    // The next word as a number; `what` names it.
    template <typename What>
    double number(const What& what) {
        std::string_view word = next();
        if (word.empty()) fail(what() + " is missing: the file is cut short.");
        const std::string shown(word.substr(0, 40));
        if (word.front() == '+') word.remove_prefix(1);
        double value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error == std::errc() && end == word.data() + word.size()) return value;
        fail(what() + " is \"" + shown + "\"; allowed: a number with a decimal point.");
    }

 private:
    static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

    std::string_view text_;
    const std::string& name_;
    std::size_t at_ = 0;
};

std::string lower(std::string_view word) {
    std::string text(word);
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

struct Header {
    double columns = 0, rows = 0, x = no_value, z = no_value, cell = 0, no_data = -9999;
    bool centre_x = false, centre_z = false;
};

Header header_of(GridText& words) {
    Header header;
    for (std::string key = lower(words.peek()); !key.empty() && std::isalpha(static_cast<unsigned char>(key.front()));
         key = lower(words.peek())) {
        if (key == "nan" || key == "inf") break;  // a first value
        words.next();
        const double value = words.number([&] { return "the header's " + key; });
        if (key == "ncols") {
            header.columns = value;
        } else if (key == "nrows") {
            header.rows = value;
        } else if (key == "xllcorner" || key == "xllcenter") {
            header.x = value;
            header.centre_x = key == "xllcenter";
        } else if (key == "yllcorner" || key == "yllcenter") {
            header.z = value;
            header.centre_z = key == "yllcenter";
        } else if (key == "cellsize") {
            header.cell = value;
        } else if (key == "nodata_value") {
            header.no_data = value;
        } else if (key == "dx" || key == "dy") {
            words.fail(
                "cells of dx and dy; allowed: cellsize, square cells. Remedy: wade place import makes them square.");
        } else {
            words.fail("the header's key \"" + key +
                       "\" is not one of an ESRI ASCII grid; allowed: ncols, nrows, xllcorner, yllcorner, cellsize, "
                       "nodata_value.");
        }
    }
    return header;
}

std::size_t count_of(double value, const char* key, const GridText& words) {
    if (value >= 1 && value <= 1e9 && std::trunc(value) == value) return static_cast<std::size_t>(value);
    words.fail("the header's " + std::string(key) + " is " + std::to_string(value) +
               "; allowed: a whole number from 1 to 1e9.");
}

}  // namespace

RasterFile read_esri_ascii(std::string_view text, const std::string& name) {
    GridText words(text, name);
    const Header header = header_of(words);
    RasterFile file;
    Raster& raster = file.raster;
    raster.columns = count_of(header.columns, "ncols", words);
    raster.rows = count_of(header.rows, "nrows", words);
    if (!(header.cell > 0 && header.cell < 1e6))
        words.fail("the header's cellsize is " + std::to_string(header.cell) + "; allowed: > 0 and < 1e6.");
    if (!(std::abs(header.x) < 1e9 && std::abs(header.z) < 1e9))
        words.fail(
            "the header names no lower left corner; allowed: xllcorner and yllcorner, or xllcenter and yllcenter.");
    if (raster.rows > most_raster_cells / raster.columns)
        words.fail(std::to_string(raster.columns) + " x " + std::to_string(raster.rows) + " cells; allowed: up to " +
                   std::to_string(most_raster_cells) + ". Remedy: wade place import --crop or --cell.");
    raster.cell = header.cell;
    raster.x = header.x - (header.centre_x ? header.cell / 2 : 0);
    raster.z = header.z - (header.centre_z ? header.cell / 2 : 0);
    const std::size_t cells = raster.columns * raster.rows;
    if (text.size() / 2 < cells / 2)  // a value needs a digit and a space
        words.fail("the header promises " + std::to_string(cells) +
                   " values, more than the file can hold: it is cut short.");
    raster.values.resize(cells);
    for (std::size_t row = raster.rows; row-- > 0;) {  // the northern one comes first
        for (std::size_t column = 0; column < raster.columns; ++column) {
            const double value = words.number([&] {
                return "the value of row " + std::to_string(raster.rows - row) + " from the top, column " +
                       std::to_string(column + 1);
            });
            raster.values[row * raster.columns + column] =
                value == header.no_data || !std::isfinite(value) ? no_value : value;
        }
    }
    if (!words.next().empty())
        words.fail("there are more than the " + std::to_string(cells) + " values that the header promises.");
    return file;
}

RasterFile read_raster(const std::filesystem::path& file) {
    constexpr std::size_t longest = std::size_t{2} << 30;
    const std::string name = file.string();
    const std::string bytes = read_text_file(file, "the file " + name, longest);
    const std::string_view magic = std::string_view(bytes).substr(0, 4);
    using namespace std::string_view_literals;
    constexpr std::array tiff{"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv};
    if (std::find(tiff.begin(), tiff.end(), magic) != tiff.end()) return read_geotiff(bytes, name);
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    const std::string start = lower(std::string_view(bytes).substr(std::min(first, bytes.size()), 5));
    if (start == "ncols" || start == "nrows") return read_esri_ascii(bytes, name);
    throw ConfigurationError(name +
                             ": it is neither a GeoTIFF nor an ESRI ASCII grid (which begins with ncols). Remedy: wade "
                             "place import makes a GeoTIFF of any raster that GDAL reads.");
}

std::string reproject_words() {
    return "allowed: metres of a projected system. Remedy: wade place import --epsg N reprojects, N for example that "
           "of the "
           "place's UTM zone.";
}

std::string fault_of_system(int epsg) {
    const std::string number = "EPSG:" + std::to_string(epsg);
    constexpr std::array degrees{4326, 4258, 4267, 4269, 4230, 4277, 4283, 4289, 4312, 4314, 4490,
                                 4555, 4612, 4617, 4674, 4759, 4979, 6318, 6668, 7844, 9000};
    if (std::find(degrees.begin(), degrees.end(), epsg) != degrees.end())
        return number + " counts in degrees; " + reproject_words();
    if (epsg == 3857 || epsg == 900913 || epsg == 3785 || epsg == 3395)
        return number + " is a Mercator map of the world, in which lengths grow with latitude; " + reproject_words();
    return "";
}

}  // namespace wade
