"""Rules of the comparison of models: kept, cheapest, near, useless, the same; runs nothing."""

import math
import unittest
from types import SimpleNamespace

from wade.suites.cases import Case
from wade.suites.models import outcomes, rules, sections
from wade.suites.models.outcomes import COMPLETED, FAILED, LEFT_OUT, REFUSED, Outcome, judged_metrics, missed, worst

LIMITS = {("dam", "depth", "coarse"): 0.1, ("dam", "depth", "medium"): 0.05, ("dam", "clamps", "coarse"): 0.0,
          ("wave", "depth", "coarse"): 0.1, ("wave", "told", "coarse"): None}


def run(model, cpu, depth, case="dam", level="coarse", **more):
    metrics = [{"name": "depth", "value": depth, "unit": "1"}]
    metrics += [{"name": name, "value": value, "unit": "1"} for name, value in more.items()]
    return Outcome(case, level, model, 0.1, COMPLETED, metrics=metrics, cpu=cpu, simulated=2.0, commit="abc")


class Limits(unittest.TestCase):
    def test_only_metrics_with_a_limit_are_judged(self):
        outcome = run("dfsph", 1, 0.05, case="wave", told=9.0, other=9.0)
        self.assertEqual([judged.name for judged in judged_metrics(outcome, LIMITS)], ["depth"])

    def test_the_worst_is_the_one_furthest_above_its_limit(self):
        outcome = run("dfsph", 1, 0.05, clamps=3)
        self.assertEqual((worst(outcome, LIMITS).name, worst(outcome, LIMITS).ratio), ("clamps", math.inf))
        self.assertEqual([judged.name for judged in missed(outcome, LIMITS)], ["clamps"])

    def test_a_limit_is_kept_at_its_value_and_by_0_where_it_is_0(self):
        self.assertEqual(missed(run("dfsph", 1, 0.1, clamps=0), LIMITS), [])

    def test_what_could_not_be_measured_is_missed(self):
        self.assertEqual(missed(run("dfsph", 1, None), LIMITS)[0].ratio, math.inf)

    def test_nothing_to_judge_without_limits_or_result(self):
        self.assertIsNone(worst(run("dfsph", 1, 0.05, level="fine"), LIMITS))
        self.assertIsNone(worst(Outcome("dam", "coarse", "dfsph", 0.1, REFUSED), LIMITS))

    def test_cost_is_per_simulated_second(self):
        self.assertEqual(run("dfsph", 3, 0.1).cost, 1.5)
        self.assertIsNone(Outcome("dam", "coarse", "dfsph", 0.1, COMPLETED, cpu=3).cost)


class Rules(unittest.TestCase):
    def test_grades_end_at_the_limit_and_at_the_factor(self):
        self.assertEqual([rules.grade(r) for r in (0, 1, 1.01, rules.NEAR, 2.01, math.inf)],
                         [rules.GOOD, rules.GOOD, rules.CLOSE, rules.CLOSE, rules.USELESS, rules.USELESS])

    def test_the_cheapest_must_keep_all_limits(self):
        found = [run("dfsph", 8, 0.05), run("shallow_water", 1, 0.02, clamps=0), run("steering", 0.1, 0.3),
                 run("kinematic", 0.1, 0.01, clamps=1)]
        self.assertEqual(rules.cheapest(found, "dam", LIMITS).model, "shallow_water")
        self.assertIsNone(rules.cheapest(found[2:], "dam", LIMITS))

    def test_the_cheapest_may_have_any_resolution(self):
        found = [run("dfsph", 1, 0.2), run("dfsph", 9, 0.04, level="medium"), run("steering", 5, 0.3)]
        self.assertEqual(rules.cheapest(found, "dam", LIMITS).level, "medium")

    def test_nearest_where_none_keeps_the_limits(self):
        found = [run("dfsph", 8, 0.15), run("steering", 1, 0.3), run("steering", 4, 0.06, level="medium")]
        nearest, its = rules.nearest(found, "dam", ("dfsph", "steering"), LIMITS)
        self.assertEqual((nearest.model, nearest.level), ("steering", "medium"))
        self.assertAlmostEqual(its.ratio, 1.2)

    def test_by_grade_takes_the_best_resolution_of_each_case(self):
        found = [run("steering", 1, 0.3), run("steering", 4, 0.04, level="medium"),
                 run("steering", 1, 0.3, case="wave")]
        graded = rules.by_grade(found, "steering", ["dam", "wave"], LIMITS)
        self.assertEqual([o.level for o, _ in graded[rules.GOOD]], ["medium"])
        self.assertEqual([o.case for o, _ in graded[rules.USELESS]], ["wave"])

    def test_where_limits_only_guard_dfsph_sets_them(self):
        found = [run("dfsph", 8, 0.5, case="lee", impulse_median=0.1),
                 run("steering", 1, 0.5, case="lee", impulse_median=0.12)]
        limits = {("lee", "depth", "coarse"): 1.0, ("lee", "impulse_median", "coarse"): 0.5}
        reasons = {("lee", "depth"): "a guard", ("lee", "impulse_median"): "a guard against what breaks"}
        graded = rules.limits_of_people(found, limits, reasons)
        self.assertAlmostEqual(graded["lee", "impulse_median", "coarse"], 0.11)
        self.assertEqual([bool(missed(o, graded)) for o in found], [False, True])
        self.assertEqual(rules.limits_of_people(found[1:], limits, reasons), limits)
        self.assertEqual(rules.limits_of_people(found, limits, {("lee", "depth"): "two centimetres"}), limits)

    def test_guards_are_known_by_their_reason(self):
        reasons = {("a", "x"): "a guard against this", ("a", "y"): "reported: no limit", ("b", "x"): "two centimetres"}
        self.assertEqual([rules.only_guarded(case, reasons) for case in "abc"], [True, False, False])


