"""The plan of tools/wade paper: which crowds share a run of the fluid, and that their scenes exist."""

import unittest

from wade.suites.paper import plan
from wade.suites.paper.ensembles import crowd_entry


class Plan(unittest.TestCase):
    def all_cases(self):
        return [case for part in plan.PARTS for case in plan.cases_of(part, plan.SETS)]

    def test_every_scene_exists(self):
        for case in self.all_cases():
            self.assertTrue(case.scene.is_file(), case.scene)
            self.assertTrue(case.water.scene.is_file(), case.water.scene)

    def test_a_folder_belongs_to_one_case_and_one_water(self):
        cases, waters = {}, {}
        for case in self.all_cases():
            self.assertEqual(cases.setdefault(case.key, case), case)
            self.assertEqual(waters.setdefault(case.water.key, case.water), case.water)

    def test_table_1_needs_one_run_of_the_fluid_for_each_velocity(self):
        for scene_set in plan.SETS:
            cases = plan.table1_cases(scene_set)
            self.assertEqual(len(cases), 12)
            self.assertEqual(len({case.water for case in cases}), 3)

    def test_both_contact_rules_two_groups_and_the_switch_share_the_waters_of_table_1(self):
        for scene_set in plan.SETS:
            waters = {case.water for case in plan.table1_cases(scene_set)}
            others = [plan.other_case(scene_set, name) for name in ("two_groups", "no_obstacle", "tau_switch")]
            for case in plan.contact_cases(scene_set) + others:
                self.assertIn(case.water, waters)

    def test_the_phase_diagram_has_at_least_8_by_8_points(self):
        cases = plan.phase_cases()
        self.assertGreaterEqual(len(cases), 64)
        self.assertEqual(len({case.water for case in cases}), len(plan.PHASE_V_F))

    def test_the_kinematic_set_has_no_obstacle(self):
        names = {case.name for case in plan.others_cases("observed")}
        self.assertEqual(names, {"two_groups", "no_obstacle", "tau_switch"})

    def test_people_of_all_skills_share_waters_and_have_the_weight_of_the_earth(self):
        for scene_set in plan.MEASURED_V_F:
            cases = [plan.measured_case(scene_set, 1.5, skill) for skill in plan.SKILLS]
            self.assertEqual(len({case.water for case in cases}), 1)
            earth = dict(cases[0].water.changes).get("/world/gravity_m_s2", "the river's own")
            self.assertEqual(earth, "the river's own" if scene_set == "river" else 9.81)

    def test_a_crowd_names_only_what_it_has_otherwise_than_its_water(self):
        water = {"seed": 1, "crowd": {"tau": 0}, "coupling": {"contact_rule": "difference"}, "name": "s01", "world": {}}
        scene = {**water, "seed": 3, "crowd": {"tau": 0.2}}
        entry = crowd_entry("s04-seed3", scene, water, pictures=False)
        changes = {"/crowd": {"tau": 0.2}, "/seed": 3}
        self.assertEqual(entry, {"name": "s04-seed3", "set": changes, "pictures": False})


if __name__ == "__main__":
    unittest.main()
