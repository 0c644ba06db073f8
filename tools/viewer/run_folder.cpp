#include <sqlite3.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/files/plain_file.hpp"
#include "configs/json/json.hpp"
#include "configs/scene/scene_frames.hpp"
#include "tools/viewer/sources.hpp"

namespace wade::view {
namespace {

constexpr std::size_t chunk = std::size_t{8} << 20;
constexpr double max_path_points = 300000;
constexpr std::size_t water_head = 64;
constexpr std::size_t most_cells = 16'000'000;            // of a snapshot of water.bin
constexpr std::size_t most_bytes_of_frame = 256U << 20U;  // rows of people
constexpr int most_steps_of_question = 500'000'000;       // of SQLite's machine
constexpr std::size_t most_rows_of_course = 200;
constexpr double max_people_frames = 1e9;  // without rows, by the ticks of a stream

// Cuts the next field off a row of a table.
std::string_view next_field(std::string_view& row) {
    const std::size_t comma = row.find(',');
    const std::string_view field = row.substr(0, comma);
    row.remove_prefix(comma == std::string_view::npos ? row.size() : comma + 1);
    return field;
}

template <typename Number>
Number number_of(std::string_view text, Number otherwise) {
    Number value = otherwise;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

// Returns the index of a word; `other` of a word that is not in the list.
template <std::size_t n>
int index_in(const std::string_view (&words)[n], std::string_view word, int other) {
    const auto found = std::find(std::begin(words), std::end(words), word);
    return found == std::end(words) ? other : static_cast<int>(found - std::begin(words));
}

// A database that is only read, open as long as a question takes: a run that ends meanwhile folds its file.
class Database {
 public:
    // SQLite opens the file by its name, so that a FIFO is excluded first. A view or a trigger of an untrusted file may
    // run for ever: the steps of a question are limited.
    explicit Database(const std::filesystem::path& file) {
        if (!PlainFile(file).is_open()) return;
        if (sqlite3_open_v2(file.c_str(), &handle_, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK) return;
        sqlite3_busy_timeout(handle_, 100);
        sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
        sqlite3_progress_handler(
            handle_, 1'000'000,
            [](void* steps) {
                return static_cast<int>(++*static_cast<int*>(steps) > most_steps_of_question / 1'000'000);
            },
            &steps_);
        is_open_ = true;
    }
    ~Database() { sqlite3_close(handle_); }
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    // Calls visit(statement) for each row; nothing of what cannot be read.
    template <typename Visit>
    void ask(const char* question, std::initializer_list<double> values, Visit&& visit) {
        sqlite3_stmt* statement = nullptr;
        if (!is_open_ || sqlite3_prepare_v2(handle_, question, -1, &statement, nullptr) != SQLITE_OK) return;
        int place = 0;
        for (const double value : values) sqlite3_bind_double(statement, ++place, value);
        while (sqlite3_step(statement) == SQLITE_ROW) visit(statement);
        sqlite3_finalize(statement);
    }

 private:
    sqlite3* handle_ = nullptr;
    bool is_open_ = false;
    int steps_ = 0;  // in millions
};

float column(sqlite3_stmt* row, int k) {
    return static_cast<float>(sqlite3_column_double(row, k));
}

// Returns bytes of a file from an offset on, fewer where the file ends.
std::string part_of(const std::filesystem::path& path, std::uint64_t from, std::size_t bytes) {
    std::string part(bytes, '\0');
    part.resize(PlainFile(path).read(from, part.data(), bytes));
    return part;
}

// The row of a person among rows of a frame; empty if there is none.
std::string row_of(const std::string& rows, std::uint32_t id) {
    const std::string mark = std::to_string(id) + ",";
    for (std::size_t begin = 0, end = 0; (end = rows.find('\n', begin)) != std::string::npos; begin = end + 1) {
        std::string_view row(rows.data() + begin, end - begin);
        next_field(row);
        next_field(row);
        if (row.starts_with(mark)) return rows.substr(begin, end - begin);
    }
    return "";
}

template <typename T>
T value_at(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

// Frames of poses.csv in a second, as the manifest of a run has its scene; 0 if it does not say.
double pose_rate_of(const std::string& manifest) {
    const Json scene = Json::try_parse(manifest).value_or(Json())["resolved_scene"];
    const Json &steps = scene["crowd"]["step_rate_hz"], &rate = scene["crowd"]["poses"]["rate_hz"];
    if (!steps.is_number() || !rate.is_number()) return 0;
    const auto is_rate = [](double v) { return v > 1e-6 && v < 1e6; };
    if (!is_rate(steps.get<double>()) || !is_rate(rate.get<double>())) return 0;
    return steps.get<double>() / static_cast<double>(steps_per_frame_at(steps.get<double>(), rate.get<double>()));
}

}  // namespace

void FrameTable::forget() {
    const std::filesystem::path path = path_;
    *this = FrameTable(path);
}

bool FrameTable::read_on() {
    const PlainFile file(path_);
    if (!file.is_open()) return false;
    const std::uint64_t bytes = file.bytes();
    if (bytes < read_) forget();  // a run that begins anew in this folder
    grows_ = bytes > read_;
    if (!grows_) return false;
    const std::string text = part_of(path_, read_, std::min<std::size_t>(chunk, bytes - read_));
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
        const std::string_view row(text.data() + begin, end - begin);
        if (header_.empty()) {
            header_ = row;
        } else {
            take_row(row, read_ + begin);
        }
    }
    if (begin == 0 && text.size() == chunk) begin = chunk;  // no table has rows as long as this
    read_ += begin;
    return begin > 0 && bytes > read_;
}

void FrameTable::take_row(std::string_view row, std::uint64_t at) {
    const auto frame = number_of(next_field(row), 0LL);
    const double time = number_of(next_field(row), 0.0);
    if (frame != last_frame_) {
        starts_.push_back(at);
        times_.push_back(time);
        numbers_.push_back(static_cast<std::size_t>(std::max(0LL, frame)));
        last_frame_ = frame;
    }
    if (!header_.starts_with("frame,time_s,id,x_m,z_m,state")) return;
    const auto id = number_of(next_field(row), std::uint32_t{0});
    next_field(row);
    next_field(row);
    const int state = index_in(state_words, next_field(row), unknown_state);
    const auto [before, is_new] = states_.try_emplace(id, state);
    if (!is_new && before->second != state) changes_.push_back({time, id, state});
    before->second = state;
}

std::size_t FrameTable::at(double time_s) const {
    const auto after = std::upper_bound(times_.begin(), times_.end(), time_s + 1e-6);
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - times_.begin() - 1));
}

std::string FrameTable::rows_of(std::size_t frame) const {
    const std::uint64_t end = frame + 1 < starts_.size() ? starts_[frame + 1] : read_;
    return part_of(path_, starts_[frame], std::min<std::uint64_t>(end - starts_[frame], most_bytes_of_frame));
}

// The last frame of a run that ends between two frames comes early, so that the one before it counts where there is one.
double FrameTable::rate_hz() const {
    for (const std::size_t back : {std::size_t{2}, std::size_t{1}}) {
        if (times_.size() < back || !(times_[times_.size() - back] > 0)) continue;
        return static_cast<double>(numbers_[times_.size() - back]) / times_[times_.size() - back];
    }
    return 1;
}

double FrameTable::time_of_number(std::size_t number, double rate_hz) const {
    const double time = static_cast<double>(number) / rate_hz;
    return !numbers_.empty() && number == numbers_.back() ? std::min(time, times_.back()) : time;
}

std::string FrameTable::rows_of_number(std::size_t number) const {
    const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), number);
    const bool is_there = found != numbers_.end() && *found == number;
    return is_there ? rows_of(static_cast<std::size_t>(found - numbers_.begin())) : "";
}

