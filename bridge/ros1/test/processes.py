"""Simulator, bridge node and roscore as child processes of a test, with their output."""

import os
import signal
import socket
import subprocess
import tempfile
import time

SIMULATOR = os.environ.get("BELVEDERE_BIN", "belvedere")
BRIDGE = os.environ["BELVEDERE_ROS_BRIDGE"]  # the installed node


class Process:
    """A child process with its output in a file, which is killed at the end in any case."""

    def __init__(self, *command, **environment):
        self.log = tempfile.TemporaryFile(mode="w+", errors="replace")
        self.child = subprocess.Popen(
            [str(word) for word in command],
            env={**os.environ, **environment},
            stdout=self.log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            # Background jobs of a script ignore SIGINT, and so would their children.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )

    def output(self):
        self.log.seek(0)
        return self.log.read()

    def running(self):
        return self.child.poll() is None

    def says(self, text, timeout=15.0):
        return eventually(lambda: text in self.output(), timeout)

    def stop(self, how=signal.SIGINT, timeout=15.0):
        """Stop it and return the exit code."""
        if self.running():
            self.child.send_signal(how)
        try:
            return self.child.wait(timeout)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
            raise AssertionError(f"{self.child.args[0]} did not end within {timeout} s:\n{self.output()}")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()
        self.log.close()


def simulator(domain, *arguments, **environment):
    """Start a simulator whose robot stands still."""
    return Process(SIMULATOR, "run", "--domain", domain, "--drive", "still", *arguments, **environment)


def bridge(domain, *arguments, **environment):
    """Start the bridge node of a domain, /belvedere unless an argument names it otherwise."""
    return Process(BRIDGE, f"_domain:={domain}", *arguments, **environment)


def roscore(port):
    """Start only the master, as one process that can be killed."""
    return Process("rosmaster", "--core", "-p", port)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


#: Streams that the simulator itself reads.
COMMANDS = {
    "/cmd_vel",
    "/mobile_base/commands/motor_power",
    "/mobile_base/commands/reset_odometry",
    "/simulation/command",
}
#: The stream that the bridge itself always reads.
SETTINGS = "/simulation/sensor_settings"


def subscribers_of_streams(domain):
    """Return the number of subscribers of each stream of a domain except commands and settings, by `belvedere list`."""
    lines = subprocess.run(
        [SIMULATOR, "list", "--domain", domain], check=True, capture_output=True, text=True, timeout=20
    ).stdout.splitlines()
    subscribers = lines[0].split().index("SUBS") - len(lines[0].split())
    counts = {line.split()[0]: int(line.split()[subscribers]) for line in lines[1:]}
    return {topic: count for topic, count in counts.items() if topic not in {*COMMANDS, SETTINGS}}


def eventually(condition, timeout=10.0):
    """Return True if a condition becomes true in time."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return bool(condition())
