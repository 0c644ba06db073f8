// GeoTIFF with libtiff alone: the map's tags are those of OGC 19-008 (GeoTIFF 1.1), and GDAL's for "no data" and metadata.
//
// One strict profile is read, that of `tools/wade site import`: heights in metres in one band, rows from north to south, one projected
// system by its number. Tags that would change what the values mean are refused, never ignored.

#include "configs/files/geotiff.hpp"

#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/files/map_system.hpp"
#include "configs/files/plain_file.hpp"
#include "configs/files/raster_file.hpp"

namespace wade {

namespace {

constexpr ttag_t tag_scale = 33550, tag_tie_point = 33922, tag_matrix = 34264, tag_keys = 34735, tag_metadata = 42112,
                 tag_no_data = 42113;

// Keys of the directory in tag_keys.
constexpr std::uint16_t key_model = 1024, key_raster = 1025, key_geographic = 2048, key_projected = 3072,
                        key_length_unit = 3076, key_vertical = 4096, last_vertical_key = 5119;
constexpr std::uint16_t model_projected = 1, model_geographic = 2, raster_is_area = 1, raster_is_point = 2,
                        metre = 9001, of_no_number = 32767;

TIFFExtendProc next_extender = nullptr;  // of another user of libtiff in this program; set once

void add_tags(TIFF* tiff) {
    static std::array<char, 6> scale{"Scale"}, point{"Point"}, matrix{"Matri"}, keys{"GKeys"}, none{"NoDat"},
        metadata{"MData"};
    static const std::array<TIFFFieldInfo, 6> infos{{
        {tag_scale, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, scale.data()},
        {tag_tie_point, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, point.data()},
        {tag_matrix, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, matrix.data()},
        {tag_keys, -1, -1, TIFF_SHORT, FIELD_CUSTOM, 1, 1, keys.data()},
        {tag_no_data, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, none.data()},
        {tag_metadata, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, metadata.data()},
    }};
    TIFFMergeFieldInfo(tiff, infos.data(), infos.size());
    if (next_extender) next_extender(tiff);
}

thread_local std::string last_complaint;

void keep_complaint(const char*, const char* format, va_list values) {
    std::array<char, 300> text{};
    std::vsnprintf(text.data(), text.size(), format, values);
    last_complaint = text.data();
}

void prepare_libtiff() {
    static const bool once = [] {
        next_extender = TIFFSetTagExtender(add_tags);
        TIFFSetErrorHandler(keep_complaint);
        TIFFSetWarningHandler(nullptr);
        return true;
    }();
    static_cast<void>(once);
    last_complaint.clear();
}

// A file that lies in memory.
struct Memory {
    std::string_view bytes;
    std::size_t at = 0;
};

tmsize_t read_memory(thandle_t handle, void* to, tmsize_t size) {
    auto& memory = *static_cast<Memory*>(handle);
    const std::size_t left = memory.bytes.size() - std::min(memory.at, memory.bytes.size());
    const std::size_t taken = std::min(left, static_cast<std::size_t>(std::max<tmsize_t>(size, 0)));
    if (taken > 0) std::memcpy(to, memory.bytes.data() + memory.at, taken);
    memory.at += taken;
    return static_cast<tmsize_t>(taken);
}
tmsize_t write_memory(thandle_t, void*, tmsize_t) {
    return -1;
}
toff_t seek_memory(thandle_t handle, toff_t offset, int whence) {
    auto& memory = *static_cast<Memory*>(handle);
    const toff_t from = whence == SEEK_CUR ? memory.at : whence == SEEK_END ? memory.bytes.size() : 0;
    memory.at = static_cast<std::size_t>(from + offset);
    return memory.at;
}
int close_memory(thandle_t) {
    return 0;
}
toff_t size_of_memory(thandle_t handle) {
    return static_cast<Memory*>(handle)->bytes.size();
}

using OpenTiff = std::unique_ptr<TIFF, void (*)(TIFF*)>;

class TiffReader {
 public:
    TiffReader(std::string_view bytes, const std::string& name)
        : name_(name), memory_{bytes}, tiff_(nullptr, TIFFClose) {
        prepare_libtiff();
        tiff_.reset(TIFFClientOpen(name.c_str(), "rm", &memory_, read_memory, write_memory, seek_memory, close_memory,
                                   size_of_memory, nullptr, nullptr));
        if (!tiff_) fail("it is no TIFF that can be read" + why());
    }

