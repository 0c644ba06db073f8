"""What an import did, as rows of a table with counts."""


class Notes:
    """Counts of what was done, each with the detail of its first case."""

    def __init__(self):
        self.told, self.filled = {}, 0

    def add(self, what, how, detail="", count=1, residents=0):
        entry = self.told.setdefault((what, how), [0, 0, detail])
        entry[0] += count
        entry[1] += residents

    def rows(self, of=""):
        """Yields what was met, and how many were treated how. `of` names the whole, for example " of 2 rasters"."""
        for (what, how), (count, residents, detail) in self.told.items():
            people = f", with {residents} residents" if residents else ""
            yield what, f"{count}{of}: {how}{people}" + (f" ({detail})" if detail else "")
