#include "configs/loading/site_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/files/geojson.hpp"
#include "configs/files/map_system.hpp"
#include "configs/files/polygon_validity.hpp"
#include "configs/files/raster_file.hpp"
#include "configs/files/residents_csv.hpp"
#include "configs/files/series_csv.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fields/lists.hpp"
#include "configs/scene/fields/residents.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/keys.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

// A polygon or a line of a key, inline or of a file, in the scene's metres.
struct Shape {
    MapPolygon polygon;
    MapLine line;
    MapFeature feature;  // of a file, else without name and properties
    std::string label;   // where it stands
};

const Key& key_of_site(std::string_view list, std::string_view name) {
    return scene_keys().find("site")->find(list)->find(name)->key;
}

// Sets those keys of a struct that stand as properties of a feature and are among the names, held to the types and limits of the keys.
class PropertyReader : public Fields {
 public:
    PropertyReader(const MapFeature& feature, std::initializer_list<std::string_view> names)
        : feature_(feature), names_(names) {}

 private:
    void visit(const Key& key, const Member& member) override {
        const Json& value = feature_.properties[key.name];
        if (value.is_null() || std::find(names_.begin(), names_.end(), key.name) == names_.end()) return;
        if (const std::string fault = fault_in_file(value, key); !fault.empty())
            throw ConfigurationError(feature_.label + ": " + std::string(key.name) + ": " + fault);
        member.set(key_value(value, key));
    }
    void visit_object(const Key&, const std::function<void()>&) override {}
    void visit_optional(const Key&, const OptionalMember&) override {}
    void visit_list(const Key&, const ListMember&) override {}

    const MapFeature& feature_;
    std::initializer_list<std::string_view> names_;
};

// The keys of a shape: those of the scene, over which the properties of its feature stand.
template <typename Keys>
Keys keys_of_shape(const Shape& shape, const Keys& of_scene, std::initializer_list<std::string_view> names) {
    Keys keys = of_scene;
    PropertyReader reader(shape.feature, names);
    fields(keys, reader);
    return keys;
}

// Heights as other programs and OpenStreetMap name them, which only the importer reads.
void refuse_heights_of_others(const MapFeature& house) {
    if (!house.properties.is_object() || house.properties.contains("height_m")) return;
    constexpr std::array<std::string_view, 6> others{"height", "building:height", "building_height",
                                                     "levels", "building:levels", "building_levels"};
    for (const auto& [name, value] : house.properties.items()) {
        std::string lower = name;
        for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        const bool is_no_house = lower == "building" && value == "no";
        if (value.is_null() || (!is_no_house && std::find(others.begin(), others.end(), lower) == others.end()))
            continue;
        throw ConfigurationError(house.label + ": it has \"" + name + "\" and no height_m; allowed: height_m, in m. " +
                                 import_words());
    }
}

class SiteReader {
 public:
    SiteReader(const SiteKeys& keys, const std::string& source, Problems& problems)
        : keys_(keys), source_(source), problems_(problems) {}

    Site read(const World& world) {
        take("/ground", [&] { read_ground(); });
        if (!problems_.none()) return std::move(site_);  // without an origin nothing has a position
        find_heights(world.length, world.width);
        each("/houses", keys_.houses, [&](const auto& key, const auto& pointer) { read_houses(key, pointer); });
        take("/manning", [&] { read_manning(); });
        each("/sources", keys_.sources, [&](const auto& key, const auto& pointer) { read_sources(key, pointer); });
        take("/rain", [&] {
            site_.rain =
                series("/rain", keys_.rain.rate, keys_.rain.table, "rate_csv", key_of_site("rain", "rate_mm_h"), false);
        });
        each("/outlets", keys_.outlets, [&](const auto& key, const auto& pointer) { read_outlets(key, pointer); });
        each("/gates", keys_.gates, [&](const auto& key, const auto& pointer) { read_gates(key, pointer); });
        each("/walls", keys_.walls, [&](const auto& key, const auto& pointer) { read_walls(key, pointer); });
        each("/water", keys_.water, [&](const auto& key, const auto& pointer) { read_water(key, pointer); });
        take("/water_depth_file", [&] {
            if (!keys_.water_depth) return;
            site_.water_file = *keys_.water_depth;
            site_.water_depth = raster("/water_depth_file", *keys_.water_depth);
        });
        each("/gauges", keys_.gauges, [&](const auto& key, const auto& pointer) { read_gauges(key, pointer); });
        each("/shelters", keys_.shelters, [&](const auto& key, const auto& pointer) { read_shelters(key, pointer); });
        take("/residents_csv", [&] {
            if (keys_.residents) read_residents_of_table(*keys_.residents);
        });
        take("/houses", [&] { check_count(); });
        return std::move(site_);
    }

