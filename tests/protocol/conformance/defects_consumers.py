"""Defects in how consumers come and go, and in how a stream ends."""

import signal
import time

from python_producer import Publisher

from wade.conformance import system
from wade.conformance.layout import CLOSED, DRAINING, LEFT, ConsumerPage


class WaitsForTheSecondConsumerOnly(Publisher):
    caught_by = "two_consumers"

    def takes_part(self, i):
        return super().takes_part(i) and (i == 1 or not super().takes_part(1))


class KnowsFourConsumers(Publisher):
    caught_by = "sixteen_consumers"

    def admit(self, i, frame):
        if i < 4:
            super().admit(i, frame)


class AdmitsInThePast(Publisher):
    caught_by = "late_joiner"

    def admit(self, i, frame):
        super().admit(i, max(1, frame - 2))


class AnswersButDoesNotWait(Publisher):
    """Admits a late consumer, but goes on without it."""

    caught_by = "late_joiner"

    def takes_part(self, i):
        return super().takes_part(i) and self.admitted[i] <= 1


class NeverForgets(Publisher):
    caught_by = "leaver"

    def forget(self, i):
        pass


class StumblesOverAHastyLeaver(Publisher):
    """Admits every consumer that has asked for a page, even after it has left."""

    caught_by = "hasty_leaver"

    def survey(self, frame):
        for i in range(len(self.admitted)):
            if self.consumer(i, ConsumerPage.STATE) == LEFT and not self.admitted[i] and frame:
                self.admit(i, frame)
                return super().survey(frame) + [i]
        return super().survey(frame)


class WaitsForReaders(Publisher):
    caught_by = "latest"

    def takes_part(self, i):
        return bool(self.admitted[i]) and self.consumer(i, ConsumerPage.STATE) == 1


class DiesWithAReader(Publisher):
    caught_by = "latest_dies"

    def check_alive(self, owed):
        for i, admitted in enumerate(self.admitted):
            if admitted and self.consumer(i, ConsumerPage.STATE) == 1 and not system.is_locked_by_other(self.fd, 1 + i):
                self.died(i)


class DoesNotKnowFollowers(Publisher):
    caught_by = "follower"

    def goes_on(self, active):
        return bool(active)


class DropsFollowers(Publisher):
    """Does not wait for followers."""

    caught_by = "follower"

    def takes_part(self, i):
        return super().takes_part(i) and not self.consumer(i, ConsumerPage.FLAGS)


class LeavesItsObject(Publisher):
    caught_by = "end"

    def unlink(self):
        pass


class ClosesTooEarly(Publisher):
    caught_by = "end"

    def close(self):
        self.enter(DRAINING)
        self.end(CLOSED)


class NeverDrains(Publisher):
    """Goes from running to closed."""

    caught_by = "end"

    def enter(self, state):
        if state != DRAINING:
            super().enter(state)


class GoesOnAlone(Publisher):
    """Does not notice that no consumer is left."""

    caught_by = "all_leave"

    def goes_on(self, active):
        if not active:
            time.sleep(0.05)
        return True

    def play(self):
        self.options.frames = 1_000_000
        return super().play()


class IgnoresAnAbort(Publisher):
    caught_by = "consumer_aborts"

    def gave_up(self, i):
        self.forget(i)


class AbortsWithoutAReason(Publisher):
    caught_by = "consumer_aborts"

    def abort(self, code, text):
        super().abort(code, "")


class RepeatsTextsAsTheyAre(Publisher):
    caught_by = "hostile_texts"

    def printable(self, text):
        return text


class IgnoresADeath(Publisher):
    caught_by = "consumer_killed"

    def died(self, i):
        pass


class WrongExitCode(Publisher):
    caught_by = "consumer_killed"

    def exit_code(self, failure):
        return 1 if failure.code == 4 else failure.code


class LooksAwayWhileDraining(Publisher):
    """Does not look at locks any more once the last frame is out."""

    caught_by = "consumer_killed_at_end"

    def check_alive(self, owed):
        if self.published < self.options.frames:
            super().check_alive(owed)


class TrustsAcknowledgements(Publisher):
    caught_by = "false_acknowledgement"

    def check_acknowledgement(self, i):
        pass


class BelievesAnyWords(Publisher):
    caught_by = "overwritten_words"

    def check_words(self, i, state):
        pass


class BelievesAnyGoodbye(Publisher):
    caught_by = "false_goodbye"

    def has_gone(self, i):
        return True


class DiesOfSigterm(Publisher):
    caught_by = "sigterm"

    def __init__(self, options):
        super().__init__(options)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


class DiesOfSigint(Publisher):
    caught_by = "sigint"

    def __init__(self, options):
        super().__init__(options)
        signal.signal(signal.SIGINT, signal.SIG_DFL)


class DeafBeforeTheStart(Publisher):
    """Does not look at signals while it waits for the first consumer."""

    caught_by = "signal_before"

    def remember(self, number, frame):
        if self.published:
            super().remember(number, frame)


class WaitsForEver(Publisher):
    caught_by = "step_timeout"

    def someone_pauses(self):
        return self.published > 0


class CountsAPause(Publisher):
    caught_by = "paused_consumer"

    def someone_pauses(self):
        return False


class NeverGivesUpWaiting(Publisher):
    caught_by = "nobody_comes"

    def wait_for_consumers(self):
        self.options.attach_timeout_s = 0
        super().wait_for_consumers()
