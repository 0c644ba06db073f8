// The walkable area of a scene as well-known text: the geometry of trajectory files.

#include <geos_c.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/site.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/outputs/writers/trajectory_file.hpp"
#include "crowd_client/results/output_file.hpp"

namespace wade::crowd {
namespace {

std::string ring(const Interval& x, const Interval& z) {
    const std::string x0 = csv_number(x.lo), x1 = csv_number(x.hi), z0 = csv_number(z.lo), z1 = csv_number(z.hi);
    return "(" + x0 + " " + z0 + ", " + x1 + " " + z0 + ", " + x1 + " " + z1 + ", " + x0 + " " + z1 + ", " + x0 + " " +
           z0 + ")";
}

bool touch(const Interval& a, const Interval& b) {
    return a.lo <= b.hi && b.lo <= a.hi;
}

bool may_be_a_hole(const Scene& scene, const Obstacle& o) {
    if (o.x.lo <= 0 || o.z.lo <= 0 || o.x.hi >= scene.world->length || o.z.hi >= scene.world->width) return false;
    return std::none_of(scene.obstacles.begin(), scene.obstacles.end(), [&](const Obstacle& other) {
        return &other != &o && touch(o.x, other.x) && touch(o.z, other.z);
    });
}

struct Destroy {
    GEOSContextHandle_t context;
    void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(context, geometry); }
};
using Geometry = std::unique_ptr<GEOSGeometry, Destroy>;

// A context of GEOS, which outlives its geometries. It keeps the message of the last error.
class Geos {
 public:
    Geos() { GEOSContext_setErrorMessageHandler_r(context, keep, &message_); }
    ~Geos() { GEOS_finish_r(context); }
    Geos(const Geos&) = delete;
    Geos& operator=(const Geos&) = delete;

    // Throws ConfigurationError if a call failed. `subject`: the scene key or the house that the call was for.
    void check(bool succeeded, const std::string& subject) const {
        if (succeeded) return;
        throw ConfigurationError(subject + ": the walkable area without houses cannot be computed: " + message_ +
                                 "; allowed: rings of at least 3 corners that do not cross themselves.");
    }

    // Takes ownership of what a call returned.
    [[nodiscard]] Geometry own(GEOSGeometry* result, const std::string& subject) const {
        check(result != nullptr, subject);
        return Geometry(result, Destroy{context});
    }

    const GEOSContextHandle_t context = GEOS_init_r();

 private:
    static void keep(const char* message, void* kept) { *static_cast<std::string*>(kept) = message; }