RunFolder::RunFolder(std::filesystem::path folder, bool may_be_empty)
    : folder_(std::move(folder)), poses_(folder_ / "poses.csv"), terms_(folder_ / "terms.csv") {
    if (may_be_empty) return;
    if (!std::filesystem::is_directory(folder_))
        throw ConfigurationError(folder_.string() + " is no run folder; allowed: a folder that --out has named.");
    const char* names[] = {"outcome.json", "manifest.json", "poses.csv", "trajectories.sqlite", "water.bin"};
    const bool is_run = std::any_of(std::begin(names), std::end(names),
                                    [&](const char* name) { return std::filesystem::exists(folder_ / name); });
    if (!is_run)
        throw ConfigurationError(folder_.string() +
                                 " holds no run: no outcome.json, poses.csv, trajectories.sqlite or water.bin.");
}

bool RunFolder::read_on(double passed_s) {
    const bool more = poses_.read_on();
    if (!more) passed_s_ = passed_s;
    const std::uint64_t bytes = PlainFile(folder_ / "manifest.json").bytes();
    if (!poses_.header().empty() && bytes != std::exchange(manifest_bytes_, bytes))
        scene_pose_rate_ = pose_rate_of(text_of("manifest.json"));
    const bool more_terms = terms_.read_on();
    look_at_water();
    if (looks_++ % 5 == 0) look_at_paths();
    return more || more_terms;
}

void RunFolder::look_at_paths() {
    const auto file = folder_ / "trajectories.sqlite";
    if (!std::filesystem::exists(file)) return;
    Database database(file);
    database.ask("SELECT value FROM metadata WHERE key = 'fps'", {},
                 [&](sqlite3_stmt* row) { paths_per_s_ = sqlite3_column_double(row, 0); });
    database.ask("SELECT max(frame) FROM frame_data", {}, [&](sqlite3_stmt* row) {
        path_frames_ = static_cast<std::size_t>(std::max<sqlite3_int64>(0, sqlite3_column_int64(row, 0)) + 1);
    });
}

