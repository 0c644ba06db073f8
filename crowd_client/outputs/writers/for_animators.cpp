#include "crowd_client/outputs/writers/for_animators.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "configs/scene/site.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/standing.hpp"

namespace wade::crowd {
namespace {

void add_whole(std::string& row, long long value) {
    char buffer[24];
    row.append(buffer, std::to_chars(std::begin(buffer), std::end(buffer), value).ptr);
}

// Appends a number rounded to thousandths, without zeros at its end.
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

// Pairs of linked agents, ids ascending.
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

// Appends the ids of linked agents with a blank between.
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
    add_number(rows, std::clamp(place.x(), 0.0, world.length));  // an agent swept over the outfall ends at the edge
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
    if (crowd.scene.site) add_number(rows, ground_height(crowd.scene.site->ground, {place.x(), place.y()}));
    rows += '\n';
}

// Appends a vector, or two empty fields.
void add_pair(std::string& row, bool is_there, const Vector2d& v) {
    if (!is_there) {
        row += ",,";
        return;
    }
    add_number(row, v.x());
    add_number(row, v.y());
}

// Appends a number, or an empty field.
void add_if(std::string& row, bool is_there, double v) {
    if (is_there) return add_number(row, v);
    row += ',';
}

// Appends the terms of `id`, which has index k in the lists of the step.
void add_terms(std::string& rows, const CrowdWorld& crowd, std::uint32_t id, std::size_t k) {
    const Agents& agents = crowd.agents;
    const People& people = agents.people;
    const bool by_body = people.by_body[id] != 0, feels = crowd.feeling.has_value();
    add_number(rows, agents.tau[id]);
    add_number(rows, agents.mass[id]);
    add_pair(rows, true, crowd.walking[k]);
    add_if(rows, !by_body, crowd.contacts[k].mass);
    add_pair(rows, !by_body, crowd.contacts[k].momentum);
    add_pair(rows, true, agents.velocity[id]);
    add_if(rows, by_body || feels, by_body ? people.depth[id] : feels ? crowd.felt[k].depth : 0);
    add_pair(rows, by_body || feels,
             by_body ? mean_stream(people, id)
             : feels ? crowd.felt[k].velocity
                     : Vector2d(Vector2d::Zero()));
    add_if(rows, by_body, people.slip[id]);
    add_if(rows, by_body, people.topple[id]);
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

PoseFile::PoseFile(const std::filesystem::path& file, bool in_a_site) : file_(file) {
    file_.append(
        std::string("frame,time_s,id,x_m,z_m,state,posture,heading_rad,speed_m_s,gait_phase,step_length_m,hip_height_m,"
                    "lean_x_rad,lean_z_rad,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s,holds") +
        (in_a_site ? ",ground_m\n" : "\n"));
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

TermsFile::TermsFile(const OutputPlace& place)
    : file_(place.folder / "terms.csv"),
      steps_between_(
          static_cast<std::uint64_t>(std::max(1LL, std::llround(place.kept.terms_interval / place.crowd.dt)))) {
    file_.append(
        "frame,time_s,id,tau,mass_kg,walking_x_m_s,walking_z_m_s,water_mass_kg,water_momentum_x_kg_m_s,"
        "water_momentum_z_kg_m_s,velocity_x_m_s,velocity_z_m_s,depth_m,stream_x_m_s,stream_z_m_s,slip,topple\n");
}

void TermsFile::on_step(const CrowdWorld& crowd, const WaterView&) {
    if (crowd.steps % steps_between_ != 0) return;
    std::string begin = std::to_string(next_frame_++);
    add_number(begin, time_of(crowd));
    begin += ',';
    rows_.clear();
    const Agents& agents = crowd.agents;
    std::size_t k = 0;
    for (std::uint32_t id = 0; id < agents.size(); ++id) {
        // The lists hold the agents that were active as the last part of the step began.
        const bool ended_now = agents.end_step[id] == crowd.steps && agents.end_before[id] == 0;
        if (agents.outcome[id] != Outcome::active && !ended_now) continue;
        rows_ += begin;
        add_whole(rows_, id);
        add_terms(rows_, crowd, id, k++);
    }
    if (!rows_.empty()) file_.append(rows_);
}

}  // namespace wade::crowd