 private:
    [[noreturn]] void fail(const std::string& pointer, const std::string& sentence) const {
        throw ConfigurationError(source_ + ": /site" + pointer + ": " + sentence);
    }

    // Notes what `read` throws; what a file is to blame for comes with the key that names the file.
    template <typename Read>
    void take(const std::string& pointer, const Read& read) {
        const std::string key = source_ + ": /site" + pointer;
        try {
            read();
        } catch (const ConfigurationError& error) {
            const std::string sentence = error.what();
            problems_.note(sentence.starts_with(source_ + ": /site") ? sentence : key + ": " + sentence);
        }
    }
    template <typename Key, typename Read>
    void each(const std::string& list, const std::vector<Key>& keys, const Read& read) {
        for (std::size_t i = 0; i < keys.size(); ++i) {
            const std::string pointer = list + "/" + std::to_string(i);
            take(pointer, [&] { read(keys[i], pointer); });
        }
    }

    void read_ground() {
        const GroundKeys& keys = keys_.ground;
        Ground& ground = site_.ground;
        ground.level = keys.level;
        ground.slope_x = keys.slope_x;
        ground.slope_z = keys.slope_z;
        ground.points = keys.points;
        const bool plane = keys.level != 0 || keys.slope_x != 0 || keys.slope_z != 0;
        if (int{keys.file.has_value()} + int{!keys.points.empty()} + int{plane} > 1)
            fail("/ground",
                 "file, points and a plane (level_m, slope_x, slope_z) say different things; allowed: one of them.");
        if (!keys.points.empty() && keys.points.size() < 3)
            fail("/ground/points", std::to_string(keys.points.size()) + " points; allowed: at least 3.");
        constexpr std::size_t most_points = 10'000;  // [A] between which the ground is found by search
        if (keys.points.size() > most_points)
            fail("/ground/points", std::to_string(keys.points.size()) + " points; allowed: up to " +
                                       std::to_string(most_points) + ". Remedy: a raster in /site/ground/file.");
        site_.epsg = keys_.epsg.value_or(0);
        if (const std::string fault = fault_of_system(site_.epsg); !fault.empty()) fail("/epsg", fault);
        std::optional<RasterFile> file;
        if (keys.file) {
            ground.file = *keys.file;
            file = read_raster(*keys.file);
            read_system(*file);
        }
        site_.origin_x = keys_.origin_x.value_or(file ? file->raster.x : 0);
        site_.origin_z = keys_.origin_z.value_or(file ? file->raster.z : 0);
        if (file) ground.raster = moved(std::move(file->raster));
    }