void RunFolder::look_at_water() {
    const PlainFile file(folder_ / "water.bin");
    char head[water_head];
    if (file.read(0, head, sizeof head) < sizeof head) return;
    columns_ = value_at<std::uint32_t>(head + 8);
    rows_ = value_at<std::uint32_t>(head + 12);
    cell_ = value_at<double>(head + 16);
    x0_ = value_at<double>(head + 24);
    z0_ = value_at<double>(head + 32);
    const bool is_sound = std::string_view(head, 8) == "WADEWAT1" && columns_ > 0 && rows_ > 0 &&
                          columns_ <= most_cells / rows_ && cell_ > 0 && std::isfinite(cell_) && std::isfinite(x0_) &&
                          std::isfinite(z0_);
    water_problem_ = is_sound ? "" : "water.bin is refused: no snapshots of 1 to 16,000,000 cells";
    if (!is_sound) return snapshot_times_.clear();
    const std::size_t record = 16 + std::size_t{2} * columns_ * rows_;
    const std::uint64_t bytes = file.bytes();
    const std::size_t whole = (bytes - water_head) / record;  // the last one may be cut off
    if (whole < snapshot_times_.size()) snapshot_times_.clear();
    while (snapshot_times_.size() < whole) {
        char start[16];
        if (file.read(water_head + record * snapshot_times_.size(), start, sizeof start) < sizeof start) return;
        const double time = value_at<double>(start + 8);
        if (!std::isfinite(time) || (!snapshot_times_.empty() && time <= snapshot_times_.back())) {
            water_problem_ = "water.bin is refused from snapshot " + std::to_string(snapshot_times_.size()) +
                             " on: its times do not increase";
            return;
        }
        snapshot_times_.push_back(time);
    }
}

// The rate of the manifest is exact and there before the first row; the table's own counts where the manifest is another run's.
double RunFolder::pose_rate() const {
    const double rows = poses_.frames() > 0 ? poses_.rate_hz() : 0, scene = scene_pose_rate_;
    const bool is_unknown = poses_.frames() < 2;
    return scene > 0 && (is_unknown || std::abs(rows - scene) < 0.1 * scene) ? scene : rows;
}

std::size_t RunFolder::people_frames() const {
    if (!has_poses()) return paths_per_s_ > 0 ? path_frames_ : 0;
    const std::size_t whole = poses_.whole_frames(), with_rows = whole > 0 ? poses_.number(whole - 1) + 1 : 0;
    if (!(passed_s_ > 0)) return with_rows;
    return std::max(with_rows,
                    static_cast<std::size_t>(std::min(max_people_frames, passed_s_ * pose_rate() + 1e-6)) + 1);
}

double RunFolder::people_time(std::size_t frame) const {
    return has_poses() ? poses_.time_of_number(frame, pose_rate()) : static_cast<double>(frame) / paths_per_s_;
}

Message RunFolder::people(std::size_t frame) const {
    if (people_frames() == 0) return nullptr;
    frame = std::min(frame, people_frames() - 1);
    constexpr std::size_t fields = std::size(people_fields);
    std::vector<std::array<float, fields>> rows;
    if (has_poses()) {
        const std::string text = poses_.rows_of_number(frame);
        std::string_view rest = text;
        while (!rest.empty()) {
            const std::size_t end = rest.find('\n');
            if (end == std::string_view::npos) break;
            std::string_view row = rest.substr(0, end);
            rest.remove_prefix(end + 1);
            next_field(row);  // frame
            next_field(row);  // time
            auto& values = rows.emplace_back();
            for (std::size_t k = 0; k < fields; ++k) {
                const std::string_view field = next_field(row);
                values[k] = k == 3   ? static_cast<float>(index_in(state_words, field, unknown_state))
                            : k == 4 ? static_cast<float>(index_in(posture_words, field, 0))
                                     : number_of(field, k + 1 == fields ? -1.0F : 0.0F);
            }
        }
    } else {
        const auto f = static_cast<double>(frame);
        Database(folder_ / "trajectories.sqlite")
            .ask(
                "SELECT a.id, a.pos_x, a.pos_y, a.ori_x, a.ori_y, coalesce(b.pos_x, a.pos_x), coalesce(b.pos_y, "
                "a.pos_y) "
                "FROM trajectory_data a LEFT JOIN trajectory_data b ON b.frame = a.frame + 1 AND b.id = a.id "
                "WHERE a.frame = ?",
                {f}, [&](sqlite3_stmt* row) {
                    auto& values = rows.emplace_back();
                    values[0] = column(row, 0);
                    values[1] = column(row, 1);
                    values[2] = column(row, 2);
                    values[5] = std::atan2(column(row, 4), column(row, 3));
                    values[6] = static_cast<float>(paths_per_s_) *
                                std::hypot(column(row, 5) - values[1], column(row, 6) - values[2]);
                    values[3] = untold_state;  // paths hold none
                    values[fields - 1] = -1;
                });
    }
    MessageHead head;
    head.kind = kind_people;
    head.count = static_cast<std::uint32_t>(rows.size());
    head.fields = static_cast<std::uint32_t>(fields);
    head.time_s = people_time(frame);
    head.frame = static_cast<double>(frame);
    Message message = new_message(head);
    for (std::size_t k = 0; k < fields; ++k) {
        const auto array = array_of(message, head, k);
        for (std::size_t i = 0; i < rows.size(); ++i) array[i] = rows[i][k];
    }
    return message;
}

