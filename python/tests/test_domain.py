"""Access to a domain, its remaining files, and forked children."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from conftest import running

import belvedere

if TYPE_CHECKING:
    from conftest import Simulator


def run(program: str, *arguments: str, within: tuple[str, ...] = ()) -> str:
    """Return what a program prints."""
    command = [*within, sys.executable, "-c", program, *arguments]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def files(prefix: str) -> list[Path]:
    folders = [Path("/dev/shm"), *Path("/tmp").glob("blvd[~-]*")]
    return [path for folder in folders for path in folder.rglob(f"{prefix}[.~@]*")]


def test_the_transport_is_the_package_s_own() -> None:
    assert run("import belvedere, sys; print('iceoryx2' in sys.modules)") == "False\n"


def test_files_are_their_owners_alone(alone: belvedere.Node) -> None:
    """This includes the node counter, which iceoryx2 creates open to all."""
    found = files(f"blvd.{alone.domain}")
    assert any(path.suffix == ".global_mgmt" for path in found)
    assert [path for path in found if path.stat().st_mode & 0o077] == []


#: A mount namespace in which another user or mode applies to the directory of all domains. /tmp is mounted as well: in
#: the machine's own, other processes remove the directory while it is empty, and with it what is mounted there.
SET_UP = """mount -t tmpfs -o mode=1777 tmpfs /tmp &&
mkdir -m 750 /tmp/blvd~0 && mount -t tmpfs -o "$1" tmpfs /tmp/blvd~0 &&
mount -t tmpfs -o mode=1777 tmpfs /dev/shm && shift && exec "$@" """
JOINING = """
import belvedere
try:
    belvedere.Node("victim", domain="refused")
except belvedere.BridgeError as error:
    print(error)
"""


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can make a world of its own with other users")
@pytest.mark.skipif(Path(sys.prefix).is_relative_to("/tmp"), reason="Python is in /tmp, which this test hides")
@pytest.mark.parametrize(
    ("made", "says"),
    [
        ("mode=0777,uid=12345", "belongs to user id 12345"),
        ("mode=0750,uid=12345", "an administrator must remove it"),
        ("mode=0777", "others may write in it"),
    ],
)
def test_a_directory_of_another_user_is_refused(made: str, says: str) -> None:
    private = ("unshare", "--mount", "--propagation=private", "sh", "-c", SET_UP, "sh", made)
    assert says in run(JOINING, within=private)


def test_a_node_may_have_any_name(alone: belvedere.Node) -> None:
    for name in ("", "x" * 1000, "ä" * 1000):
        belvedere.Node(name, domain=alone.domain).close()


def test_a_domain_is_shared_with_a_group(monkeypatch: pytest.MonkeyPatch) -> None:
    group = os.getegid()
    monkeypatch.setenv("BELVEDERE_GROUP", str(group))
    for simulator in running("group"):
        with belvedere.Node("test", simulator.domain) as node, node.subscribe("odom") as odometry:
            assert next(odometry.frames(timeout=30)).array.size == 1
            assert {path.stat().st_gid for path in files(f"blvd.{simulator.domain}@{group}")} == {group}
        # No file is in the user's private domain.
        assert files(f"blvd.{simulator.domain}~{os.geteuid()}") == []


def test_an_unknown_group_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BELVEDERE_GROUP", "no-such-group")
    with pytest.raises(belvedere.BridgeError, match="groupadd"):
        belvedere.Node("test", "group-refused")


FORKING = """
import belvedere, os, sys
node = belvedere.Node("forks", domain=sys.argv[1])
odometry, commands = node.subscribe("odom"), node.velocity_publisher()
assert commands.wait(30)
assert commands.send(0.1)
frame = next(odometry.frames(timeout=30))
array = frame.array
child = os.fork()
if child == 0:
    for use in (odometry.take, odometry.wait, node.streams, lambda: commands.send(0.1), lambda: frame.payload):
        try:
            use()
        except belvedere.BridgeError as error:
            assert "forked" in str(error), error
        else:
            raise SystemExit("a child uses what is its parent's")
    # Not os._exit: all objects are finalised, as in a child of multiprocessing.
    sys.exit(0)
assert os.waitpid(child, 0)[1] == 0
del frame, array
count = sum(1 for frame, _ in zip(odometry.frames(timeout=10), range(50)))
print(count, commands.send(0.1), odometry.publishers, len(node.streams()) > 10)
"""


def test_a_forked_child_leaves_the_files_of_its_parent(shared: Simulator) -> None:
    assert run(FORKING, shared.domain) == "50 True 1 True\n"