    RasterFile read() {
        RasterFile file;
        refuse_masks();
        read_layout();
        refuse_metadata();
        read_keys(file);
        read_place(file.raster);
        read_values(file.raster);
        return file;
    }

 private:
    [[noreturn]] void fail(const std::string& sentence) const {
        throw ConfigurationError(name_ + ": " + sentence + (sentence.ends_with('.') ? "" : "."));
    }
    static std::string why() { return last_complaint.empty() ? "" : " (" + last_complaint + ")"; }

    template <typename T>
    T field(ttag_t tag, T otherwise) const {
        T value = otherwise;
        return TIFFGetFieldDefaulted(tiff_.get(), tag, &value) ? value : otherwise;
    }
    std::vector<double> doubles(ttag_t tag) const {
        std::uint16_t count = 0;
        double* values = nullptr;
        if (!TIFFGetField(tiff_.get(), tag, &count, &values) || !values) return {};
        return {values, values + count};
    }

    // A mask lies in a directory of its own.
    void refuse_masks() {
        constexpr int most = 1000;
        for (int directory = 1; TIFFReadDirectory(tiff_.get()); ++directory) {
            const auto kind = field<std::uint32_t>(TIFFTAG_SUBFILETYPE, 0);
            if ((kind & FILETYPE_MASK) != 0) fail("it has an internal mask; allowed: none. " + import_words());
            if (directory == most) fail("it has more than " + std::to_string(most) + " directories; allowed: 1");
        }
        if (!TIFFSetDirectory(tiff_.get(), 0)) fail("it is no TIFF that can be read" + why());
        last_complaint.clear();
    }

    // SCALE, OFFSET and UNITTYPE of GDAL, as <Item name="SCALE" sample="0" role="scale">0.01</Item>.
    void refuse_metadata() const {
        const char* text = nullptr;
        if (!TIFFGetField(tiff_.get(), tag_metadata, &text) || !text) return;
        if (const std::string fault = fault_of_metadata(text); !fault.empty()) fail(fault);
    }

    void read_layout() {
        width_ = field<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
        height_ = field<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
        bits_ = field<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1);
        format_ = field<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
        const auto bands = field<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1);
        if (bands != 1)
            fail(std::to_string(bands) +
                 " bands, which looks like a picture; allowed: 1, heights. Remedy: gdal_translate -b 1");
        const auto meaning = field<std::uint16_t>(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        if (meaning != PHOTOMETRIC_MINISBLACK && meaning != PHOTOMETRIC_MINISWHITE)
            fail("its values are colours (PhotometricInterpretation " + std::to_string(meaning) +
                 (meaning == PHOTOMETRIC_PALETTE ? ", a palette" : "") +
                 "); allowed: 0 or 1, heights in metres. Remedy: take the raster of heights, not a picture of it");
        if (width_ == 0 || height_ == 0) fail("it has no cells");
        if (height_ > most_raster_cells / width_)
            fail(std::to_string(width_) + " x " + std::to_string(height_) + " cells; allowed: up to " +
                 std::to_string(most_raster_cells) + ". Remedy: tools/wade site import --crop or --cell");
        const std::size_t cells = std::size_t{width_} * height_,
                          most = std::max(cells_of_small_file, memory_.bytes.size());
        if (cells > most)
            fail(std::to_string(width_) + " x " + std::to_string(height_) + " cells in " +
                 std::to_string(memory_.bytes.size()) + " bytes; allowed: up to " + std::to_string(most) +
                 " in such a file. Remedy: tools/wade site import --crop or --cell, or gdal_translate without "
                 "compression");
        const auto codec = field<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
        constexpr std::array lossless{COMPRESSION_NONE,    COMPRESSION_LZW,  COMPRESSION_ADOBE_DEFLATE,
                                      COMPRESSION_DEFLATE, COMPRESSION_ZSTD, COMPRESSION_PACKBITS};
        if (std::find(lossless.begin(), lossless.end(), codec) == lossless.end())
            fail("its compression is number " + std::to_string(codec) +
                 " of TIFF; allowed: none, DEFLATE, LZW, ZSTD, PACKBITS. " + import_words());
        const bool is_float = format_ == SAMPLEFORMAT_IEEEFP && (bits_ == 32 || bits_ == 64);
        const bool is_whole =
            (format_ == SAMPLEFORMAT_UINT || format_ == SAMPLEFORMAT_INT) && (bits_ == 16 || bits_ == 32);
        const bool is_byte = format_ == SAMPLEFORMAT_UINT && bits_ == 8;
        if (!is_float && !is_whole && !is_byte)
            fail(std::to_string(bits_) + " bits a value of TIFF format " + std::to_string(format_) +
                 "; allowed: whole numbers of 8 bits without sign, of 16 or 32 bits, floating ones of 32 or 64. " +
                 import_words());
    }

