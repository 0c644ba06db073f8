#include "crowd_client/outputs/output_list.hpp"

#include "configs/scene/crowd.hpp"
#include "crowd_client/outputs/writers/danger.hpp"
#include "crowd_client/outputs/writers/for_animators.hpp"
#include "crowd_client/outputs/writers/played_events.hpp"
#include "crowd_client/outputs/writers/report.hpp"
#include "crowd_client/outputs/writers/trajectories.hpp"
#include "crowd_client/outputs/writers/water_snapshots.hpp"

namespace wade::crowd {
namespace {

bool with_trajectories(const Scene&, const Record& kept) {
    return kept.trajectories;
}
bool with_water(const Scene&, const Record& kept) {
    return kept.water_interval > 0;
}
bool with_danger(const Scene&, const Record& kept) {
    return kept.danger_window > 0;
}
bool with_terms(const Scene&, const Record& kept) {
    return kept.terms_interval > 0;
}
bool with_poses(const Scene& scene, const Record&) {
    return scene.crowd->pose_rate > 0;
}
bool with_ragdolls(const Scene& scene, const Record&) {
    return has_ragdolls(scene);
}

constexpr std::size_t of_a_database = 3;  // with its log and the index of that

// clang-format off
constexpr std::array registered{
    RegisteredOutput{Turn::growing, {"trajectories.sqlite", "trajectories.rest.sqlite", "trajectories.packed.sqlite"}, of_a_database, with_trajectories, made<Trajectories>},
    RegisteredOutput{Turn::growing, {"water.bin"}, 1, with_water, made<WaterPictures>},
    RegisteredOutput{Turn::growing, {"poses.csv"}, 1, with_poses, made<Poses>},
    RegisteredOutput{Turn::growing, {"ragdoll.csv"}, 1, with_ragdolls, made<Ragdolls>},
    RegisteredOutput{Turn::growing, {"terms.csv"}, 1, with_terms, made<TermsFile>},
    RegisteredOutput{Turn::growing, {"events.jsonl", "scene_as_played.json"}, 0, always, made<EventsFile>},
    RegisteredOutput{Turn::results, {"danger.csv"}, 0, with_danger, made<DangerFile>},
    RegisteredOutput{Turn::results, {"agents.csv"}, 0, always, made<AgentsFile>},
    RegisteredOutput{Turn::report, {"outcome.json"}, 0, always, made<OutcomeFile>},
    RegisteredOutput{Turn::report, {"manifest.json"}, 0, always, made<ManifestFile>},
};
// clang-format on

}  // namespace

std::span<const RegisteredOutput> outputs() {
    return registered;
}

}  // namespace wade::crowd
