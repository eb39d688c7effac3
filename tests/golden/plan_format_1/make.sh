#!/bin/sh
# Plans of format 1 and what verify said of them, as the last posewise that wrote that format
# (before format 2) made them here. Kept to test that they are still read; not to be made again.
set -e
cd "$(dirname "$0")"
designs=../../../designs
posewise select --blocks blocks.csv --rows 2 -k 3 -o blocks.plan.json
posewise select $designs/fanuc_r2000ic_165f/seed_report.yaml --random 60 -k 8 --prior --starts 2 \
    -o choice.plan.json
posewise plan $designs/cell_demo/campaign.yaml -k 8 --prior --pool 500 --starts 1 \
    --workspace-poses 20 -o continuous.poses.json
for plan in blocks.plan.json choice.plan.json continuous.poses.json; do
    posewise verify $plan | tail -n +2 > $plan.verified
done