    std::string message_;
};

// Returns the area that a ring encloses, also if the ring touches itself.
Geometry area_of(const Geos& geos, const MapLine& line, const std::string& subject) {
    std::vector<double> corners;
    for (const MapPoint& p : line) corners.insert(corners.end(), {p.x, p.z});
    if (!line.empty()) corners.insert(corners.end(), {line.front().x, line.front().z});
    GEOSCoordSequence* const points =
        GEOSCoordSeq_copyFromBuffer_r(geos.context, corners.data(), static_cast<unsigned>(corners.size() / 2), 0, 0);
    geos.check(points != nullptr, subject);
    const Geometry closed = geos.own(GEOSGeom_createLinearRing_r(geos.context, points), subject);  // owns the points
    const Geometry edges = geos.own(GEOSNode_r(geos.context, closed.get()), subject);
    return geos.own(GEOSBuildArea_r(geos.context, edges.get()), subject);
}

// Returns the points inside an odd number of the rings.
Geometry plan_of(const Geos& geos, const House& house) {
    Geometry plan = geos.own(GEOSGeom_createEmptyPolygon_r(geos.context), house.label);
    for (const MapLine& line : house.polygon.rings) {
        const Geometry area = area_of(geos, line, house.label);
        plan = geos.own(GEOSSymDifference_r(geos.context, plan.get(), area.get()), house.label);
    }
    return plan;
}

Geometry united(const Geos& geos, const std::vector<House>& houses, const std::string& subject) {
    std::vector<Geometry> plans;
    plans.reserve(houses.size());
    for (const House& house : houses) plans.push_back(plan_of(geos, house));
    std::vector<GEOSGeometry*> members;  // which the collection owns
    members.reserve(plans.size());
    for (Geometry& plan : plans) members.push_back(plan.release());
    const Geometry all = geos.own(GEOSGeom_createCollection_r(geos.context, GEOS_GEOMETRYCOLLECTION, members.data(),
                                                              static_cast<unsigned>(members.size())),
                                  subject);
    return geos.own(GEOSUnaryUnion_r(geos.context, all.get()), subject);
}

double area_of(const Geos& geos, const GEOSGeometry* part) {
    double area = 0;
    GEOSArea_r(geos.context, part, &area);
    return area;
}

// Writes the corners in reverse: GEOS' normal form has outer rings clockwise and holes counter-clockwise.
std::string ring(const Geos& geos, const GEOSGeometry* line) {
    const GEOSCoordSequence* const points = GEOSGeom_getCoordSeq_r(geos.context, line);
    unsigned count = 0;
    GEOSCoordSeq_getSize_r(geos.context, points, &count);
    std::string text;
    for (unsigned k = count; k-- > 0;) {
        double x = 0, z = 0;
        GEOSCoordSeq_getXY_r(geos.context, points, k, &x, &z);
        text += (text.empty() ? "(" : ", ") + csv_number(x) + " " + csv_number(z);
    }
    return text + ")";
}

// Returns the largest part of the world without the houses.
std::string streets_wkt(const World& world, const std::vector<House>& houses) {
    const std::string subject = "/site/houses";
    const Geos geos;
    const Geometry ground =
        geos.own(GEOSGeom_createRectangle_r(geos.context, 0, 0, world.length, world.width), subject);
    const Geometry buildings = united(geos, houses, subject);
    const Geometry parts = geos.own(GEOSDifference_r(geos.context, ground.get(), buildings.get()), subject);
    geos.check(GEOSNormalize_r(geos.context, parts.get()) == 0, subject);
    const GEOSGeometry* largest = nullptr;
    for (int k = 0; k < GEOSGetNumGeometries_r(geos.context, parts.get()); ++k) {
        const GEOSGeometry* const part = GEOSGetGeometryN_r(geos.context, parts.get(), k);
        if (largest == nullptr || area_of(geos, part) > area_of(geos, largest)) largest = part;
    }
    if (largest == nullptr || GEOSisEmpty_r(geos.context, largest) != 0) return "POLYGON EMPTY";
    std::string text = "POLYGON (" + ring(geos, GEOSGetExteriorRing_r(geos.context, largest));
    for (int k = 0; k < GEOSGetNumInteriorRings_r(geos.context, largest); ++k)
        text += ", " + ring(geos, GEOSGetInteriorRingN_r(geos.context, largest, k));
    return text + ")";
}

}  // namespace

std::string walkable_area_wkt(const Scene& scene) {
    constexpr double inset = 1e-3;  // m
    const World& world = scene.world;
    if (scene.site && !scene.site->houses.empty()) return streets_wkt(world, scene.site->houses);
    std::string wkt = "POLYGON (" + ring({0, world.length}, {0, world.width});
    for (const Obstacle& o : scene.obstacles) {
        Interval x{std::max(o.x.lo, 0.0), std::min(o.x.hi, world.length)};
        Interval z{std::max(o.z.lo, 0.0), std::min(o.z.hi, world.width)};
        if (!may_be_a_hole(scene, o)) {
            x = {x.lo + inset, x.hi - inset};
            z = {z.lo + inset, z.hi - inset};
        }
        if (x.lo < x.hi && z.lo < z.hi) wkt += ", " + ring(x, z);
    }
    return wkt + ")";
}

}  // namespace wade::crowd