    void read_keys(RasterFile& file) {
        std::uint16_t count = 0;
        std::uint16_t* keys = nullptr;
        if (!TIFFGetField(tiff_.get(), tag_keys, &count, &keys) || !keys) return;
        std::uint16_t model = 0, geographic = 0, projected = 0, unit = 0;
        for (std::size_t i = 4; i + 3 < count; i += 4) {
            if (keys[i] >= key_vertical && keys[i] <= last_vertical_key)
                fail("it names a vertical system; allowed: none, heights in metres above one zero. " + import_words());
            if (keys[i + 1] != 0) continue;  // its value lies elsewhere
            if (keys[i + 2] != 1)
                fail("its key " + std::to_string(keys[i]) + " has " + std::to_string(keys[i + 2]) +
                     " values; allowed: 1. " + import_words());
            const std::uint16_t value = keys[i + 3];
            if (keys[i] == key_model) model = value;
            if (keys[i] == key_raster) point_ = value == raster_is_point;
            if (keys[i] == key_geographic) geographic = value;
            if (keys[i] == key_projected) projected = value;
            if (keys[i] == key_length_unit) unit = value;
        }
        if (model != 0 && model != model_projected && model != of_no_number)
            fail("its coordinates are degrees or geocentric" +
                 (geographic ? ", of EPSG:" + std::to_string(geographic) : std::string()) + "; " + reproject_words());
        if (projected == of_no_number || (projected == 0 && model == model_projected))
            fail("it spells its coordinate system and gives no EPSG number of it; " + reproject_words());
        if (unit != 0 && unit != metre)
            fail("its unit of length is number " + std::to_string(unit) + " of EPSG (9002 and 9003 are feet); " +
                 reproject_words());
        if (projected == 0) return;
        if (const std::string fault = fault_of_system(projected); !fault.empty()) fail(fault);
        file.epsg = projected;
    }

    void read_place(Raster& raster) {
        std::vector<double> scale = doubles(tag_scale);
        const std::vector<double> tie = doubles(tag_tie_point), matrix = doubles(tag_matrix);
        double column = 0, row = 0, x = 0, z = 0;
        const auto is_set = [](const std::vector<double>& values, std::size_t i, double usual) {
            return values.size() > i && values[i] != 0 && values[i] != usual;
        };
        if (is_set(scale, 2, 1) || is_set(tie, 2, 0) || is_set(tie, 5, 0) || is_set(matrix, 10, 1) ||
            is_set(matrix, 11, 0))
            fail("its tags scale or shift its heights; allowed: heights in metres. " + import_words());
        if (scale.size() >= 2 && tie.size() == 6) {
            column = tie[0];
            row = tie[1];
            x = tie[3];
            z = tie[4];
        } else if (matrix.size() >= 8) {
            if (matrix[1] != 0 || matrix[4] != 0)
                fail("its rows do not run from west to east; allowed: north up. " + import_words());
            scale = {matrix[0], -matrix[5]};
            x = matrix[3];
            z = matrix[7];
        } else {
            fail(
                "it does not say where it lies (no pixel scale and one tie point). Remedy: gdal_translate -a_srs "
                "EPSG:N "
                "-a_ullr WEST NORTH EAST SOUTH FILE OUT.tif");
        }
        if (scale[1] < 0) fail("its rows run from south to north (south up); allowed: north up. " + import_words());
        const bool sound = std::all_of(scale.begin(), scale.begin() + 2, [](double v) { return v > 0 && v < 1e6; });
        if (!sound || !(std::abs(x) < 1e9) || !(std::abs(z) < 1e9) || !(std::abs(column) < 1e9) ||
            !(std::abs(row) < 1e9))
            fail("its pixel scale or tie point is no place on a map, north up and from west to east. " +
                 import_words());
        constexpr double rounding = 1e-6;
        if (std::abs(scale[0] - scale[1]) > rounding * scale[0])
            fail("its cells are " + std::to_string(scale[0]) + " x " + std::to_string(scale[1]) +
                 "; allowed: squares. Remedy: tools/wade site import makes them square");
        raster.cell = scale[0];
        raster.columns = width_;
        raster.rows = height_;
        const double half = point_ ? 0.5 : 0;
        raster.x = x - (column + half) * raster.cell;
        raster.z = z + (row + half) * raster.cell - static_cast<double>(height_) * raster.cell;
    }

