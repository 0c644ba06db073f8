"""Checks that the frames do not depend on time: the same command gives the same bits."""

import random
import threading
import time

from wade.conformance.bench import FRAMES, follow
from wade.conformance.expectation import expect


def play(bench, between=None, disturb=None):
    """The digests of the first frames of a run; disturb: called with the run and an event that ends it."""
    run = bench.start()
    consumer = run.join()
    consumer.take()
    over = threading.Event()
    helper = threading.Thread(target=disturb, args=(run, over)) if disturb else None
    if helper:
        helper.start()
    try:
        return follow([consumer], 2 * FRAMES, between)[0]
    finally:
        over.set()
        if helper:
            helper.join()


def expect_same_runs(first, second):
    expect(first.keys() == second.keys(), f"the second run has the same {len(first)} frames", f"{len(second)}")
    for number in first:
        expect(first[number] == second[number], f"frame {number} has the same bits in both runs", "other bits")


def repeat(bench):
    """Two runs give the same bits."""
    bench.demand_repeatable()
    first = play(bench)
    expect_same_runs(first, play(bench))
    return f"{len(first)} frames"


def stalls(bench):
    """The bits do not depend on a consumer that stalls at random."""
    bench.demand_repeatable()
    numbers = random.Random(3)
    pauses = []

    def stall(_consumer, _frame):
        pauses.append(numbers.choice((0, 0, 0, 0.001, 0.01, 0.06)))
        time.sleep(pauses[-1])

    first = play(bench)
    expect_same_runs(first, play(bench, between=stall))
    return f"{len(first)} frames, {sum(p > 0 for p in pauses)} stalls"


def stops(bench):
    """The bits do not depend on a producer that is stopped (SIGSTOP) and continued at random."""
    bench.demand_repeatable()
    numbers = random.Random(4)
    count = [0]

    def stop_and_go(run, over):
        while not over.is_set() and not run.over():
            run.stop()
            time.sleep(numbers.choice((0.001, 0.01, 0.06)))
            run.go_on()
            count[0] += 1
            time.sleep(numbers.uniform(0, 0.01))

    first = play(bench)
    # The pauses spread the stops over the frames of a fast producer.
    expect_same_runs(first, play(bench, between=lambda *_: time.sleep(0.005), disturb=stop_and_go))
    return f"{len(first)} frames, {count[0]} stops"


ALL = (repeat, stalls, stops)
