"""Figures in README.md and the book, taken from the results of studies and designs.

    python3 docs/figures.py --calipose target/release/calipose            # write what the studies give
    python3 docs/figures.py --calipose target/release/calipose --check    # fail where something else is written
    python3 docs/figures.py --calipose target/release/calipose --check --quick

A figure stands between two comments, which no reader of the page sees. Every comment outside of code is such a marker:

    Ten poses reach <!-- kmeans map_error_px count=10 method=best -->1.62<!-- end --> px.

The first word names problems/studies/kmeans.toml, the second a column of its results.csv; then follow filters, COLUMN=VALUE. Of several
rows, which may differ in their seed alone, the median is taken. What else can be written after the study's name:

    mean|min|max COLUMN FILTERS           another number for all rows that the filters leave, whatever they differ in; the least and the
                                          greatest are of those that are not failures
    rows FILTERS                          how many rows there are
    at COLUMN min|max OUTCOME FILTERS     the value of COLUMN in the row with the least or greatest outcome
    first COLUMN OUTCOME FILTERS <= OTHER the least value of COLUMN at which the (median) outcome is no greater than that of OTHER, which
                                          says only in which filters it differs:
                                          `first count map_error_px method=random <= count=10 method=best`
    A / B                                 a ratio; B says only in what it differs from A:
                                          `map_error_px count=10 method=random / method=best`

Names with spaces are quoted: problem="Servosila Engineer". A design, problems/designs/NAME.toml, has a path into its design.json in place
of all that: `<!-- servosila-board best.map_error_px -->`, and `A / B` too.

A figure keeps the number of significant digits that it is written with, and a whole number is one; `.2` as the last word asks for two
decimals, and nothing written for three significant digits. Pictures that a page shows from the folder results,
`results/STUDY/FIGURE.svg`, are copied from the study's figures to docs/src.

Results are kept in target/studies. A study is run again if calipose or anything in problems has changed. With `--quick` only studies whose
file says that it "takes" less than 10 s of processor time are run, and the other markers are only read.

Needs Python 3.11 and nothing else. Exit codes: 0; 1 if a figure is not true (with --check); 2 if a marker or a study is at fault.
"""

import argparse
import csv
import functools
import hashlib
import json
import re
import shlex
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "target/studies"
BOOK = ROOT / "docs/src"
QUICK_S = 10
REDUCTIONS = {"median": statistics.median, "mean": statistics.fmean, "min": min, "max": max}
# Columns in which rows of one choice may differ.
NOT_SETTINGS = {"cell", "seed"}
PICTURE = re.compile(r"\]\((?:docs/src/)?(results/(?P<study>[\w-]+)/(?P<name>[\w-]+\.svg))\)")


class Fault(Exception):
    """Something that must be put right before figures can be compared."""


class ToldAlready(Exception):
    """A fault of a study that another marker names too."""


class Marker:
    """A figure, where it stands, and what it is."""

    def __init__(self, path, line, words, start, end, text):
        self.path, self.line, self.start, self.end, self.text = path, line, start, end, text
        self.spec = words
        try:
            words = shlex.split(words)
        except ValueError as error:
            raise Fault(f"{self.place()}: `{self.spec}`: {error}") from None
        if not words:
            raise Fault(f"{self.place()}: a marker that names no study")
        self.decimals = int(words.pop()[1:]) if re.fullmatch(r"\.\d", words[-1]) else None
        self.study, self.words = words[0], words[1:]

    def place(self):
        return f"{self.path.relative_to(ROOT)}:{self.line}"


def without_code(text):
    """The text, with blanks of the same length in place of code, so that places stay what they are.

    >>> without_code("a `<!-- b -->` c")
    'a              c'
    """
    fenced = r"^(?P<fence>```+|~~~+).*?(?:^(?P=fence)\s*?$|\Z)"
    blank = lambda match: re.sub(r"[^\n]", " ", match[0])
    return re.sub(r"`[^`\n]+`", blank, re.sub(fenced, blank, text, flags=re.MULTILINE | re.DOTALL))