    void read_system(const RasterFile& file) {
        const std::string name = *keys_.ground.file;
        if (!keys_.epsg && !file.epsg)
            fail("/ground/file",
                 name +
                     " names no coordinate system. Remedy: set /site/epsg to the system's number, or to 0 if "
                     "its metres belong to none.");
        if (!keys_.epsg) site_.epsg = *file.epsg;
        if (const std::string fault = fault_of_system(site_.epsg); !fault.empty())
            fail("/ground/file", name + ": " + fault);
        check_system(file.epsg, name);
        const Raster& raster = file.raster;
        const bool on_globe = std::abs(raster.x) <= 360 && std::abs(raster.z) <= 360;
        if (site_.epsg != 0 && raster.cell < 0.01 && on_globe)
            fail("/ground/file", name + ": cells of " + std::to_string(raster.cell) + " at " +
                                     std::to_string(raster.x) + ", " + std::to_string(raster.z) +
                                     " look like degrees; " + reproject_words());
    }

    void check_system(const std::optional<int>& epsg, const std::string& name) const {
        if (!epsg || *epsg == site_.epsg || keys_.epsg == 0) return;
        const std::string system = name + ": it is in EPSG:" + std::to_string(*epsg);
        if (site_.epsg == 0)
            throw ConfigurationError(system + ", and the site names no system. Remedy: set /site/epsg.");
        throw ConfigurationError(system + ", and the site is in EPSG:" + std::to_string(site_.epsg) +
                                 ". Remedy: tools/wade site import FILE --epsg " + std::to_string(site_.epsg) +
                                 " --out DIR reprojects it.");
    }

    std::shared_ptr<const Raster> raster(const std::string&, const std::string& name) const {
        RasterFile file = read_raster(name);
        check_system(file.epsg, name);
        return moved(std::move(file.raster));
    }
    std::shared_ptr<const Raster> moved(Raster raster) const {
        raster.x -= site_.origin_x;
        raster.z -= site_.origin_z;
        return std::make_shared<const Raster>(std::move(raster));
    }

    // The shapes of a key; `lines`, `polygons`: which may be.
    std::vector<Shape> shapes(const std::string& pointer, const std::optional<std::string>& name,
                              const MapLine& polygon, const MapLine& line, bool polygons, bool lines) {
        const std::string allowed = polygons && lines ? "polygon, line or file"
                                    : polygons        ? "polygon or file"
                                                      : "line or file";
        const int given = int{name.has_value()} + int{!polygon.empty()} + int{!line.empty()};
        if (given != 1)
            fail(pointer, (given == 0 ? "it has no place" : "it has several places") +
                              std::string("; allowed: one of ") + allowed + ".");
        if (!polygon.empty()) {
            if (polygon.size() < 3)
                fail(pointer + "/polygon", std::to_string(polygon.size()) + " corners; allowed: at least 3.");
            if (const std::string fault = validity_.fault_of({{{polygon}}}); !fault.empty()) fail(pointer, fault);
            return {{{{polygon}}, {}, {}, "/site" + pointer}};
        }
        if (!line.empty()) {
            if (!has_length(line)) fail(pointer + "/line", one_point);
            return {{{}, line, {}, "/site" + pointer}};
        }
        MapFeatures file = read_features(pointer, *name);
        std::vector<Shape> found;
        for (MapFeature& feature : file.features) {
            if (feature.is_point)
                fail(pointer + "/file", *name + ": " + feature.label +
                                            ": it is a point; allowed: " + (polygons ? "polygons" : "lines") + ".");
            if (feature.polygon.rings.empty() ? !lines : !polygons)
                fail(pointer + "/file", *name + ": " + feature.label + ": it is a " +
                                            (feature.polygon.rings.empty() ? "line" : "polygon") +
                                            "; allowed: " + (polygons ? "polygons" : "lines") + ".");
            if (feature.polygon.rings.empty() && !has_length(feature.line))
                fail(pointer + "/file", *name + ": " + feature.label + ": " + one_point);
            for (MapLine& ring : feature.polygon.rings) move(ring);
            move(feature.line);
            move(feature.doors);
            feature.label = *name + ": " + feature.label;
            Shape shape{
                std::move(feature.polygon), std::move(feature.line), {}, "/site" + pointer + ": " + feature.label};
            shape.feature = std::move(feature);
            found.push_back(std::move(shape));
        }
        return found;
    }
    MapFeatures read_features(const std::string& pointer, const std::string& name) const {
        MapFeatures file = read_geojson(name, site_.epsg == 0);
        check_system(file.epsg, name);
        if (file.features.empty()) fail(pointer + "/file", name + ": it holds no feature; allowed: at least one.");
        return file;
    }
    static bool has_length(const MapLine& line) {
        return std::any_of(line.begin(), line.end(),
                           [&](const MapPoint& p) { return p.x != line[0].x || p.z != line[0].z; });
    }
    void move(MapLine& line) const {
        for (MapPoint& point : line) {
            point.x -= site_.origin_x;
            point.z -= site_.origin_z;
        }
    }

