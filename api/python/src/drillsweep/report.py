"""Printable reports of sweeps and points."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from drillsweep.values import Limits, limits_text

if TYPE_CHECKING:
    from drillsweep.client import Client


class Reported:
    """A sweep or a point, of which the service has a report."""

    _client: Client

    @property
    def path(self) -> str:
        """Its path on the server."""
        raise NotImplementedError

    def report(self, limits: Limits | None = None, units: Literal["si", "field"] = "si") -> str:
        """Printable report, two to four pages: a self-contained HTML document.

        Args:
            limits: Changes of the service's limits, by column in the column's unit; None removes one.
            units: Units of values and pictures.
        """
        return self._client.get_text(f"{self.path}/report", {"limits": limits_text(limits), "units": units})

    def save_report(
        self,
        file: str | Path,
        limits: Limits | None = None,
        units: Literal["si", "field"] = "si",
    ) -> Path:
        """Writes the report to a file that ends in .html."""
        return self._client.save(f"{self.path}/report", file, {"limits": limits_text(limits), "units": units})
