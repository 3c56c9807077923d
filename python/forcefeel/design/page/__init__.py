"""The report of a design: one page that opens offline, and beside it every number and curve as data."""

from forcefeel.design.page.folder import FOLDER, write_report

__all__ = ["FOLDER", "write_report"]