    // A constant or a table of values of the key; `needed`: one of them has to be there.
    Series series(const std::string& pointer, const std::optional<double>& constant,
                  const std::optional<std::string>& file, const std::string& file_key, const Key& key,
                  bool needed) const {
        if ((constant && file) || (needed && !constant && !file))
            fail(pointer, std::string(constant ? "both " : "neither ") + std::string(key.name) +
                              (constant ? " and " : " nor ") + file_key + " is set; allowed: one of them.");
        if (constant && !key.range.contains(*constant))
            fail(pointer + "/" + std::string(key.name), fault_of_value(*constant, key));
        if (constant) return {{0, *constant}};
        return file ? read_series(*file, key) : Series{};
    }

    // The key of a water level, held to the heights of the site's ground as well.
    [[nodiscard]] Key level_key(std::string_view list) const {
        constexpr double reach = 100;  // [A] m; no site's water stands farther above its ground, or ends farther below
        Key key = key_of_site(list, "level_m");
        key.range.lo = std::max(key.range.lo, std::floor(lowest_ - reach));
        key.range.hi = std::min(key.range.hi, std::ceil(highest_ + reach));
        return key;
    }
    void check_level(double level, const std::string& label, const char* key = "level_m") const {
        if (const std::string fault = fault_of_value(level, level_key("water")); !fault.empty())
            throw ConfigurationError(source_ + ": " + label + ": " + key + ": " + fault);
    }

    void find_heights(double length, double width) {
        const Ground& ground = site_.ground;
        lowest_ = INFINITY, highest_ = -INFINITY;
        const auto take_height = [&](double y) {
            if (!(std::abs(y) < 1e5)) return;
            lowest_ = std::min(lowest_, y);
            highest_ = std::max(highest_, y);
        };
        if (ground.raster) {
            for (const double y : ground.raster->values) take_height(y);
        } else if (!ground.points.empty()) {
            for (const auto& point : ground.points) take_height(point[1]);
        } else {
            for (const double x : {0.0, length}) {
                for (const double z : {0.0, width}) take_height(ground_height(ground, {x, z}));
            }
        }
    }

    void read_houses(const HouseKeys& key, const std::string& pointer) {
        for (Shape& shape : shapes(pointer, key.file, key.polygon, {}, true, false)) {
            refuse_heights_of_others(shape.feature);
            const HouseKeys own = keys_of_shape(shape, key, {"name", "height_m", "residents", "upper_floor_m"});
            House house;
            house.name = own.name;
            house.label = shape.label;
            house.height = own.height;
            house.residents = own.residents;
            if (own.upper_floor) house.upper_floor = *own.upper_floor;
            house.doors = shape.feature.doors.empty() ? key.doors : shape.feature.doors;
            house.polygon = std::move(shape.polygon);
            site_.houses.push_back(std::move(house));
        }
    }

    void check_count() const {
        constexpr std::int64_t most = 1'000'000;  // as of a group's grid
        std::int64_t count = site_.residents ? static_cast<std::int64_t>(site_.residents->size()) : 0;
        for (const House& house : site_.houses) count += house.residents;
        if (count > most)
            fail("/houses", std::to_string(count) + " people live there; allowed: up to " + std::to_string(most) + ".");
    }

