"""The words that editors complete are those that the core takes."""

import base64
import inspect
import re
from typing import Any, get_args

import pytest

import chaindrive as cd
from chaindrive import _core, contact_law, data_sheet, settings


def alternatives(name: str) -> list[Any]:
    return cd.schema()["$defs"][name]["oneOf"]


def words(name: str) -> list[str]:
    return [one["const"] for one in alternatives(name)]


def kinds(name: str) -> list[str]:
    properties = [one.get("properties", {}) for one in alternatives(name)]
    return [it["kind"]["const"] for it in properties if "kind" in it]


def test_methods_and_channels_are_those_of_the_core() -> None:
    assert list(get_args(settings.MethodName)) == _core.methods() == words("Method")
    assert list(get_args(settings.ChannelName)) == [name for name, *_ in _core.channels()]


@pytest.mark.parametrize(
    ("told", "definition"),
    [
        (settings.ChainModel, "ChainModel"),
        (settings.ContactPlace, "Events"),
        (settings.Target, "Quantity"),
    ],
)
def test_words_are_those_of_scenes(told: object, definition: str) -> None:
    assert list(get_args(told)) == words(definition)


def test_laws_are_those_of_scenes_and_are_taken() -> None:
    # A linear law is a power law of exponent one; a spring-slider needs a chain to wind up.
    assert set(get_args(settings.LawKind)) == set(kinds("Elastic"))
    assert set(get_args(settings.FrictionKind)) == set(kinds("Friction"))
    # A viscous damping is given by its coefficient, in scenes too.
    assert set(get_args(settings.DissipationKind)) == {*words("Dissipation"), "viscous"}
    assert set(get_args(settings.LawKind)) == set(contact_law._LAWS)
    assert set(get_args(settings.DissipationKind)) == set(contact_law._DISSIPATIONS)
    geometry = {"hole": 1.85e-3, "pin": 1.8e-3, "length": 4.5e-3, "modulus": 113.7e9}
    for kind in set(get_args(settings.LawKind)) - {"linear", "power"}:
        assert cd.law(kind, **geometry).force(1e-6) > 0.0
    for kind in set(get_args(settings.DissipationKind)) - {"none", "viscous"}:
        cd.law("power", stiffness=1e9, exponent=1.5, dissipation=kind, restitution=0.8)
    cd.law("power", stiffness=1e9, exponent=1.5, dissipation="viscous", damping=10.0)


def test_every_setting_of_a_run_can_be_kept_in_a_dict() -> None:
    taken = inspect.signature(cd.simulate).parameters
    others = {"drive", "output", "overwrite", "checkpoint_every", "error", "progress"}
    assert set(settings.RunSettings.__annotations__) == set(taken) - others
    assert set(settings.RunSettings.__annotations__) == set(
        cd.schema()["$defs"]["Run"]["properties"]
    )


def test_the_drawing_in_a_sheet_is_that_of_the_drive() -> None:
    drive = cd.scenes.two_stage_timing()
    (data,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]*)"', drive._repr_html_())
    assert base64.b64decode(data).decode() == drive._repr_svg_()


@pytest.mark.parametrize("name", cd.scenes.presets())
def test_a_drive_shows_what_it_is_made_of(name: str) -> None:
    drive = getattr(cd.scenes, name)()
    for shown in (repr(drive), drive._repr_html_()):
        for part in [*drive.sprockets, *drive.guides, *drive.tensioners, *drive.shafts]:
            assert part in shown
        assert drive.title in shown
        for links in drive.chains.values() or [drive.links]:
            assert f"{links} link" in shown
    assert max(len(line) for line in repr(drive).splitlines()) <= 100


def test_a_sheet_counts_what_it_does_not_name() -> None:
    chain = {"links": 78, "pitch": 0.0254, "model": "particles"}
    sprockets = [{"name": f"<b>{index}", "teeth": 19} for index in range(20)]
    row = data_sheet.rows({"chain": chain, "sprockets": sprockets})[1]
    assert row.parts[-1] == "and 8 more"
    shown = data_sheet.html("name", "", [row], None)
    assert "<b>" not in shown
    assert "&lt;b&gt;3 (19 teeth)" in shown
