#include "configs/files/raster_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "configs/errors/exit_code.hpp"
#include "configs/files/map_system.hpp"
#include "configs/files/plain_file.hpp"
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
    std::set<std::string> known;
    for (std::string key = lower(words.peek()); !key.empty() && std::isalpha(static_cast<unsigned char>(key.front()));
         key = lower(words.peek())) {
        if (key == "nan" || key == "inf") break;  // a first value
        words.next();
        const double value = words.number([&] { return "the header's " + key; });
        const std::string same = key.starts_with("xll") || key.starts_with("yll") ? key.substr(0, 3) : key;
        if (!known.insert(same).second) words.fail("the header's " + key + " stands twice; allowed: once.");
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
                "cells of dx and dy; allowed: cellsize, square cells. Remedy: tools/wade site import makes them "
                "square.");
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

// The role of an <Item>, in lower case.
std::string role_of(const std::string& tag) {
    const std::size_t at = tag.find("role");
    const std::size_t quote = at == std::string::npos ? at : tag.find_first_of("\"'", at);
    if (quote == std::string::npos) return "";
    return tag.substr(quote + 1, tag.find_first_of("\"'", quote + 1) - quote - 1);
}

std::string fault_of_entry(const std::string& name, std::string_view value) {
    const std::string shown = "it sets " + name + " to \"" + std::string(value.substr(0, 40)) + "\"; allowed: ";
    const auto is = [value](double wanted) {
        double number = 0;
        const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
        return error == std::errc() && end == value.data() + value.size() && number == wanted;
    };
    if (name == "scale" && !is(1)) return shown + "no scale, heights in metres. " + import_words();
    if (name == "offset" && !is(0)) return shown + "no offset, heights in metres. " + import_words();
    if (name == "unittype") {
        constexpr std::array<std::string_view, 6> metres{"", "m", "metre", "meter", "metres", "meters"};
        if (std::find(metres.begin(), metres.end(), lower(value)) == metres.end())
            return shown + "heights in metres. " + import_words();
    }
    for (const char* const of_file : {"nodatavalue", "srs", "geotransform", "gcplist"}) {
        if (name == of_file) return shown + "what the raster itself says. " + import_words();
    }
    return "";
}

// The number of the outermost system of a text in WKT, which stands at its end: AUTHORITY["EPSG","32632"]] or ID["EPSG",32632]].
std::optional<int> epsg_of_text(std::string text) {
    std::erase_if(text, [](char c) { return std::isspace(static_cast<unsigned char>(c)) || c == '"'; });
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const bool projected = text.starts_with("PROJCS[") || text.starts_with("PROJCRS[");
    const std::size_t at = text.rfind("[EPSG,");
    if (!projected || at == std::string::npos || !text.ends_with("]]") || text.find(']', at) != text.size() - 2)
        return std::nullopt;
    return epsg_of_name("EPSG:" + text.substr(at + 6, text.size() - 2 - (at + 6)));
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
    if (std::abs(header.x) >= 1e9 || std::abs(header.z) >= 1e9)
        words.fail("the header's lower left corner is at " + std::to_string(header.x) + ", " +
                   std::to_string(header.z) + "; allowed: from -1e9 to 1e9, m.");
    if (std::isnan(header.x) || std::isnan(header.z))
        words.fail(
            "the header names no lower left corner; allowed: xllcorner and yllcorner, or xllcenter and yllcenter.");
    if (raster.rows > most_raster_cells / raster.columns)
        words.fail(std::to_string(raster.columns) + " x " + std::to_string(raster.rows) + " cells; allowed: up to " +
                   std::to_string(most_raster_cells) + ". Remedy: tools/wade site import --crop or --cell.");
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
            raster.values[row * raster.columns + column] = value == header.no_data ? no_value : value;
        }
    }
    if (!words.next().empty())
        words.fail("there are more than the " + std::to_string(cells) + " values that the header promises.");
    return file;
}

std::string fault_of_metadata(std::string_view text) {
    for (std::size_t begin = text.find('<'); begin != std::string_view::npos; begin = text.find('<', begin + 1)) {
        const std::size_t end = std::min(text.find_first_of("<>", begin + 1), text.size());
        if (end == text.size() || text[end] == '<')
            return "its metadata are no XML: \"" + std::string(text.substr(begin, 40)) + "\" is not closed by >. " +
                   import_words();
        const std::string tag = lower(text.substr(begin + 1, end - begin - 1));
        std::string name = tag.substr(0, tag.find_first_of(" \t\r\n/"));
        if (name == "item") name = role_of(tag);
        std::string_view value = text.substr(std::min(end + 1, text.size()));
        value = value.substr(0, value.find('<'));
        if (const std::string fault = fault_of_entry(name, value); !fault.empty()) return fault;
    }
    return "";
}

namespace {

// Side files of GDAL and others for what the raster's own format does not hold.
void read_files_beside(const std::filesystem::path& file, RasterFile& raster, bool is_grid) {
    const auto beside = [&](const std::string& ending) { return std::filesystem::path(file.string() + ending); };
    std::error_code ignored;
    if (std::filesystem::exists(beside(".msk"), ignored))
        throw ConfigurationError(beside(".msk").string() + ": it masks cells of the raster; allowed: none. " +
                                 import_words());
    if (const auto pam = beside(".aux.xml"); std::filesystem::exists(pam, ignored)) {
        constexpr std::size_t longest = std::size_t{4} << 20;  // [A] GDAL's histograms and statistics fill some kB
        if (const std::string fault = fault_of_metadata(read_text_file(pam, "the file " + pam.string(), longest));
            !fault.empty())
            throw ConfigurationError(pam.string() + ": " + fault);
    }
    if (!is_grid) return;  // a GeoTIFF names its own system
    for (const char* const ending : {".prj", ".PRJ"}) {
        std::filesystem::path system = file;
        system.replace_extension(ending);
        if (!std::filesystem::exists(system, ignored)) continue;
        raster.epsg = epsg_of_text(read_text_file(system, "the file " + system.string(), std::size_t{1} << 20));
        if (!raster.epsg)
            throw ConfigurationError(system.string() +
                                     ": it spells the raster's coordinate system and gives no EPSG number of it; " +
                                     reproject_words());
        if (const std::string fault = fault_of_system(*raster.epsg); !fault.empty())
            throw ConfigurationError(system.string() + ": " + fault);
        return;
    }
}

bool begins_as_tiff(const std::filesystem::path& file) {
    using namespace std::string_view_literals;
    constexpr std::array magics{"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv};
    std::array<char, 4> magic{};
    const std::size_t got = PlainFile(file).read(0, magic.data(), magic.size());
    return std::find(magics.begin(), magics.end(), std::string_view(magic.data(), got)) != magics.end();
}

}  // namespace

RasterFile read_raster(const std::filesystem::path& file) {
    constexpr std::size_t longest = std::size_t{2} << 30;
    const std::string name = file.string();
    const bool is_tiff = begins_as_tiff(file);
    const std::string bytes = (is_tiff ? read_file : read_text_file)(file, "the file " + name, longest);
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    const std::string start = lower(std::string_view(bytes).substr(std::min(first, bytes.size()), 5));
    if (!is_tiff && start != "ncols" && start != "nrows")
        throw ConfigurationError(name + ": it is neither a GeoTIFF nor an ESRI ASCII grid (which begins with ncols). " +
                                 import_words());
    RasterFile raster = is_tiff ? read_geotiff(bytes, name) : read_esri_ascii(bytes, name);
    read_files_beside(file, raster, !is_tiff);
    return raster;
}

}  // namespace wade
