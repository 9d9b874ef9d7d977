"""Fixtures of the client's tests."""

from __future__ import annotations

import matplotlib

from fixtures import client, server, sweep

__all__ = ["client", "server", "sweep"]

matplotlib.use("Agg")