def markers(path, text):
    """All markers of a page."""
    found, opened = [], None
    for comment in re.finditer(r"<!--(.*?)-->", without_code(text), re.DOTALL):
        line = text.count("\n", 0, comment.start()) + 1
        words = comment[1].strip()
        if words == "end":
            if opened is None:
                raise Fault(f"{path.relative_to(ROOT)}:{line}: `end` of no marker")
            spec, at, start = opened
            found.append(Marker(path, at, spec, start, comment.start(), text[start : comment.start()]))
            opened = None
        elif opened is not None:
            raise Fault(f"{path.relative_to(ROOT)}:{opened[1]}: the marker `{opened[0]}` is not closed by <!-- end -->")
        else:
            opened = (words, line, comment.end())
    if opened is not None:
        raise Fault(f"{path.relative_to(ROOT)}:{opened[1]}: the marker `{opened[0]}` is not closed by <!-- end -->")
    return found


@functools.cache
def number(text):
    """A number as it is written in a table or on a page; None if it is none.

    >>> number("4 581"), number("1.62"), number("whole")
    (4581.0, 1.62, None)
    """
    try:
        return float(re.sub(r"(?<=\d)[ \u00a0\u202f](?=\d{3})", "", text))
    except ValueError:
        return None


def written(value, text, decimals):
    """The value with as many significant digits as the text in whose place it stands, or with the decimals asked for.

    >>> written(1.6199, "1.62", None), written(10.64, "9.35", None), written(4581, "4 000", None), written(109.6, "110", None)
    ('1.62', '10.6', '4 581', '110')
    >>> written(0.98159, "", None), written(0.9996, "0.982", None), written(0.9996, "1.00", None), written(3.04, "", 1)
    ('0.982', '1.00', '1.00', '3.0')
    """
    if decimals is None:
        if "." not in text and (number(text) is not None or value == int(value)):
            decimals = 0
        else:
            digits = len(re.sub(r"\D", "", text).lstrip("0")) or 3
            exponent = int(f"{value:.{digits - 1}e}".partition("e")[2])
            decimals = max(0, digits - 1 - exponent)
    return f"{value:,.{decimals}f}".replace(",", " ")


class Study:
    """The rows of a study."""

    def __init__(self, path):
        with path.open(newline="") as file:
            self.rows = list(csv.DictReader(file))
        columns = list(self.rows[0])
        self.columns = columns
        self.settings = [column for column in columns[: columns.index("reason")] if column not in NOT_SETTINGS]

    def value(self, words):
        words, other = split(words, "/")
        value = self.term(words)
        return value if other is None else value / self.term(differing(words, other))

    def term(self, words):
        if not words:
            raise Fault("no column is named")
        head, rest = words[0], words[1:]
        if head == "rows":
            return len(self.matching(filters(rest)))
        if head == "at":
            if len(rest) < 3 or rest[1] not in ("min", "max"):
                raise Fault("`at` is followed by a column, `min` or `max`, and an outcome")
            rows = self.made(self.matching(filters(rest[3:])))
            values = self.outcomes(rows, rest[2])
            found = rows[values.index(REDUCTIONS[rest[1]](values))]
            return self.outcomes([found], rest[0])[0]
        if head == "first":
            return self.first(rest)
        if head in REDUCTIONS and rest:
            rows = self.matching(filters(rest[1:]))
            return REDUCTIONS[head](self.outcomes(rows if head == "mean" else self.made(rows), rest[0]))
        return self.median(head, filters(rest))

    def first(self, words):
        words, other = split(words, "<=")
        if other is None or len(words) < 2:
            raise Fault("`first` is followed by a column, an outcome, filters, `<=` and other filters")
        column, outcome, *rest = words
        limit = self.median(outcome, filters(rest) | filters(other))
        values = sorted(set(self.outcomes(self.matching(filters(rest)), column)))
        for value in values:
            if self.median(outcome, filters(rest) | {column: repr(value)}) <= limit:
                return value
        raise Fault(f"at no {column} up to {values[-1]:g} is {outcome} as small as {limit:.4g}")

    def median(self, outcome, wanted):
        rows = self.matching(wanted)
        for column in self.settings:
            different = list(dict.fromkeys(row[column] for row in rows))
            if len(different) > 1:
                shown = ", ".join(f"`{column}={value}`" for value in different[:4])
                raise Fault(f"{len(rows)} rows match, and differ in more than their seed: add one of {shown} …")
        return statistics.median(self.outcomes(rows, outcome))

    def matching(self, wanted):
        for column in wanted:
            self.known(column)
        is_equal = lambda a, b: a == b if number(a) is None or number(b) is None else number(a) == number(b)
        rows = [row for row in self.rows if all(is_equal(row[column], value) for column, value in wanted.items())]
        if not rows:
            raise Fault("no row matches " + " ".join(f"{column}={value}" for column, value in wanted.items()))
        return rows

    @staticmethod
    def made(rows):
        """The rows with a choice, if there are any."""
        return [row for row in rows if not row["reason"]] or rows

    def outcomes(self, rows, column):
        self.known(column)
        values = [number(row[column]) for row in rows]
        if None in values:
            reason = next((row["reason"] for row in rows if row["reason"]), f"`{rows[values.index(None)][column]}`")
            raise Fault(f"{values.count(None)} of {len(rows)} rows have no number in `{column}`: {reason}")
        return values

    def known(self, column):
        if column not in self.columns:
            raise Fault(f"there is no column `{column}`; there are {', '.join(self.columns)}")


