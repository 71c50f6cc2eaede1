#!/bin/sh
# Records all topics of the robot for ten seconds into run.bag. Stop the simulator before you play the bag, because the bag
# has its own clock.
set -e
rosbag record --all --duration=10 -O "${1:-run.bag}"
rosbag info "${1:-run.bag}"
echo "now: rosbag play --clock ${1:-run.bag}"
