#include "crowd_client/outputs/writers/for_animators.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "crowd_client/standing.hpp"

namespace wade::crowd {
namespace {

void add_whole(std::string& row, long long value) {
    char buffer[24];
    row.append(buffer, std::to_chars(std::begin(buffer), std::end(buffer), value).ptr);
}

// A number rounded to thousandths, without zeros at its end.
void add_number(std::string& row, double value) {
    const long long all = std::llround(value * 1000), size = std::abs(all);
    row += all < 0 ? ",-" : ",";
    add_whole(row, size / 1000);
    const long long rest = size % 1000;
    if (rest == 0) return;
    const char digits[3] = {static_cast<char>('0' + rest / 100), static_cast<char>('0' + rest / 10 % 10),
                            static_cast<char>('0' + rest % 10)};
    row += '.';
    row.append(digits, digits[2] != '0' ? 3 : digits[1] != '0' ? 2 : 1);
}

// Whom each holds, ids ascending.
struct Hand {
    std::uint32_t id, held;
    auto operator<=>(const Hand&) const = default;  // NOLINT(modernize-use-nullptr): a 0 of the compiler
};
std::vector<Hand> hands_of(const std::vector<Link>& links) {
    std::vector<Hand> all;
    for (const Link& link : links) {
        all.push_back({link.a, link.b});
        all.push_back({link.b, link.a});
    }
    std::sort(all.begin(), all.end());
    return all;
}

// Ids with a blank between.
void add_hands(std::string& row, std::span<const Hand> hands, std::uint32_t id) {
    char before = ',';
    for (auto hand = std::lower_bound(hands.begin(), hands.end(), Hand{id, 0}); hand != hands.end() && hand->id == id;
         ++hand) {
        row += before;
        add_whole(row, hand->held);
        before = ' ';
    }
    if (before == ',') row += before;
}

void add_row(std::string& rows, const CrowdWorld& crowd, std::uint32_t id, std::span<const Hand> hands) {
    const World& world = crowd.scene.world;
    const Vector2d& place = crowd.agents.position[id];
    const Pose& pose = crowd.poses[id];
    add_number(rows, std::clamp(place.x(), 0.0, world.length));  // who was carried over the fall left there
    add_number(rows, std::clamp(place.y(), 0.0, world.width));
    rows.append(",").append(state_name(crowd, id));
    rows.append(",").append(postures[static_cast<std::size_t>(pose.posture)]);
    const double phase = std::floor(pose.gait_phase * 1000) / 1000;  // below 1
    for (const double v : {pose.heading.value, std::sqrt(pose.velocity.value.squaredNorm()), phase,
                           pose.step_length.value, pose.hip.value, pose.lean.value.x(), pose.lean.value.y(),
                           pose.turning.value.x(), pose.turning.value.y(), pose.turning.value.z()}) {
        add_number(rows, v);
    }
    add_hands(rows, hands, id);
    rows += '\n';
}

}  // namespace

RagdollFile::RagdollFile(const std::filesystem::path& file) : file_(file) {
    file_.append("frame,id,hip_height_m,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s\n");
}

void RagdollFile::write(std::uint64_t frame, std::span<const Ragdoll> ragdolls, const Agents& agents) {
    rows_.clear();
    for (const Ragdoll& r : ragdolls) {
        if (agents.outcome[r.id] != Outcome::active) continue;
        rows_ += std::to_string(frame) + ',' + std::to_string(r.id) + ',' + csv_number(r.hip_height);
        for (const double rate : r.rate) rows_ += ',' + csv_number(rate);
        rows_ += '\n';
    }
    if (!rows_.empty()) file_.append(rows_);
}

PoseFile::PoseFile(const std::filesystem::path& file) : file_(file) {
    file_.append(
        "frame,time_s,id,x_m,z_m,state,posture,heading_rad,speed_m_s,gait_phase,step_length_m,hip_height_m,"
        "lean_x_rad,lean_z_rad,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s,holds\n");
}

void PoseFile::write(std::uint64_t frame, const CrowdWorld& crowd, std::uint64_t after) {
    const std::vector<Hand> hands = hands_of(crowd.links);
    std::string begin = std::to_string(frame);
    add_number(begin, time_of(crowd));
    begin += ',';
    rows_.clear();
    for (std::uint32_t id = 0; id < crowd.agents.size(); ++id) {
        if (crowd.agents.outcome[id] != Outcome::active && crowd.agents.end_step[id] <= after) continue;
        rows_ += begin;
        add_whole(rows_, id);
        add_row(rows_, crowd, id, hands);
    }
    if (!rows_.empty()) file_.append(rows_);
}

}  // namespace wade::crowd