class Words(unittest.TestCase):
    FOUND = [run("dfsph", 8, 0.05), run("steering", 1, 0.3), run("shallow_water", 0.5, 0.15),
             Outcome("dam", "coarse", "kinematic", 0.1, REFUSED, "needs a stream")]
    MODELS = ("dfsph", "shallow_water", "steering", "kinematic")

    def test_the_table_of_grades_names_the_cases(self):
        text = sections.grades_section(self.FOUND, self.MODELS, LIMITS, {})
        rows = {line.split("|")[1].strip(): [cell.strip() for cell in line.split("|")[2:-1]]
                for line in text.splitlines()
                if line.startswith("| ")}
        self.assertEqual(rows["DFSPH"], ["1: `dam`", "0", "0", "0"])
        self.assertEqual(rows["shallow water"], ["0", "1: `dam` (depth 0.15 of 0.1)", "0", "0"])
        self.assertEqual(rows["steering"], ["0", "0", "1: `dam` (depth 0.3 of 0.1)", "0"])
        self.assertEqual(rows["kinematic"], ["0", "0", "0", "1"])

    def test_the_table_says_met_missed_or_cannot(self):
        table = sections.cases_section(self.FOUND, self.MODELS, LIMITS)
        row = next(line for line in table.splitlines() if "`dam`" in line)
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        self.assertEqual(cells[2:], ["met: depth 0.05 of 0.1; 8 s", "**missed**: depth 0.15 of 0.1; 0.5 s",
                                     "**missed**: depth 0.3 of 0.1; 1 s", "cannot"])

    def test_the_cheapest_is_named_with_how_much_dearer_dfsph_is(self):
        found = [*self.FOUND, run("mixed", 2, 0.02)]
        table = sections.cheapest_section(found, (*self.MODELS, "mixed"), LIMITS, {})
        self.assertRegex(table, r"\| `dam` +\| mixed +\| coarse +\| 1 +\| 4 +\|")

    def test_rows_of_the_table_hold_value_limit_and_verdict(self):
        rows = [dict(zip(outcomes.COLUMNS, row)) for o in self.FOUND for row in outcomes.rows_of(o, LIMITS)]
        self.assertEqual([(row["model"], row["met"], row["status"]) for row in rows],
                         [("dfsph", "yes", "completed"), ("steering", "no", "completed"),
                          ("shallow_water", "no", "completed"), ("kinematic", "", "refused")])
        self.assertEqual((rows[0]["limit"], rows[0]["cpu_s_per_sim_s"], rows[3]["remark"]),
                         ("0.1", "4", "needs a stream"))


class Running(unittest.TestCase):
    CASES = [Case("dam 0.1 0.05 quick=coarse")]

    def plan_with(self, coarse, models=("steering",)):
        """Outcomes of two resolutions where the coarse one comes to this, and the resolutions that were asked for."""
        asked = []

        def one_run(point):
            asked.append(point.level)
            if coarse.status == REFUSED:
                return {"status": "failed", "error": coarse.remark, "refused": True}
            if coarse.status == FAILED:
                return {"status": "failed", "error": coarse.remark}
            return {"status": "completed", "model": point.model, "metrics": [], "particles": 1,
                    "solver_cpu_s": coarse.cpu,
                    "simulated_s": 2.0, "git": "abc"}

        plan = [(self.CASES[0], level) for level in ("coarse", "medium")]
        return outcomes.run_cases(plan, models, SimpleNamespace(one_run=one_run, time_limit=100)), asked

    def test_a_finer_run_that_is_too_dear_is_left_out_and_named(self):
        found, asked = self.plan_with(run("steering", 10, 0.1))
        self.assertEqual((asked, found[1].status), (["coarse"], LEFT_OUT))
        self.assertIn("160 s", found[1].remark)
        self.assertEqual(self.plan_with(run("steering", 5, 0.1))[1], ["coarse", "medium"])

    def test_a_refusal_is_asked_for_once(self):
        found, asked = self.plan_with(Outcome("dam", "coarse", "steering", 0.1, REFUSED, "because"))
        self.assertEqual((asked, found[1].status, found[1].remark), (["coarse"], REFUSED, "because"))

    def test_nothing_finer_after_a_failure(self):
        self.assertEqual(self.plan_with(Outcome("dam", "coarse", "steering", 0.1, FAILED, "fell"))[1], ["coarse"])

    def test_a_case_that_runs_another_model_has_refused(self):
        document = {"status": "completed", "model": "dfsph"}
        point = outcomes.Point("dam", "coarse", 0.1, "steering")
        self.assertEqual(outcomes.outcome_of(point, document).status, REFUSED)

    def test_water_that_follows_people_is_told_where_they_are(self):
        point = outcomes.Point("dam", "coarse", 0.1, "mixed")
        self.assertEqual(point.overrides(), ["/fluid/model=mixed", "/coupling/agents_stream=serial"])

    def test_why_a_model_is_refused_is_told_without_file_names(self):
        error = 'validate: /a/b.json: /fluid/model: "kinematic" does not flow; allowed: "dfsph".'
        self.assertEqual(outcomes.reason(error), '"kinematic" does not flow; allowed: "dfsph".')


if __name__ == "__main__":
    unittest.main()
