"""Random misuse of the main functions: no message has the words of a library."""

import random

import pytest

import chaindrive as cd

# Words of the libraries between Python and the core, which nobody can do anything with.
FOREIGN = (
    "argument '",
    "PyErr",
    "PyO3",
    "panicked",
    "invalid type",
    "missing field",
    "unknown field",
    "unknown variant",
    "expected struct",
    "untagged",
    " at line ",
    "cannot be converted to",
    "cannot be interpreted as",
)

VALUES = [
    None,
    -1,
    0,
    1.5,
    float("nan"),
    float("inf"),
    True,
    "",
    "many",
    "12 parsec",
    "1",
    [],
    [1, "2"],
    {},
    {"kind": "none"},
    object(),
    b"bytes",
]

SETTINGS = [
    "until",
    "every",
    "step",
    "method",
    "record",
    "events",
    "run_in",
    "accuracy",
    "tolerance",
]
PATHS = [
    "chain.links",
    "links",
    "chain.mass",
    "sprockets[9].teeth",
    "title",
    "run.until",
    "",
    "x.y",
]


def simulate(draw):
    settings = {"until": 1e-4, "every": 1e-4, "run_in": 0, "method": "auto", "step": 1e-5}
    settings[draw.choice(SETTINGS)] = draw.choice(VALUES)
    cd.simulate(cd.scenes.spinning_ring(), error=False, **settings)


def replace(draw):
    cd.scenes.spinning_ring().replace({draw.choice(PATHS): draw.choice(VALUES)})


def sweep(draw):
    values = draw.choice(
        [[20, 24], [draw.choice(VALUES), draw.choice(VALUES)], draw.choice(VALUES)]
    )
    cd.sweep(cd.scenes.spinning_ring(), {draw.choice(PATHS): values}, until=1e-4, step=1e-5)


def friction(draw):
    cd.friction(
        draw.choice(["coulomb", "columb", draw.choice(VALUES)]), coefficient=draw.choice(VALUES)
    )


def law(draw):
    cd.law(draw.choice(["linear", "power", draw.choice(VALUES)]), stiffness=draw.choice(VALUES))


def load(draw):
    cd.load(draw.choice([*VALUES, "nowhere.toml", "marine_engin"]))


def texts(draw):
    cd.Drive.from_toml(draw.choice(["", "[chain", "x = 1", draw.choice(VALUES)]))


@pytest.mark.parametrize("misuse", [simulate, replace, sweep, friction, law, load, texts])
def test_no_message_speaks_of_a_library(misuse):
    draw = random.Random(20261127)
    refused, complaints = 0, []
    for _ in range(60):
        try:
            misuse(draw)
        except Exception as error:
            refused += 1
            told = f"{type(error).__name__}: {error}"
            known = isinstance(error, (cd.ChaindriveError, TypeError, ValueError, OSError))
            if not known or not str(error) or any(word in told for word in FOREIGN):
                complaints.append(told)
    assert not complaints, "\n".join(sorted(set(complaints)))
    assert refused > 10
