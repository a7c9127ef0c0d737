"""Everything that is public is documented, with an example; doctest runs them."""

import inspect

import pytest

import kdray
import kdray.dask


def public():
    """Names, and what they are names of: functions, classes, methods and properties."""
    for holder in (kdray, kdray.dask, kdray.generate):
        for name in holder.__all__:
            thing = getattr(holder, name)
            if not inspect.ismodule(thing):
                yield f"{holder.__name__}.{name}", thing
    for name in dir(kdray.Tree):
        if not name.startswith("_"):
            member = getattr(kdray.Tree, name)
            yield f"kdray.Tree.{name}", getattr(member, "fget", member)


@pytest.mark.parametrize(("name", "thing"), list(public()), ids=str)
def test_there_is_an_example(name, thing):
    assert ">>> " in (thing.__doc__ or ""), name