    void read_manning() {
        Roughness& roughness = site_.roughness;
        roughness.n = keys_.manning.n;
        if (keys_.manning.file) {
            roughness.file = *keys_.manning.file;
            roughness.raster = raster("/manning/file", roughness.file);
            for (const double n : roughness.raster->values) {
                if (std::isnan(n) || (n >= 0 && n <= 1)) continue;
                fail("/manning/file",
                     roughness.file + ": a value of " + std::to_string(n) + "; allowed: 0 to 1 s/m^(1/3).");
            }
        }
        each("/manning/zones", keys_.manning.zones, [&](const ZoneKeys& key, const std::string& pointer) {
            for (Shape& shape : shapes(pointer, key.file, key.polygon, {}, true, false)) {
                const double n = keys_of_shape(shape, key, {"n"}).n;
                roughness.zones.push_back({std::move(shape.polygon), n, shape.label});
            }
        });
    }

    void read_sources(const SourceKeys& key, const std::string& pointer) {
        for (Shape& shape : shapes(pointer, key.file, key.polygon, key.line, true, true)) {
            SourceKeys own = keys_of_shape(shape, key, {"name", "discharge_m3_s"});
            const bool is_property = !std::as_const(shape.feature.properties)["discharge_m3_s"].is_null();
            if (is_property) own.hydrograph.reset();
            Source made;
            made.name = own.name;
            made.label = shape.label;
            made.discharge = series(pointer, own.discharge, own.hydrograph, "hydrograph_csv",
                                    key_of_site("sources", "discharge_m3_s"), true);
            made.polygon = std::move(shape.polygon);
            made.line = std::move(shape.line);
            site_.sources.push_back(std::move(made));
        }
    }

    void read_outlets(const OutletKeys& key, const std::string& pointer) {
        const bool given = key.kind != OutletKind::free;
        if (!given && (key.level || key.stage))
            fail(
                pointer,
                "level_m and stage_csv have no effect on a free outlet; allowed: none, or kind \"stage\" or \"wave\".");
        for (Shape& shape : shapes(pointer, key.file, key.polygon, key.line, true, true)) {
            Outlet outlet;
            outlet.name = keys_of_shape(shape, key, {"name"}).name;
            outlet.label = shape.label;
            outlet.kind = key.kind;
            outlet.polygon = std::move(shape.polygon);
            outlet.line = std::move(shape.line);
            if (given) outlet.stage = series(pointer, key.level, key.stage, "stage_csv", level_key("outlets"), true);
            site_.outlets.push_back(std::move(outlet));
        }
    }

    void read_gates(const GateKeys& key, const std::string& pointer) {
        for (Shape& shape : shapes(pointer, key.file, {}, key.line, false, true)) {
            const GateKeys own = keys_of_shape(shape, key, {"name", "opens_at_s"});
            Barrier& gate = site_.barriers.emplace_back(Barrier{.name = own.name, .line = std::move(shape.line)});
            gate.opens_at = own.opens_at;
            gate.label = shape.label;
        }
    }

    void read_walls(const WallKeys& key, const std::string& pointer) {
        constexpr double thickness = 0.2;  // m
        for (Shape& shape : shapes(pointer, key.file, {}, key.line, false, true)) {
            const WallKeys own = keys_of_shape(shape, key, {"name", "crest_m"});
            if (!own.crest) fail(pointer, "crest_m is missing; allowed: the level of the wall's top, m.");
            check_level(*own.crest, shape.label, "crest_m");
            Barrier& wall = site_.barriers.emplace_back(Barrier{.name = own.name, .line = std::move(shape.line)});
            wall.crest = *own.crest;
            wall.plan = widened(wall.line, thickness);
            wall.label = shape.label;
        }
    }

