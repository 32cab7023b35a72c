#!/usr/bin/env python3
"""The lines of lib and shooting that ran, from the counts that a build with --coverage left.

usage: coverage_report.py SOURCE BUILD
"""

import collections
import json
import os
import subprocess
import sys

GOAL = 0.95
FOLDERS = ("lib/carnot/", "shooting/carnot/")


def counts_of(source, data):
    """{file: {line: times}} of one object file, of files in FOLDERS."""
    call = ["gcov", "--json-format", "--stdout", "--relative-only", "--source-prefix", source, data]
    found = collections.defaultdict(dict)
    answer = subprocess.run(call, capture_output=True, text=True, cwd=os.path.dirname(data), check=True)
    for text in answer.stdout.splitlines():
        for file in json.loads(text)["files"]:
            name = os.path.relpath(os.path.join(source, file["file"]), source)
            if not name.startswith(FOLDERS):
                continue
            lines = found[name]
            for line in file["lines"]:
                number = line["line_number"]
                lines[number] = max(lines.get(number, 0), line["count"])
    return found


def ranges(numbers):
    """'3-5, 9' of ascending numbers."""
    parts = []
    for number in numbers:
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in parts)


def main():
    source, build = sys.argv[1:]
    times = collections.defaultdict(dict)
    for folder, _, files in os.walk(build):
        for file in files:
            # Objects that never ran have notes, and no data: their lines count as not reached.
            if not file.endswith(".gcno"):
                continue
            for name, lines in counts_of(source, os.path.join(folder, file)).items():
                for number, count in lines.items():
                    times[name][number] = max(times[name].get(number, 0), count)
    if not times:
        sys.exit(f"coverage_report.py: no counts under {build}")
    all_lines = reached = 0
    for name in sorted(times):
        lines = times[name]
        left = sorted(number for number, count in lines.items() if count == 0)
        all_lines += len(lines)
        reached += len(lines) - len(left)
        if left:
            print(f"{1 - len(left) / len(lines):7.1%}  {name}: {ranges(left)}")
    print(f"{reached / all_lines:7.2%}  {reached} of {all_lines} lines in {len(times)} files")
    return 0 if reached >= GOAL * all_lines else 1


if __name__ == "__main__":
    sys.exit(main())
