#pragma once
// The words of scenes: what each choice is called in files, messages and documents. They stand here and nowhere else.
//
//   name_of(Flow::closed)              "closed"
//   choice_named<Flow>("closed")       Flow::closed; nothing for a word that is none
//   names_of<Flow>()                   all of them, in the order of documents

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/steering.hpp"
#include "configs/scene/world.hpp"

namespace wade {

template <typename Choice>
struct Named {
    std::string_view name;
    Choice choice;
};

// Specialised below for each enum that a scene can set.
template <typename Choice>
struct Words;

template <>
struct Words<Ends> {
    static constexpr std::array<Named<Ends>, 2> all{{{"open", Ends::open}, {"periodic", Ends::periodic}}};
};
template <>
struct Words<Flow> {
    static constexpr std::array<Named<Flow>, 4> all{{{"emitter", Flow::emitter},
                                                     {"recirculating", Flow::recirculating},
                                                     {"periodic", Flow::periodic},
                                                     {"closed", Flow::closed}}};
};
template <>
struct Words<Sides> {
    static constexpr std::array<Named<Sides>, 2> all{{{"walls", Sides::walls}, {"periodic", Sides::periodic}}};
};
template <>
struct Words<Top> {
    static constexpr std::array<Named<Top>, 3> all{
        {{"open", Top::open}, {"wall", Top::wall}, {"periodic", Top::periodic}}};
};
template <>
struct Words<Plane> {
    static constexpr std::array<Named<Plane>, 7> all{{{"bed", Plane::bed},
                                                      {"top", Plane::top},
                                                      {"x_min", Plane::x_min},
                                                      {"x_max", Plane::x_max},
                                                      {"z_min", Plane::z_min},
                                                      {"z_max", Plane::z_max},
                                                      {"obstacles", Plane::obstacles}}};
};
template <>
struct Words<InitialRiver> {
    static constexpr std::array<Named<InitialRiver>, 2> all{
        {{"dry", InitialRiver::dry}, {"filled", InitialRiver::filled}}};
};
template <>
struct Words<ModelKind> {
    static constexpr std::array<Named<ModelKind>, 6> all{{{"dfsph", ModelKind::dfsph},
                                                          {"kinematic", ModelKind::kinematic},
                                                          {"shallow_water", ModelKind::shallow_water},
                                                          {"steering", ModelKind::steering},
                                                          {"mixed", ModelKind::mixed},
                                                          {"auto", ModelKind::automatic}}};
};
template <>
struct Words<VelocityProfile> {
    static constexpr std::array<Named<VelocityProfile>, 2> all{
        {{"uniform", VelocityProfile::uniform}, {"logarithmic", VelocityProfile::logarithmic}}};
};
template <>
struct Words<Arrangement> {
    static constexpr std::array<Named<Arrangement>, 2> all{
        {{"random", Arrangement::random}, {"lattice", Arrangement::lattice}}};
};
template <>
struct Words<CohesionForm> {
    static constexpr std::array<Named<CohesionForm>, 2> all{
        {{"equal", CohesionForm::equal}, {"growing", CohesionForm::growing}}};
};
template <>
struct Words<LossForm> {
    static constexpr std::array<Named<LossForm>, 2> all{
        {{"relative", LossForm::relative}, {"absolute", LossForm::absolute}}};
};
template <>
struct Words<SteeringWalls> {
    static constexpr std::array<Named<SteeringWalls>, 3> all{
        {{"force", SteeringWalls::force}, {"constraint", SteeringWalls::constraint}, {"both", SteeringWalls::both}}};
};
template <>
struct Words<KernelKind> {
    static constexpr std::array<Named<KernelKind>, 4> all{{{"cubic_spline", KernelKind::cubic_spline},
                                                           {"quartic_spline", KernelKind::quartic_spline},
                                                           {"wendland_c2", KernelKind::wendland_c2},
                                                           {"auto", KernelKind::automatic}}};
};
template <>
struct Words<ResponseKind> {
    static constexpr std::array<Named<ResponseKind>, 2> all{
        {{"paper", ResponseKind::paper}, {"measured", ResponseKind::measured}}};
};
template <>
struct Words<WalkingLaw> {
    static constexpr std::array<Named<WalkingLaw>, 2> all{
        {{"relative", WalkingLaw::relative}, {"bernardini", WalkingLaw::bernardini}}};
};
template <>
struct Words<Publish> {
    static constexpr std::array<Named<Publish>, 2> all{{{"all", Publish::all}, {"near_agents", Publish::near_agents}}};
};
template <>
struct Words<StartRule> {
    static constexpr std::array<Named<StartRule>, 2> all{{{"grid", StartRule::grid}, {"houses", StartRule::houses}}};
};
template <>
struct Words<GoalRule> {
    static constexpr std::array<Named<GoalRule>, 2> all{{{"point", GoalRule::point}, {"shelters", GoalRule::shelters}}};
};
template <>
struct Words<LeavingRule> {
    static constexpr std::array<Named<LeavingRule>, 5> all{{{"at_once", LeavingRule::at_once},
                                                            {"normal", LeavingRule::normal},
                                                            {"weibull", LeavingRule::weibull},
                                                            {"table", LeavingRule::table},
                                                            {"never", LeavingRule::never}}};
};
template <>
struct Words<SlopeRule> {
    static constexpr std::array<Named<SlopeRule>, 2> all{{{"level", SlopeRule::level}, {"tobler", SlopeRule::tobler}}};
};
template <>
struct Words<SexRule> {
    static constexpr std::array<Named<SexRule>, 3> all{
        {{"any", SexRule::any}, {"female", SexRule::female}, {"male", SexRule::male}}};
};
template <>
struct Words<HandInHand> {
    static constexpr std::array<Named<HandInHand>, 3> all{
        {{"none", HandInHand::none}, {"along_x", HandInHand::along_x}, {"along_z", HandInHand::along_z}}};
};
template <>
struct Words<Hold> {
    static constexpr std::array<Named<Hold>, 2> all{{{"hands", Hold::hands}, {"arms", Hold::arms}}};
};
template <>
struct Words<Skill> {
    static constexpr std::array<Named<Skill>, 6> all{{{"braced", Skill::braced},
                                                      {"good", Skill::good},
                                                      {"normal", Skill::normal},
                                                      {"unaware", Skill::unaware},
                                                      {"poor", Skill::poor},
                                                      {"by_size", Skill::by_size}}};
};
template <>
struct Words<SpeedRule> {
    static constexpr std::array<Named<SpeedRule>, 3> all{
        {{"pi", SpeedRule::pi}, {"per_frame", SpeedRule::per_frame}, {"per_second", SpeedRule::per_second}}};
};
template <>
struct Words<MarkerRule> {
    static constexpr std::array<Named<MarkerRule>, 2> all{
        {{"fixed", MarkerRule::fixed}, {"redrawn", MarkerRule::redrawn}}};
};
template <>
struct Words<BodyRule> {
    static constexpr std::array<Named<BodyRule>, 3> all{
        {{"none", BodyRule::none}, {"fast", BodyRule::fast}, {"human", BodyRule::human}}};
};
template <>
struct Words<NavigationRule> {
    static constexpr std::array<Named<NavigationRule>, 3> all{{{"auto", NavigationRule::automatic},
                                                               {"straight", NavigationRule::straight},
                                                               {"travel_time", NavigationRule::travel_time}}};
};
template <>
struct Words<EvasionRule> {
    static constexpr std::array<Named<EvasionRule>, 3> all{
        {{"off", EvasionRule::off}, {"flee", EvasionRule::flee}, {"evasion", EvasionRule::evasion}}};
};
template <>
struct Words<RagdollCondition> {
    static constexpr std::array<Named<RagdollCondition>, 4> all{{{"off", RagdollCondition::off},
                                                                 {"paper", RagdollCondition::paper},
                                                                 {"local_speed", RagdollCondition::local_speed},
                                                                 {"depth_speed", RagdollCondition::depth_speed}}};
};
template <>
struct Words<ContactRule> {
    static constexpr std::array<Named<ContactRule>, 2> all{
        {{"difference", ContactRule::difference}, {"sum", ContactRule::sum}}};
};
template <>
struct Words<CouplingRule> {
    static constexpr std::array<Named<CouplingRule>, 2> all{
        {{"per_frame", CouplingRule::per_frame}, {"continuous", CouplingRule::continuous}}};
};
template <>
struct Words<AgentsStream> {
    static constexpr std::array<Named<AgentsStream>, 3> all{
        {{"off", AgentsStream::off}, {"serial", AgentsStream::serial}, {"parallel", AgentsStream::parallel}}};
};
template <>
struct Words<OutletKind> {
    static constexpr std::array<Named<OutletKind>, 3> all{
        {{"free", OutletKind::free}, {"stage", OutletKind::stage}, {"wave", OutletKind::wave}}};
};
template <>
struct Words<Shelter> {
    static constexpr std::array<Named<Shelter>, 2> all{{{"off", Shelter::off}, {"wake", Shelter::wake}}};
};

template <typename Choice>
[[nodiscard]] std::string name_of(Choice choice) {
    for (const auto& [name, value] : Words<Choice>::all) {
        if (value == choice) return std::string(name);
    }
    return "?";
}

// As scenes write it: "closed" with its quotation marks.
template <typename Choice>
[[nodiscard]] std::string quoted(Choice choice) {
    return std::string("\"").append(name_of(choice)).append("\"");
}

template <typename Choice>
[[nodiscard]] std::optional<Choice> choice_named(std::string_view word) {
    for (const auto& [name, value] : Words<Choice>::all) {
        if (name == word) return value;
    }
    return std::nullopt;
}

template <typename Choice>
[[nodiscard]] std::vector<std::string> names_of() {
    std::vector<std::string> names;
    names.reserve(Words<Choice>::all.size());
    for (const auto& [name, value] : Words<Choice>::all) names.emplace_back(name);
    return names;
}

}  // namespace wade
