#!/bin/sh
# Records ten seconds of everything that the robot senses into run.bag, and plays it back. Stop the simulator before playing:
# the bag brings its own clock.
set -e
rosbag record --all --duration=10 -O "${1:-run.bag}"
rosbag info "${1:-run.bag}"
echo "now: rosbag play --clock ${1:-run.bag}"
