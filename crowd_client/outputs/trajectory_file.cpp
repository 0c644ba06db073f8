#include "crowd_client/outputs/trajectory_file.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <charconv>
#include <string>

#include "crowd_client/outputs/output_file.hpp"

namespace wade::crowd {
namespace {

std::string text_of(double v) {
    char buffer[32];
    const auto end = std::to_chars(std::begin(buffer), std::end(buffer), v).ptr;
    return {buffer, end};
}

std::string ring(const Interval& x, const Interval& z) {
    const std::string x0 = text_of(x.lo), x1 = text_of(x.hi), z0 = text_of(z.lo), z1 = text_of(z.hi);
    return "(" + x0 + " " + z0 + ", " + x1 + " " + z0 + ", " + x1 + " " + z1 + ", " + x0 + " " + z1 + ", " + x0 + " " +
           z0 + ")";
}

bool touch(const Interval& a, const Interval& b) {
    return a.lo <= b.hi && b.lo <= a.hi;
}

bool may_be_a_hole(const Scene& scene, const Obstacle& o) {
    if (o.x.lo <= 0 || o.z.lo <= 0 || o.x.hi >= scene.world.length || o.z.hi >= scene.world.width) return false;
    return std::none_of(scene.obstacles.begin(), scene.obstacles.end(), [&](const Obstacle& other) {
        return &other != &o && touch(o.x, other.x) && touch(o.z, other.z);
    });
}

// FNV-1a, cut to the positive range of SQLite's integers.
std::int64_t geometry_hash(const std::string& wkt) {
    std::uint64_t h = 0xcbf29ce484222325ULL;
    for (const char c : wkt) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return static_cast<std::int64_t>(h >> 1);
}

void remove_old(const std::filesystem::path& file) {
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
        std::error_code ignored;
        std::filesystem::remove(file.string() + suffix, ignored);
    }
}

}  // namespace

std::string walkable_area_wkt(const Scene& scene) {
    constexpr double inset = 1e-3;  // m
    const World& world = scene.world;
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

struct TrajectoryFile::Database {
    std::filesystem::path file;
    sqlite3* handle = nullptr;
    sqlite3_stmt* insert_agent = nullptr;
    sqlite3_stmt* insert_frame = nullptr;
    std::int64_t geometry = 0;

    Database() = default;
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;
    ~Database() { release(); }

    // Closing the last connection folds the log in and removes it.
    void release() noexcept {
        sqlite3_finalize(insert_agent);
        sqlite3_finalize(insert_frame);
        sqlite3_close(handle);
        insert_agent = insert_frame = nullptr;
        handle = nullptr;
    }

    [[noreturn]] void fail(int code) const {
        const bool full = code == SQLITE_FULL;
        throw OutputError(file, handle != nullptr ? sqlite3_errmsg(handle) : sqlite3_errstr(code), full);
    }
    void check(int code) const {
        if (code != SQLITE_OK && code != SQLITE_DONE && code != SQLITE_ROW) fail(code);
    }
    void run(const std::string& sql) const { check(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr)); }
    [[nodiscard]] sqlite3_stmt* prepare(const char* sql) const {
        sqlite3_stmt* statement = nullptr;
        check(sqlite3_prepare_v2(handle, sql, -1, &statement, nullptr));
        return statement;
    }
    void execute(sqlite3_stmt* statement) const {
        const int code = sqlite3_step(statement);
        sqlite3_reset(statement);
        check(code);
    }
    void set_metadata(sqlite3_stmt* statement, const std::string& key, const std::string& value) const {
        check(sqlite3_bind_text(statement, 1, key.c_str(), -1, SQLITE_TRANSIENT));
        check(sqlite3_bind_text(statement, 2, value.c_str(), -1, SQLITE_TRANSIENT));
        execute(statement);
    }
};