Message RunFolder::paths(double from_s) const {
    // The crowd creates the file before poses.csv.
    const bool has_none = !poses_.header().empty() && !std::filesystem::exists(folder_ / "trajectories.sqlite");
    if (paths_per_s_ <= 0 && !has_none) return nullptr;
    double rows = 0;
    Database database(folder_ / "trajectories.sqlite");
    const double from = std::floor(from_s * paths_per_s_);
    database.ask("SELECT count(*) FROM trajectory_data WHERE frame >= ?", {from},
                 [&](sqlite3_stmt* row) { rows = sqlite3_column_double(row, 0); });
    const double step = std::max(1.0, std::ceil(rows / max_path_points));
    std::array<std::vector<float>, 4> points;
    database.ask(
        "SELECT id, frame, pos_x, pos_y FROM trajectory_data WHERE frame >= ? AND frame % ? = 0 ORDER BY id, frame",
        {from, step}, [&](sqlite3_stmt* row) {
            points[0].push_back(column(row, 0));
            points[1].push_back(static_cast<float>(sqlite3_column_double(row, 1) / paths_per_s_));
            points[2].push_back(column(row, 2));
            points[3].push_back(column(row, 3));
        });
    MessageHead head;
    head.kind = kind_paths;
    head.count = static_cast<std::uint32_t>(points[0].size());
    head.fields = 4;
    head.time_s = from_s;
    head.stride = static_cast<std::uint32_t>(step);
    Message message = new_message(head);
    for (std::size_t k = 0; k < 4; ++k)
        std::copy(points[k].begin(), points[k].end(), array_of(message, head, k).begin());
    return message;
}

Message RunFolder::depths(double time_s) const {
    if (snapshot_times_.empty()) return nullptr;
    const auto after = std::upper_bound(snapshot_times_.begin(), snapshot_times_.end(), time_s + 1e-6);
    const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - snapshot_times_.begin() - 1));
    MessageHead head;
    head.kind = kind_depths;
    head.count = columns_ * rows_;
    head.fields = 1;
    head.time_s = snapshot_times_[k];
    head.frame = static_cast<double>(k);
    if (k + 1 < snapshot_times_.size()) head.lasts_s = static_cast<float>(snapshot_times_[k + 1] - snapshot_times_[k]);
    head.columns = columns_;
    head.x0_m = static_cast<float>(x0_);
    head.z0_m = static_cast<float>(z0_);
    head.cell_m = static_cast<float>(cell_);
    std::vector<std::uint16_t> millimetres(head.count);
    const std::uint64_t from = water_head + k * (16 + std::uint64_t{2} * head.count) + 16;
    if (PlainFile(folder_ / "water.bin").read(from, millimetres.data(), 2 * millimetres.size()) <
        2 * millimetres.size())
        return nullptr;
    Message message = new_message(head);
    std::transform(millimetres.begin(), millimetres.end(), array_of(message, head, 0).begin(),
                   [](std::uint16_t depth) { return 0.001F * static_cast<float>(depth); });
    return message;
}

std::string RunFolder::terms(std::uint32_t id, double time_s) const {
    if (terms_.frames() == 0) return "";
    const std::string row = row_of(terms_.rows_of(terms_.at(time_s)), id);
    return row.empty() ? "" : terms_.header() + "\n" + row;
}

std::string RunFolder::course(std::uint32_t id) const {
    std::string rows = terms_.header();
    const std::size_t step = 1 + terms_.frames() / most_rows_of_course;
    for (std::size_t frame = 0; frame < terms_.frames(); frame += step) {
        const std::string row = row_of(terms_.rows_of(frame), id);
        if (!row.empty()) rows += "\n" + row;
    }
    return rows;
}

std::string RunFolder::text_of(const std::string& name) const {
    constexpr std::size_t most = 4 << 20;
    return part_of(folder_ / name, 0, std::min<std::uint64_t>(PlainFile(folder_ / name).bytes(), most));
}

}  // namespace wade::view
