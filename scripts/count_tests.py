#!/usr/bin/python3
"""count_tests.py RESULTS_FOLDER CTEST_STATUS: prints the plain total of all JUnit files below the folder.

Exits non-zero if a test failed, if none ran, or if ctest itself reported a failure (a program that crashed, timed out
or could not be started). rostest writes a summary beside the file of the program it ran: a test counts once.
"""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def main():
    folder, ctest_status = Path(sys.argv[1]), int(sys.argv[2])
    outcomes = {}
    for path in sorted(folder.rglob("*.xml")):
        package = path.relative_to(folder).parts[0]
        try:
            root = ElementTree.parse(path).getroot()
        except ElementTree.ParseError:
            outcomes[(package, path.name, "unreadable result")] = False
            continue
        for case in root.iter("testcase"):
            key = (package, case.get("classname", "").split(".")[-1], case.get("name"))
            passed = case.find("failure") is None and case.find("error") is None
            outcomes[key] = outcomes.get(key, True) and passed
    failed = sorted(key for key, passed in outcomes.items() if not passed)
    for key in failed:
        print("FAILED: " + " ".join(key))
    failed_count = len(failed)
    if ctest_status != 0 and failed_count == 0:
        print("FAILED: lint or ctest ended with status %d; see the output above" % ctest_status)
        failed_count = 1
    print("%d passed, %d failed" % (len(outcomes) - len(failed), failed_count))
    sys.exit(1 if failed_count > 0 or not outcomes else 0)


main()
