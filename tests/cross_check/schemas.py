"""The documents that calipose writes, and the problem files that ship, held against its JSON Schemas by a foreign validator.

    python tests/cross_check/schemas.py

Runs every command that writes a document on problems/servosila-engineer.toml and validates what it says with jsonschema from PyPI (in
$CROSS_CHECK_VENV, or a temporary folder): the schemas themselves against their drafts, each document against its schema, and that a
document without one of its keys, or with a text for a number, is refused. Exits with 1 where they disagree.
"""

import copy
import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from environment import run_with

ROOT = Path(__file__).resolve().parents[2]
PROBLEM = ROOT / "problems/servosila-engineer.toml"
CORNERS = ROOT / "problems/examples/servosila-corners.vnl"
STUDY = "study.toml"
LINES = [
    f"plan {PROBLEM} -o out --trials 2",
    "report out/plan.json",
    "figures out/plan.json --format svg",
    "verify out/plan.json -n 30",
    "certify out/plan.json",
    "explain out/plan.json --most 12 --spares 1",
    "polish out/plan.json --cycles 1",
    f"plan {PROBLEM} -o robust --trials 0 --set robust.mount_rotation_deg=1",
    "explain robust/plan.json --most 9 --spares 0",
    f"next out/plan.json {CORNERS} -k 2",
    f"compare {PROBLEM} -k 9 --seeds 1 --limit 20 --trials 2",
    f"score out/plan.csv --problem {PROBLEM}",
    "diff out out",
    f"calibrate {CORNERS} --problem {PROBLEM} -o camera",
    f"sweep {PROBLEM} --step 20",
    f"reach {PROBLEM} --distance-mm 400",
    f"check {PROBLEM}",
    f"board {PROBLEM} --tile -o drawn",
    "init new.toml",
    f"study check {STUDY}",
    f"study run {STUDY} -o study",
    f"study cell {STUDY} 0 -o study",
    f"study submit {STUDY} --engine slurm -o study --dry-run",
    "check none.toml",
    f"plan {PROBLEM} --set camera.fx_px=0",
]


def calipose(line, folder):
    """Standard output and error of a command in the folder."""
    command = [ROOT / "target/release/calipose", *line.split()]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    return done.stdout, done.stderr


def spoiled(document):
    """The document with each of its own keys left out, then with a text for each of its numbers."""
    for key, value in document.items():
        without = copy.deepcopy(document)
        del without[key]
        yield f"without {key}", without
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            yield f"a text for {key}", document | {key: "x"}


def main():
    subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=ROOT, check=True)
    wrong, kinds = [], set()
    with tempfile.TemporaryDirectory() as folder:
        study = f"problems = ['{PROBLEM}']\nset = ['sweep.step_deg=20']\nchoose.counts = [9, 12]\n"
        (Path(folder) / STUDY).write_text(study)
        for line in LINES:
            out, error = calipose(f"{line} --json", folder)
            documents = [json.loads(out or error)]
            for path in Path(folder).glob("**/*.json"):
                document = json.loads(path.read_text())
                if str(document.get("format", "")).startswith("calipose."):
                    documents.append(document)
            for document in documents:
                kind = document["format"].removeprefix("calipose.")
                schema = json.loads(calipose(f"schema --for {kind}", folder)[0])
                Draft202012Validator.check_schema(schema)
                validator = Draft202012Validator(schema)
                wrong += [f"{line}: {fault.json_path}: {fault.message}" for fault in validator.iter_errors(document)]
                if kind not in kinds:
                    required = set(schema["required"])
                    for what, other in spoiled(document):
                        if (what.split()[-1] in required or what.startswith("a text")) and validator.is_valid(other):
                            wrong.append(f"{kind} {what} is valid")
                kinds.add(kind)
        schema = json.loads(calipose("schema", folder)[0])
        Draft7Validator.check_schema(schema)
        validator = Draft7Validator(schema)
        files = sorted((ROOT / "problems").glob("*.toml"))
        for file in files:
            problem = tomllib.loads(file.read_text())
            wrong += [f"{file.name}: {fault.json_path}: {fault.message}" for fault in validator.iter_errors(problem)]
            if validator.is_valid(problem | {"camra": {}}) or validator.is_valid(problem | {"name": 5}):
                wrong.append(f"{file.name} with a wrong key or type is valid")
    print(f"{len(kinds)} kinds of documents ({', '.join(sorted(kinds))}) and {len(files)} problem files; {len(wrong)} faults")
    print("\n".join(wrong))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    run_with("jsonschema==4.23.0")
    from jsonschema import Draft7Validator, Draft202012Validator

    main()