    void read_values(Raster& raster) {
        const char* text = nullptr;
        if (TIFFGetField(tiff_.get(), tag_no_data, &text) && text) {
            const double value = std::strtod(text, nullptr);
            no_data_ =
                format_ == SAMPLEFORMAT_IEEEFP && bits_ == 32 ? static_cast<double>(static_cast<float>(value)) : value;
        }
        // Reserved memory costs nothing until it is filled, so that a file that only promises cells takes none.
        std::vector<double>& values = raster.values;
        values.reserve(raster.columns * raster.rows);
        if (TIFFIsTiled(tiff_.get())) {
            read_tiles(values);
        } else {
            read_strips(values);
        }
        for (std::size_t row = 0; row < raster.rows / 2; ++row) {  // the northern one comes first in the file
            const auto low = values.begin() + static_cast<std::ptrdiff_t>(row * raster.columns);
            std::swap_ranges(low, low + width_, values.end() - static_cast<std::ptrdiff_t>((row + 1) * raster.columns));
        }
    }

    std::vector<std::uint8_t> buffer_of(std::uint64_t size) const {
        constexpr std::uint64_t most = std::uint64_t{1} << 25;
        if (size == 0 || size > most)
            fail("a tile or strip has " + std::to_string(size) + " bytes; allowed: up to 32 MiB");
        return std::vector<std::uint8_t>(size);
    }

    // Strips are decoded as a whole, so that the checksum of a compressed one is compared.
    void read_strips(std::vector<double>& values) {
        const std::uint32_t rows = std::min(field<std::uint32_t>(TIFFTAG_ROWSPERSTRIP, height_), height_);
        if (rows == 0) fail("its strips have no rows");
        std::vector<std::uint8_t> strip = buffer_of(TIFFStripSize64(tiff_.get()));
        for (std::uint32_t row = 0, number = 0; row < height_; row += rows, ++number) {
            const std::size_t cells = std::size_t{std::min(rows, height_ - row)} * width_;
            if (is_sparse(number)) {
                values.resize(values.size() + cells, no_value);
                continue;
            }
            const tmsize_t got =
                TIFFReadEncodedStrip(tiff_.get(), number, strip.data(), static_cast<tmsize_t>(strip.size()));
            if (got < 0 || static_cast<std::size_t>(got) < cells * bits_ / 8)
                fail("row " + std::to_string(row) + " and those below cannot be read: it is damaged or cut short" +
                     why());
            for (std::size_t i = 0; i < cells; ++i) values.push_back(value_at(strip.data(), i));
        }
    }

    void read_tiles(std::vector<double>& values) {
        const auto across = field<std::uint32_t>(TIFFTAG_TILEWIDTH, 0),
                   down = field<std::uint32_t>(TIFFTAG_TILELENGTH, 0);
        if (across == 0 || down == 0) fail("its tiles have no cells");
        std::vector<std::uint8_t> tile = buffer_of(TIFFTileSize64(tiff_.get()));
        if (tile.size() < std::uint64_t{across} * down * bits_ / 8) fail("its tiles do not fit their cells");
        for (std::uint64_t row = 0; row < height_; row += down) {
            const std::size_t high = std::min<std::size_t>(down, height_ - row), first = values.size();
            for (std::uint64_t column = 0; column < width_; column += across) {
                const std::uint32_t number = TIFFComputeTile(tiff_.get(), static_cast<std::uint32_t>(column),
                                                             static_cast<std::uint32_t>(row), 0, 0);
                const bool sparse = is_sparse(number);
                if (!sparse &&
                    TIFFReadEncodedTile(tiff_.get(), number, tile.data(), static_cast<tmsize_t>(tile.size())) <
                        static_cast<tmsize_t>(tile.size()))
                    fail("the tile at row " + std::to_string(row) + ", column " + std::to_string(column) +
                         " cannot be read: it is damaged or cut short" + why());
                if (column == 0) values.resize(first + high * width_, no_value);
                if (sparse) continue;
                const std::size_t wide = std::min<std::size_t>(across, width_ - column);
                for (std::size_t r = 0; r < high; ++r) {
                    for (std::size_t c = 0; c < wide; ++c)
                        values[first + r * width_ + column + c] = value_at(tile.data(), r * across + c);
                }
            }
        }
    }

