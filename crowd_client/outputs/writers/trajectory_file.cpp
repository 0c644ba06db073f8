#include "crowd_client/outputs/writers/trajectory_file.hpp"

#include <fcntl.h>
#include <sqlite3.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>
#include <string>
#include <utility>

#include "configs/numbers/fnv1a.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/scene_frames.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/results/output_file.hpp"

namespace wade::crowd {
namespace {

// Cut to the positive range of SQLite's integers.
std::int64_t geometry_hash(const std::string& wkt) {
    return static_cast<std::int64_t>(fnv1a(wkt) >> 1);
}

std::filesystem::path beside(const std::filesystem::path& file, const char* word) {
    return file.parent_path() / (file.stem().string() + word + file.extension().string());
}

std::string quoted(const std::string& text) {
    std::string sql = "'";
    for (const char c : text) sql += c == '\'' ? "''" : std::string(1, c);
    return sql + "'";
}

// Whether all of a file is on the disk.
bool flushed(const std::filesystem::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool is_done = ::fsync(descriptor) == 0 || errno == EINVAL || errno == EROFS;
    return ::close(descriptor) == 0 && is_done;
}

void remove_old(const std::filesystem::path& file) {
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
        std::error_code ignored;
        std::filesystem::remove(file.string() + suffix, ignored);
    }
}

}  // namespace

constexpr int rows_at_once = 50;

// Returns the position of an agent, or the point where it left the world.
Vector2d place_in(const World& world, const Vector2d& p) {
    return {std::clamp(p.x(), 0.0, world.length), std::clamp(p.y(), 0.0, world.width)};
}

// Result of an attempt to write.
enum class Access { written, locked, gone };

struct TrajectoryFile::Database {
    std::filesystem::path file;
    sqlite3* handle = nullptr;
    sqlite3_stmt *begin = nullptr, *commit = nullptr;
    sqlite3_stmt* insert_agent = nullptr;
    sqlite3_stmt* insert_agents = nullptr;  // rows_at_once of them, which takes less time
    sqlite3_stmt* insert_frame = nullptr;
    std::int64_t geometry = 0;

    Database(const std::filesystem::path& its_file, const Scene& scene, int pages);
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;
    ~Database() { release(); }

    // Closing the last connection folds the log in and removes it.
    void release() noexcept {
        finalize();
        sqlite3_close(handle);
        handle = nullptr;
    }
    void finalize() noexcept {
        for (sqlite3_stmt** statement : {&begin, &commit, &insert_agent, &insert_agents, &insert_frame}) {
            sqlite3_finalize(*statement);
            *statement = nullptr;
        }
    }

    [[noreturn]] void fail(int code) const {
        const bool full = code == SQLITE_FULL || (code == SQLITE_IOERR && means_full(errno));
        throw OutputError(file, handle != nullptr ? sqlite3_errmsg(handle) : sqlite3_errstr(code), full);
    }
    void check(int code) const {
        if (code != SQLITE_OK && code != SQLITE_DONE && code != SQLITE_ROW) fail(code);
    }
    [[nodiscard]] int try_to(const char* sql) const {
        errno = 0;  // SQLite itself does not report the system's error in all cases
        return sqlite3_exec(handle, sql, nullptr, nullptr, nullptr);
    }
    void run(const std::string& sql) const { check(try_to(sql.c_str())); }
    [[nodiscard]] sqlite3_stmt* prepare(const std::string& sql) const {
        sqlite3_stmt* statement = nullptr;
        check(sqlite3_prepare_v2(handle, sql.c_str(), -1, &statement, nullptr));
        return statement;
    }
    void execute(sqlite3_stmt* statement) const {
        errno = 0;
        if (sqlite3_step(statement) == SQLITE_DONE && sqlite3_reset(statement) == SQLITE_OK) return;
        const int code = sqlite3_errcode(handle);
        try {
            fail(code);
        } catch (...) {
            sqlite3_reset(statement);
            throw;
        }
    }
    void set_metadata(const std::string& key, const std::string& value) const;
    void create_tables(const Scene& scene);

    [[nodiscard]] bool has_moved() const {
        int moved = 0;
        return sqlite3_file_control(handle, "main", SQLITE_FCNTL_HAS_MOVED, &moved) == SQLITE_OK && moved != 0;
    }
    // Writes all rows or none; wait: time to wait for a lock of another program, s.
    [[nodiscard]] Access write(const PathRows& kept, double wait) const;
    void insert(const PathRows& kept) const;
    void insert_rows(sqlite3_stmt* statement, std::span<const PathRows::Row> rows) const;
};

