"""A domain that is shared with a group is not to be had here, and that is said."""

from __future__ import annotations

import pytest

import belvedere


def test_a_group_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Joining the private domain of the same name would wait for frames for ever."""
    monkeypatch.setenv("BELVEDERE_GROUP", "robots")
    with pytest.raises(belvedere.BridgeError, match="BELVEDERE_GROUP is 'robots'"):
        belvedere.Node("test", "group-refused")
