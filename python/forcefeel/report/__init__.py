"""The report of a design: one page that opens offline, and beside it every number and curve as data."""

from forcefeel.report.folder import check_folder, write_report

__all__ = ["check_folder", "write_report"]