class Design:
    """What was found about set-ups."""

    def __init__(self, path):
        self.document = json.loads(path.read_text())

    def value(self, words):
        words, other = split(words, "/")
        value = self.term(words)
        return value if other is None else value / self.term(other)

    def term(self, words):
        if len(words) != 1:
            raise Fault("a design has one path into its design.json, as in `best.map_error_px`")
        value = self.document
        for key in re.findall(r"[^.\[\]]+", words[0]):
            try:
                value = value[int(key)] if isinstance(value, list) else value[key]
            except (KeyError, IndexError, ValueError, TypeError):
                keys = ", ".join(value) if isinstance(value, dict) else f"{len(value)} entries"
                raise Fault(f"there is no `{key}` of `{words[0]}` in design.json; there are {keys}") from None
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise Fault(f"`{words[0]}` of design.json is no number")
        return value


def split(words, sign):
    """The words before and after a sign; None if it is not among them."""
    if sign not in words:
        return words, None
    at = words.index(sign)
    return words[:at], words[at + 1 :]


def filters(words):
    """COLUMN=VALUE words as a dictionary."""
    for word in words:
        if "=" not in word:
            raise Fault(f"`{word}` is not COLUMN=VALUE")
    return dict(word.split("=", 1) for word in words)


def differing(words, other):
    """The words of a term that says only in what it differs from another.

    >>> differing(["max", "value", "count=1"], ["min"])
    ['min', 'value', 'count=1']
    >>> differing(["value", "count=1", "method=best"], ["count=2"])
    ['value', 'count=2', 'method=best']
    """
    filtered = [word for word in words if "=" in word]
    heads, own = ([word for word in some if "=" not in word] for some in (words, other))
    if own and all(word in REDUCTIONS for word in own):
        heads = [*own, *[word for word in heads if word not in REDUCTIONS]]
    elif own:
        heads = own
    merged = filters(filtered) | filters([word for word in other if "=" in word])
    return heads + [f"{column}={value}" for column, value in merged.items()]


