"""Pictures of run folders, drawn without a screen."""

import matplotlib

matplotlib.use("Agg")
