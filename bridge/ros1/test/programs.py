"""Programs of other packages."""

import roslib.packages


def program(package, name):
    """Return the executable of a node."""
    found = roslib.packages.find_node(package, name)
    assert found, f"{package} has no {name}: is it installed?"
    return found[0]