class Runs:
    """Studies and designs, run when they are asked for."""

    def __init__(self, calipose):
        self.calipose = calipose
        self.known = {}
        self.failed = set()
        digest = hashlib.sha256(calipose.read_bytes())
        for path in sorted((ROOT / "problems").rglob("*")):
            if path.is_file() and path.parent.name not in ("studies", "designs"):
                digest.update(f"{path.relative_to(ROOT)}\n".encode() + path.read_bytes())
        self.digest = digest

    @staticmethod
    def file(name):
        """The file of that name."""
        paths = [ROOT / "problems" / kind / f"{name}.toml" for kind in ("studies", "designs")]
        found = [path for path in paths if path.is_file()]
        if len(found) != 1:
            names = sorted(other.stem for path in paths for other in path.parent.glob("*.toml"))
            raise Fault(f"there is {'a study and a' if found else 'no study or'} design `{name}`; there are {', '.join(names)}")
        return found[0]

    def is_quick(self, name):
        told = re.search(r"^# Takes (\d+) s", self.file(name).read_text(), re.MULTILINE)
        return told is not None and int(told[1]) < QUICK_S

    def folder(self, name):
        """The folder with the results of today's files and calipose."""
        if name in self.failed:
            raise ToldAlready
        path, folder = self.file(name), RESULTS / name
        digest = self.digest.copy()
        digest.update(path.read_bytes())
        stamp = RESULTS / f"{name}.sha256"
        if name in self.known or (stamp.is_file() and stamp.read_text() == digest.hexdigest()):
            return folder
        stamp.unlink(missing_ok=True)
        # Cells are known by the version of calipose, which need not change with its code.
        for cell in folder.glob("cells/**/*"):
            if cell.is_file():
                cell.unlink()
        what = ["study", "run"] if path.parent.name == "studies" else ["design"]
        began = time.monotonic()
        command = [self.calipose, *what, path, "--output", folder, "--force", "--quiet"]
        done = subprocess.run(command, cwd=ROOT, stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if done.returncode != 0:
            self.failed.add(name)
            raise Fault(f"`calipose {' '.join(what)} {path.relative_to(ROOT)}` failed:\n{done.stderr.strip()}")
        print(f"{name}: {time.monotonic() - began:.0f} s", file=sys.stderr)
        stamp.write_text(digest.hexdigest())
        return folder

    def results(self, name):
        if name not in self.known:
            folder = self.folder(name)
            is_study = self.file(name).parent.name == "studies"
            self.known[name] = Study(folder / "results.csv") if is_study else Design(folder / "design.json")
        return self.known[name]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--calipose", type=Path, default=ROOT / "target/release/calipose", help="the program")
    parser.add_argument("--check", action="store_true", help="change nothing; fail if a figure is not true")
    parser.add_argument("--quick", action="store_true", help=f"only studies that take less than {QUICK_S} s")
    options = parser.parse_args()
    calipose = options.calipose.resolve()
    if not calipose.is_file():
        print(f"there is no {options.calipose}: `cargo build --release` makes it", file=sys.stderr)
        return 2
    RESULTS.mkdir(parents=True, exist_ok=True)
    runs = Runs(calipose)
    faults, untrue, compared, skipped = [], [], 0, set()

    def is_wanted(name):
        if options.quick and not runs.is_quick(name):
            skipped.add(name)
            return False
        return True

    for path in [ROOT / "README.md", *sorted(BOOK.glob("*.md"))]:
        text = path.read_text()
        changed = text
        try:
            found = markers(path, text)
        except Fault as fault:
            faults.append(str(fault))
            continue
        # From the last on, so that places before stay what they are.
        for marker in reversed(found):
            try:
                if not is_wanted(marker.study):
                    continue
                value = runs.results(marker.study).value(marker.words)
            except ToldAlready:
                continue
            except (Fault, ZeroDivisionError) as fault:
                faults.append(f"{marker.place()}: `{marker.spec}`: {fault}")
                continue
            compared += 1
            given = written(value, marker.text, marker.decimals)
            if given != marker.text:
                untrue.append(f"{marker.place()}: {marker.text or 'nothing'} is written, {given} is given by `{marker.spec}`")
                changed = changed[: marker.start] + given + changed[marker.end :]
        for picture in {match[1]: match for match in PICTURE.finditer(without_code(text))}.values():
            shown = BOOK / picture[1]
            line = text.count("\n", 0, picture.start()) + 1
            place = f"{path.relative_to(ROOT)}:{line}"
            try:
                if not is_wanted(picture["study"]):
                    continue
                drawn = runs.folder(picture["study"]) / "figures" / picture["name"]
                if not drawn.is_file():
                    names = ", ".join(sorted(other.name for other in drawn.parent.glob("*.svg")))
                    raise Fault(f"the study draws no {picture['name']}; it draws {names}")
            except ToldAlready:
                continue
            except Fault as fault:
                faults.append(f"{place}: {picture[1]}: {fault}")
                continue
            compared += 1
            if not shown.is_file() or shown.read_bytes() != drawn.read_bytes():
                untrue.append(f"{place}: {picture[1]} is not what the study draws")
                if not options.check:
                    shown.parent.mkdir(parents=True, exist_ok=True)
                    shown.write_bytes(drawn.read_bytes())
        if changed != text and not options.check:
            path.write_text(changed)

    place = lambda line: (line.split(":")[0], int(line.split(":")[1]))
    for line in sorted(faults, key=place) + sorted(untrue, key=place):
        print(line)
    left = f"; not run: {', '.join(sorted(skipped))}" if skipped else ""
    verb = "not true" if options.check else "replaced"
    print(f"{compared} figures compared, {len(untrue)} {verb}, {len(faults)} at fault{left}", file=sys.stderr)
    return 2 if faults else int(options.check and bool(untrue))


if __name__ == "__main__":
    sys.exit(main())
