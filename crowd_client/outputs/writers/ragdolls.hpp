#pragma once
// ragdoll.csv: the ragdolls of a run, step by step (ragdoll_file.hpp).

#include "crowd_client/outputs/output_writer.hpp"
#include "crowd_client/outputs/writers/ragdoll_file.hpp"

namespace wade::crowd {

class Ragdolls final : public OutputWriter {
 public:
    explicit Ragdolls(const OutputPlace& place) : file_(place.folder / "ragdoll.csv") {}

    void on_step(const CrowdWorld& crowd, const WaterView&) override {
        file_.write(crowd.steps, crowd.ragdolls, crowd.agents);
    }
    void finish(const RunView&) override {}

 private:
    RagdollFile file_;
};

}  // namespace wade::crowd
