"""Ends of commands by signals: SIGINT, SIGTERM and SIGHUP raise Ended, so that unfinished files are removed."""

import signal


class Ended(KeyboardInterrupt):
    """A signal asked the command to end."""

    def __init__(self, number=signal.SIGINT):
        super().__init__(number)
        self.number = signal.Signals(number)


def raise_on_signals():
    """Makes signals raise Ended, except signals that are ignored (nohup) or have another handler."""

    def end(number, _frame):
        for other in (signal.SIGTERM, signal.SIGHUP):  # the children have got them, too
            signal.signal(other, signal.SIG_IGN)
        raise Ended(number)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, end)


def exit_code(interrupt):
    """128 and the number of the signal; SIGINT of a bare KeyboardInterrupt."""
    return 128 + getattr(interrupt, "number", signal.SIGINT)


def words(interrupt):
    """"interrupted by SIGTERM"."""
    return f"interrupted by {getattr(interrupt, 'number', signal.SIGINT).name}"
