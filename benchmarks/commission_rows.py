"""Rows of a long benchmark in a CSV file that grows by one at a time, so that a run goes on where another stopped."""

import csv
import io
import sys


class Rows:
    """Rows of a file, or of memory where there is none.

    Args:
        path: The file, if any.
        columns: What each column is: ``int``, ``float`` or ``str``; an empty place stays empty.
        about: What the rows are of; stands in the first line, and a file of anything else is refused.
    """

    def __init__(self, path, columns, about):
        self.path, self.columns, self.head, self.rows = path, columns, f"# {about}", []
        if path is None:
            return
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        whole = _whole(text)  # a killed run may have left half of a row
        if whole:
            if whole[0].strip() != self.head:
                sys.exit(f"{path}: has rows of {whole[0].lstrip('# ').strip()}; expected {about}; take another file")
            self.rows = _rows(whole, columns)
        kept = "".join(whole) or f"{self.head}\n{','.join(columns)}\n"
        if kept != text:
            path.write_text(kept, encoding="utf-8")

    def add(self, row):
        """Takes a row in, whole or not at all as far as a reader sees it."""
        self.rows.append(row)
        if self.path is not None:
            line = io.StringIO()
            csv.writer(line, lineterminator="\n").writerow([row[name] for name in self.columns])
            with self.path.open("a", encoding="utf-8") as file:
                file.write(line.getvalue())

    def done(self):
        """Numbers of the machines that have a row."""
        return {row["machine"] for row in self.rows}

    def all(self):
        """All rows, by the machine's number."""
        return sorted(self.rows, key=lambda row: row["machine"])


def read(path, columns):
    """The rows of a file, as far as they are whole."""
    return _rows(_whole(path.read_text(encoding="utf-8")), columns)


def _whole(text):
    """The lines that end."""
    return text[: text.rfind("\n") + 1].splitlines(keepends=True)


def _rows(lines, columns):
    return [
        {name: kind(row[name]) if row[name] else "" for name, kind in columns.items()}
        for row in csv.DictReader(lines[1:])
    ]