    // Returns true for a strip or tile without bytes in the file, as GDAL writes those without data. Throws if there is no "no data"
    // value: libtiff guesses lengths, and would read the header's bytes as heights.
    bool is_sparse(std::uint32_t number) const {
        if (TIFFGetStrileOffset(tiff_.get(), number) != 0 && TIFFGetStrileByteCount(tiff_.get(), number) != 0)
            return false;
        if (!no_data_)
            fail(
                std::string(TIFFIsTiled(tiff_.get()) ? "tile " : "strip ") + std::to_string(number) +
                " has no bytes (a sparse file) and there is no value for \"no data\"; allowed: a height for each cell, "
                "or that value. " +
                import_words());
        return true;
    }

    double value_at(const std::uint8_t* from, std::size_t i) const {
        const double value = plain_value_at(from, i);
        return value == no_data_ ? no_value : value;
    }
    double plain_value_at(const std::uint8_t* from, std::size_t i) const {
        if (format_ == SAMPLEFORMAT_IEEEFP) return bits_ == 32 ? typed<float>(from, i) : typed<double>(from, i);
        if (format_ == SAMPLEFORMAT_INT)
            return bits_ == 16 ? typed<std::int16_t>(from, i) : typed<std::int32_t>(from, i);
        if (bits_ == 8) return typed<std::uint8_t>(from, i);
        return bits_ == 16 ? typed<std::uint16_t>(from, i) : typed<std::uint32_t>(from, i);
    }
    template <typename T>
    static double typed(const std::uint8_t* from, std::size_t i) {
        T value;
        std::memcpy(&value, from + i * sizeof(T), sizeof(T));
        return static_cast<double>(value);
    }

    const std::string& name_;
    Memory memory_;
    OpenTiff tiff_;
    std::uint32_t width_ = 0, height_ = 0;
    std::uint16_t bits_ = 0, format_ = 0;
    bool point_ = false;
    std::optional<double> no_data_;
};

}  // namespace

RasterFile read_geotiff(std::string_view bytes, const std::string& name) {
    return TiffReader(bytes, name).read();
}

void write_geotiff(const std::filesystem::path& file, const MapImage& image, int epsg) {
    prepare_libtiff();
    const auto fail = [&] { throw std::runtime_error(file.string() + " cannot be written: " + last_complaint); };
    clear_name(file);
    OpenTiff tiff(TIFFOpen(file.c_str(), "w"), TIFFClose);
    if (!tiff) fail();
    TIFF* const out = tiff.get();
    const auto width = static_cast<std::uint32_t>(image.columns), height = static_cast<std::uint32_t>(image.rows);
    constexpr std::uint32_t rows_of_strip = 64;
    TIFFSetField(out, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(out, TIFFTAG_IMAGELENGTH, height);
    TIFFSetField(out, TIFFTAG_BITSPERSAMPLE, 32);
    TIFFSetField(out, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(out, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
    TIFFSetField(out, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(out, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(out, TIFFTAG_ROWSPERSTRIP, rows_of_strip);
    TIFFSetField(out, TIFFTAG_COMPRESSION,
                 TIFFIsCODECConfigured(COMPRESSION_ADOBE_DEFLATE) ? COMPRESSION_ADOBE_DEFLATE : COMPRESSION_NONE);
    const std::array<double, 3> scale{image.dx, image.dz, 0};
    const std::array<double, 6> tie{0, 0, 0, image.x, image.z + image.dz * static_cast<double>(image.rows), 0};
    TIFFSetField(out, tag_scale, static_cast<int>(scale.size()), scale.data());
    TIFFSetField(out, tag_tie_point, static_cast<int>(tie.size()), tie.data());
    std::vector<std::uint16_t> keys{
        1, 1, 0, 2, key_model, 0, 1, epsg > 0 ? model_projected : of_no_number, key_raster, 0, 1, raster_is_area};
    if (epsg > 0 && epsg <= std::numeric_limits<std::uint16_t>::max()) {
        keys.insert(keys.end(), {key_projected, 0, 1, static_cast<std::uint16_t>(epsg), key_length_unit, 0, 1, metre});
        keys[3] = 4;
    }
    TIFFSetField(out, tag_keys, static_cast<int>(keys.size()), keys.data());
    TIFFSetField(out, tag_no_data, "nan");
    std::vector<float> row(image.columns);
    for (std::uint32_t from_top = 0; from_top < height; ++from_top) {
        std::copy_n(image.values.data() + (image.rows - 1 - from_top) * image.columns, image.columns, row.begin());
        if (TIFFWriteScanline(out, row.data(), from_top, 0) < 0) fail();
    }
    if (!TIFFFlush(out)) fail();
}

}  // namespace wade