TrajectoryFile::TrajectoryFile(const std::filesystem::path& file, const Scene& scene, int page_limit)
    : database_(std::make_unique<Database>()) {
    Database& db = *database_;
    db.file = file;
    remove_old(file);
    db.check(sqlite3_open_v2(file.c_str(), &db.handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr));
    // A log instead of a journal: a frame costs one append, not a flush to the disk. A crash of the process loses
    // nothing that was written, a power cut at most the last frames.
    db.run("PRAGMA page_size = 4096; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;");
    if (page_limit > 0) db.run("PRAGMA max_page_count = " + std::to_string(page_limit) + ";");
    db.run(
        "BEGIN;"
        "CREATE TABLE trajectory_data (frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT NULL,"
        " pos_y REAL NOT NULL, ori_x REAL NOT NULL, ori_y REAL NOT NULL);"
        "CREATE TABLE metadata (key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);"
        "CREATE TABLE geometry (hash INTEGER NOT NULL, wkt TEXT NOT NULL);"
        "CREATE TABLE frame_data (frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);"
        "CREATE INDEX frame_id_idx ON trajectory_data (frame, id);");

    sqlite3_stmt* metadata = db.prepare("INSERT INTO metadata VALUES (?, ?)");
    try {
        db.set_metadata(metadata, "version", "2");
        db.set_metadata(metadata, "fps", text_of(scene.crowd.step_rate));
        db.set_metadata(metadata, "xmin", "0");
        db.set_metadata(metadata, "xmax", text_of(scene.world.length));
        db.set_metadata(metadata, "ymin", "0");
        db.set_metadata(metadata, "ymax", text_of(scene.world.width));
    } catch (...) {
        sqlite3_finalize(metadata);
        throw;
    }
    sqlite3_finalize(metadata);

    const std::string wkt = walkable_area_wkt(scene);
    db.geometry = geometry_hash(wkt);
    db.run("INSERT INTO geometry VALUES (" + std::to_string(db.geometry) + ", '" + wkt + "'); COMMIT;");
    db.insert_agent = db.prepare("INSERT INTO trajectory_data VALUES (?, ?, ?, ?, ?, ?)");
    db.insert_frame = db.prepare("INSERT INTO frame_data VALUES (?, ?)");
}

TrajectoryFile::~TrajectoryFile() = default;

void TrajectoryFile::write(std::uint64_t frame, const Agents& agents, const std::vector<std::uint32_t>& active) {
    Database& db = *database_;
    const auto frame_number = static_cast<sqlite3_int64>(frame);
    db.run("BEGIN");
    try {
        sqlite3_bind_int64(db.insert_frame, 1, frame_number);
        sqlite3_bind_int64(db.insert_frame, 2, db.geometry);
        db.execute(db.insert_frame);
        for (const std::uint32_t id : active) {
            sqlite3_bind_int64(db.insert_agent, 1, frame_number);
            sqlite3_bind_int64(db.insert_agent, 2, id);
            sqlite3_bind_double(db.insert_agent, 3, agents.position[id].x());
            sqlite3_bind_double(db.insert_agent, 4, agents.position[id].y());
            sqlite3_bind_double(db.insert_agent, 5, agents.heading[id].x());
            sqlite3_bind_double(db.insert_agent, 6, agents.heading[id].y());
            db.execute(db.insert_agent);
        }
        db.run("COMMIT");
    } catch (...) {
        // SQLite may have rolled back by itself; then this does nothing.
        sqlite3_exec(db.handle, "ROLLBACK", nullptr, nullptr, nullptr);
        throw;
    }
}

void TrajectoryFile::close() {
    Database& db = *database_;
    if (db.handle == nullptr) return;
    sqlite3_finalize(db.insert_agent);
    sqlite3_finalize(db.insert_frame);
    db.insert_agent = db.insert_frame = nullptr;
    db.run("PRAGMA journal_mode = DELETE;");
    db.release();
}

}  // namespace wade::crowd
