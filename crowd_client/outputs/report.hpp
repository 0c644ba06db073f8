#pragma once
// The texts of a run folder: outcome.json, agents.csv, manifest.json.

#include <string>

#include "crowd_client/outputs/run_labels.hpp"
#include "crowd_client/outputs/run_summary.hpp"
#include "crowd_client/outputs/writers/danger.hpp"

namespace wade::crowd {

// outcome.json; what is not known is null.
[[nodiscard]] std::string outcome_json(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels);

// agents.csv: id,group,outcome,time_s,x_m,z_m,tau,mass_kg,path_length_m,max_depth_m,max_dv_m2_s,mean_depth_m,mean_dv_m2_s.
// Numbers have as many digits as it takes to read back the same bits. time_s: of arrival, of death or of the last step. With a record of danger,
// its columns follow: the largest level that the agent met, and the time in each.
[[nodiscard]] std::string agents_csv(const CrowdWorld& crowd, const DangerRecord* danger = nullptr);

// A row of crowds.csv behind the crowd's name: seed,status,agents,arrived,dead,active,last_arrival_s.
[[nodiscard]] std::string crowds_csv_row(const CrowdWorld& crowd, const RunSummary& summary);

// manifest.json: which program, scene, seed and command made the folder; holds the resolved scene.
[[nodiscard]] std::string manifest_json(const CrowdWorld& crowd, const RunSummary& summary, const RunLabels& labels);

}  // namespace wade::crowd