TrajectoryFile::Database::Database(const std::filesystem::path& its_file, const Scene& scene, int pages)
    : file(its_file) {
    remove_old(file);
    try {
        // Without a lock for each call, as one thread at a time uses it.
        constexpr int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
        check(sqlite3_open_v2(file.c_str(), &handle, flags, nullptr));
        sqlite3_busy_timeout(handle, 2000);  // ms, for a program that opens the file at once
        // A log instead of a journal: a frame costs one append, not a flush to the disk. A crash of the process loses
        // nothing that was written, a power cut at most the last frames.
        // The empty file itself needs no journal.
        run("PRAGMA page_size = 4096; PRAGMA synchronous = OFF; PRAGMA journal_mode = OFF; PRAGMA journal_mode = WAL;");
        if (pages > 0) run("PRAGMA max_page_count = " + std::to_string(pages) + ";");
        run("BEGIN IMMEDIATE");
        create_tables(scene);
        run("COMMIT");
        run("PRAGMA synchronous = NORMAL;");
        begin = prepare("BEGIN IMMEDIATE");
        commit = prepare("COMMIT");
        const std::string insert = "INSERT INTO trajectory_data VALUES ", row = "(?, ?, ?, ?, ?, ?)";
        insert_agent = prepare(insert + row);
        std::string rows = row;
        for (int i = 1; i < rows_at_once; ++i) rows += ", " + row;
        insert_agents = prepare(insert + rows);
        insert_frame = prepare("INSERT INTO frame_data VALUES (?, ?)");
    } catch (...) {
        release();
        throw;
    }
}

void TrajectoryFile::Database::create_tables(const Scene& scene) {
    run("CREATE TABLE trajectory_data (frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT NULL,"
        " pos_y REAL NOT NULL, ori_x REAL NOT NULL, ori_y REAL NOT NULL, PRIMARY KEY (frame, id)) WITHOUT ROWID;"
        "CREATE TABLE metadata (key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);"
        "CREATE TABLE geometry (hash INTEGER NOT NULL, wkt TEXT NOT NULL);"
        "CREATE TABLE frame_data (frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);");
    set_metadata("version", "2");
    set_metadata("fps", csv_number(scene.crowd->step_rate / static_cast<double>(steps_per_path_frame(scene))));
    set_metadata("xmin", "0");
    set_metadata("xmax", csv_number(scene.world->length));
    set_metadata("ymin", "0");
    set_metadata("ymax", csv_number(scene.world->width));
    const std::string wkt = walkable_area_wkt(scene);
    geometry = geometry_hash(wkt);
    run("INSERT INTO geometry VALUES (" + std::to_string(geometry) + ", '" + wkt + "');");
}

// Both are words and numbers of our own, without quotes.
void TrajectoryFile::Database::set_metadata(const std::string& key, const std::string& value) const {
    run("INSERT INTO metadata VALUES ('" + key + "', '" + value + "');");
}

void TrajectoryFile::Database::insert_rows(sqlite3_stmt* statement, std::span<const PathRows::Row> rows) const {
    int place = 0;
    for (const PathRows::Row& row : rows) {
        sqlite3_bind_int64(statement, ++place, row.frame);
        sqlite3_bind_int64(statement, ++place, row.id);
        for (const double v : {row.x, row.z, row.heading_x, row.heading_z}) sqlite3_bind_double(statement, ++place, v);
    }
    execute(statement);
}

void TrajectoryFile::Database::insert(const PathRows& kept) const {
    for (const std::int64_t frame : kept.frames) {
        sqlite3_bind_int64(insert_frame, 1, frame);
        sqlite3_bind_int64(insert_frame, 2, geometry);
        execute(insert_frame);
    }
    std::span<const PathRows::Row> left(kept.rows);
    while (!left.empty()) {
        const bool many = left.size() >= rows_at_once;
        const std::size_t count = many ? rows_at_once : 1;
        insert_rows(many ? insert_agents : insert_agent, left.first(count));
        left = left.subspan(count);
    }
}

Access TrajectoryFile::Database::write(const PathRows& kept, double wait) const {
    if (has_moved()) return Access::gone;
    sqlite3_busy_timeout(handle, static_cast<int>(1000 * wait));
    errno = 0;
    sqlite3_step(begin);
    const int code = sqlite3_reset(begin);
    if (code == SQLITE_BUSY || code == SQLITE_LOCKED || code == SQLITE_PROTOCOL) return Access::locked;
    if (code == SQLITE_READONLY) return Access::gone;
    check(code);
    try {
        insert(kept);
        execute(commit);
    } catch (...) {
        // SQLite may have rolled back by itself; then this does nothing.
        sqlite3_exec(handle, "ROLLBACK", nullptr, nullptr, nullptr);
        throw;
    }
    return Access::written;
}