    void read_water(const WaterKeys& key, const std::string& pointer) {
        if (!key.file && key.polygon.empty()) {
            check_level(key.level, "/site" + pointer);
            site_.water.push_back({{}, key.level, "/site" + pointer});
            return;
        }
        for (Shape& shape : shapes(pointer, key.file, key.polygon, {}, true, false)) {
            const double level = keys_of_shape(shape, key, {"level_m"}).level;
            check_level(level, shape.label);
            site_.water.push_back({std::move(shape.polygon), level, shape.label});
        }
    }

    void read_gauges(const GaugeKeys& key, const std::string& pointer) {
        const auto add = [&](const std::string& name, const MapPoint& at, const std::string& label) {
            const std::string number = std::to_string(site_.gauges.size() + 1);
            site_.gauges.push_back({name.empty() ? number : name, at, label});
        };
        const bool whole = key.x && key.z, part = key.x || key.z;
        if (key.file ? part : !whole) fail(pointer, "allowed: both x_m and z_m, or file, and not all of them.");
        if (whole) return add(key.name, {*key.x, *key.z}, "/site" + pointer);
        MapFeatures file = read_features(pointer, *key.file);
        for (MapFeature& feature : file.features) {
            if (!feature.is_point) fail(pointer + "/file", *key.file + ": " + feature.label + ": allowed: points.");
            move(feature.line);
            add(feature.name.empty() ? key.name : feature.name, feature.line.front(),
                "/site" + pointer + ": " + *key.file + ": " + feature.label);
        }
    }

    void read_residents_of_table(const std::string& name) {
        std::vector<Resident> residents = read_residents(name);
        for (Resident& one : residents) {
            one.x -= site_.origin_x;
            one.z -= site_.origin_z;
        }
        site_.residents = std::make_shared<const std::vector<Resident>>(std::move(residents));
    }

    void read_shelters(const ShelterKeys& key, const std::string& pointer) {
        for (Shape& shape : shapes(pointer, key.file, key.polygon, {}, true, false)) {
            const ShelterKeys own = keys_of_shape(shape, key, {"name", "capacity"});
            site_.shelters.push_back({own.name, std::move(shape.polygon), own.capacity, shape.label, key.is_exit});
        }
    }

    static constexpr const char* one_point = "the line has one point; allowed: at least 2 different ones.";

    const SiteKeys& keys_;
    const std::string& source_;
    Problems& problems_;
    double lowest_ = 0, highest_ = 0;  // of the ground, m
    PolygonValidity validity_;
    Site site_;
};

}  // namespace

void read_site(Scene& scene, const SetByScene& set, const std::string& source, Problems& problems) {
    if (!scene.site_keys) return;
    scene.site = SiteReader(*scene.site_keys, source, problems).read(*scene.world);
    // What its files say is printed, too.
    scene.site_keys->epsg = scene.site->epsg;
    scene.site_keys->origin_x = scene.site->origin_x;
    scene.site_keys->origin_z = scene.site->origin_z;
    if (const Raster* const raster = scene.site->ground.raster.get()) {
        if (!set.length) scene.world->length = raster->x + static_cast<double>(raster->columns) * raster->cell;
        if (!set.width) scene.world->width = raster->z + static_cast<double>(raster->rows) * raster->cell;
    }
    constexpr double most_cells = 1e6;  // of a travel-time field; solving more takes longer than people walk
    double& cell = scene.crowd->navigation.cell;
    const double of_that_many = std::sqrt(scene.world->length * scene.world->width / most_cells);
    if (!set.ways_cell) cell = std::clamp(of_that_many, cell, 10.0);
    if (!set.model) scene.fluid->model = ModelKind::shallow_water;
    count_lodgers(scene);
    scene.channel = Channel();
    scene.channel->flow = Flow::closed;
    scene.channel->x = {0, scene.world->length};
    scene.channel->z = {0, scene.world->width};
}

}  // namespace wade
