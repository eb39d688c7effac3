#!/usr/bin/env python3
"""How many of the trials of an unpaired comparison a paired one needs.

    posewise study --from NAME.sqlite --csv NAME.csv, of each robot
    paired.py NAME.csv... > paired.csv

Planned and random poses calibrate the same robots: their ratio is as sure from n robots as from
n / share robots each for the two, where share is the variance of the difference of the logarithms
of their errors over the sum of both variances."""
import csv
import math
import os
import statistics
import sys

print("robot,errors,poses,chosen_by,robots,share")
for path in sys.argv[1:]:
    logarithms = {}
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            case = row["variation"], int(row["poses"]), row["chosen_by"]
            if row["identified"] == "yes":
                logarithm = math.log(float(row["held_out_rms_mm"]))
                logarithms.setdefault(case, {})[row["subset"]] = logarithm
    robot = os.path.splitext(os.path.basename(path))[0]
    for (variation, poses, chosen_by), planned in sorted(logarithms.items()):
        random = logarithms[variation, poses, "random"]
        both = planned.keys() & random.keys()
        if chosen_by == "random" or len(both) < 2:
            continue
        of_both = [[errors[k] for k in both] for errors in (planned, random)]
        unpaired = sum(statistics.variance(errors) for errors in of_both)
        paired = statistics.variance(p - r for p, r in zip(*of_both))
        errors = variation.split("=")[-1]
        print(f"{robot},{errors},{poses},{chosen_by},{len(both)},{paired / unpaired:.4f}")