TrajectoryFile::TrajectoryFile(const std::filesystem::path& file, const Scene& scene, const TrajectoryLimits& limits,
                               Warn warn)
    : file_(file),
      rest_file_(beside(file, ".rest")),
      packed_file_(beside(file, ".packed")),
      scene_(scene),
      limits_(limits),
      warn_(std::move(warn)) {
    remove_old(rest_file_);
    remove_old(packed_file_);
    database_ = std::make_unique<Database>(file, scene, limits.pages);
}

TrajectoryFile::~TrajectoryFile() = default;

void TrajectoryFile::write(std::uint64_t frame, const Agents& agents, std::uint64_t after) {
    const auto number = static_cast<std::int64_t>(frame);
    kept_.frames.push_back(number);
    for (std::size_t id = 0; id < agents.size(); ++id) {
        if (agents.outcome[id] != Outcome::active && agents.end_step[id] <= after) continue;
        const Vector2d at = place_in(scene_.world, agents.position[id]), &heading = agents.heading[id];
        kept_.rows.push_back({number, static_cast<std::int64_t>(id), at.x(), at.y(), heading.x(), heading.y()});
    }
    if (kept_.frames.size() < limits_.frames_at_once) return;
    if (!is_gone_) flush();
    if (is_gone_ || kept_.rows.size() + kept_.frames.size() > limits_.kept_rows) spill();
}

// Frames that the disk does not take are lost, as after a crash; all frames before them are whole.
void TrajectoryFile::flush() {
    try {
        const Access access = database_->write(kept_, 0);
        is_gone_ = access == Access::gone;
        if (access != Access::written) return;
    } catch (...) {
        kept_ = {};
        throw;
    }
    kept_.frames.clear();
    kept_.rows.clear();
}

void TrajectoryFile::spill() {
    const PathRows kept = std::exchange(kept_, {});
    if (kept.frames.empty()) return;
    if (!rest_) {
        rest_ = std::make_unique<Database>(rest_file_, scene_, limits_.pages);
        first_in_rest_ = kept.frames.front();
    }
    last_in_rest_ = kept.frames.back();
    if (rest_->write(kept, limits_.patience) == Access::written) return;
    throw OutputError(rest_file_, "another program has it locked, and '" + file_.string() + "' as well", false);
}

void TrajectoryFile::close() {
    if (!database_) return;
    if (!is_gone_ && !kept_.frames.empty() && database_->write(kept_, limits_.patience) == Access::written) kept_ = {};
    spill();
    if (!is_gone_) fold();
    database_.reset();
    if (!rest_) return;
    rest_->finalize();
    rest_->run("PRAGMA journal_mode = DELETE;");
    rest_.reset();
    warn_of_rest();
}

// Needs the file for itself for a moment; programs that only read it are gone soon.
void TrajectoryFile::fold() {
    database_->finalize();
    constexpr int attempts = 10;
    constexpr timespec pause{0, 50'000'000};
    int code = SQLITE_BUSY;
    for (int i = 0; i < attempts; ++i) {
        code = database_->try_to("PRAGMA journal_mode = DELETE;");
        if (code != SQLITE_BUSY && code != SQLITE_LOCKED) break;
        nanosleep(&pause, nullptr);
    }
    if (code != SQLITE_BUSY && code != SQLITE_LOCKED) {
        database_->check(code);
        return pack();
    }
    // Moves as much as possible into the file itself.
    sqlite3_wal_checkpoint_v2(database_->handle, nullptr, SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
    if (!warn_) return;
    const std::string name = file_.string();
    warn_("another program has '" + name + "' open: all frames are in it together with '" + name +
          "-wal', which stays beside it until that program closes it");
}

// Packs into a file beside it, which then replaces it: one of them is always whole. Without space for both the file
// stays as it is.
void TrajectoryFile::pack() {
    constexpr std::uintmax_t worth_it = 1 << 20;  // bytes
    std::error_code error;
    if (std::filesystem::file_size(file_, error) < worth_it || error) return;
    const int code = database_->try_to(("VACUUM INTO " + quoted(packed_file_.string())).c_str());
    const bool is_ours = !database_->has_moved();
    database_.reset();
    if (code == SQLITE_OK && is_ours && flushed(packed_file_)) std::filesystem::rename(packed_file_, file_, error);
    remove_old(packed_file_);
}

void TrajectoryFile::warn_of_rest() const {
    if (!warn_) return;
    warn_("another program " + std::string(is_gone_ ? "moved or deleted" : "kept locked") + " '" + file_.string() +
          "': frames " + std::to_string(first_in_rest_) + " to " + std::to_string(last_in_rest_) +
          ", as far as they are not in it, are in '" + rest_file_.string() + "', a file of the same tables");
}

}  // namespace wade::crowd
