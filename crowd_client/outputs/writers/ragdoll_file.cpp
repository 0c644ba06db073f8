#include "crowd_client/outputs/writers/ragdoll_file.hpp"

#include "crowd_client/results/output_file.hpp"

namespace wade::crowd {

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

}  // namespace wade::crowd
