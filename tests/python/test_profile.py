"""Whole profiles: shapes, signs, and distances against closed forms and a fine polyline."""

import numpy as np
import pytest

import chaindrive as cd


@pytest.fixture(scope="module")
def drive():
    return cd.scenes.timing_drive()


@pytest.fixture(scope="module")
def crank(drive):
    return drive.profile("crank")


@pytest.fixture(scope="module")
def shoe(drive):
    return drive.profile("shoe")


def far(points, line):
    """Return the unsigned distances of points from a polyline, by asking every chord."""
    start, along = line[:-1], np.diff(line, axis=0)
    away = points[:, None, :] - start
    share = np.clip((away * along).sum(-1) / (along * along).sum(-1), 0.0, 1.0)
    return np.linalg.norm(away - share[..., None] * along, axis=-1).min(axis=1)


def test_distances_agree_with_a_fine_polyline(crank, shoe):
    """Chords stand off by 1e-8 m at most, and the signs are those of material and void."""
    dice = np.random.default_rng(3)
    for profile in (crank, shoe):
        line = profile.outline(1e-8)
        low, high = line.min(axis=0) - 0.02, line.max(axis=0) + 0.02
        points = low + (high - low) * dice.random((400, 2))
        distance = profile.distance(points)
        np.testing.assert_allclose(np.abs(distance), far(points, line), atol=1.1e-8)
        assert (distance < 0.0).any()
        assert (distance > 0.0).any()
    inside = crank.distance(points) < 0.0
    np.testing.assert_array_equal(crank.contains(points), inside)


def test_an_arc_has_a_closed_form(drive):
    """Closed form: |p - c| - r in front of an arc and behind it, the end point beyond its ends."""
    centre, radius = np.array([2.1867088471534073, -0.43055664370824526]), 2.2
    face = {"kind": "arc", "centre": list(centre), "radius": radius}
    face = {**face, "from": "163 deg", "to": "167 deg"}
    fixed = drive.replace({"guides.fixed.face": face}).profile("fixed")
    for angle in np.radians([163.5, 165.0, 166.9]):
        normal = np.array([np.cos(angle), np.sin(angle)])
        for offset in (0.02, 0.0, -0.05):
            point = centre + (radius + offset) * normal
            assert abs(fixed.distance(point) - offset) < 1e-12
            nearest = fixed.closest(point)
            np.testing.assert_allclose(nearest.points, centre + radius * normal, atol=1e-12)
            np.testing.assert_allclose(nearest.normals, normal, atol=1e-12)
            arc = radius * (angle - np.radians(163.0))
            assert abs(nearest.parameter - arc) < 1e-9
    end = centre + radius * np.array([np.cos(np.radians(167.0)), np.sin(np.radians(167.0))])
    beyond = end + 0.3 * np.array([-np.sin(np.radians(167.0)), np.cos(np.radians(167.0))])
    assert abs(fixed.distance(beyond) - 0.3) < 1e-12


def test_a_point_is_its_nearest_place_plus_distance_times_normal(crank, shoe):
    dice = np.random.default_rng(5)
    points = 0.1 * (dice.random((7, 5, 2)) - 0.5)
    for profile in (crank, shoe):
        nearest = profile.closest(points)
        assert nearest.points.shape == nearest.normals.shape == (7, 5, 2)
        assert np.shape(nearest.parameter) == (7, 5)
        again = nearest.points + profile.distance(points)[..., None] * nearest.normals
        np.testing.assert_allclose(again, points, atol=1e-14)
        assert np.all((nearest.parameter >= 0.0) & (nearest.parameter <= profile.length))


def test_shapes_follow_the_points(crank):
    assert crank.distance([[[0.0, 0.0]]]).shape == (1, 1)
    assert np.ndim(crank.distance([0.0, 0.0])) == 0
    assert crank.distance(np.empty((0, 2))).shape == (0,)
    assert bool(crank.contains([0.0, 0.0])) is True
    for bad in (1.0, [1.0, 2.0, 3.0], [[1.0], [2.0]]):
        with pytest.raises(cd.ParameterError, match="points have the shape") as caught:
            crank.distance(bad)
        assert caught.value.hint == "must be (..., 2): x and y [m]"
    nowhere = crank.closest([[np.nan, 0.0], [np.inf, 0.0], [0.1, 0.1]])
    assert np.isnan(nowhere.parameter).tolist() == [True, True, False]
    assert np.isnan(crank.distance([[np.nan, 0.0]])).all()


def test_rollers_sit_in_the_gaps_of_the_outline(drive, crank):
    """The profile stands where the settled chain meets it: seated rollers touch it."""
    settings = {"until": 1e-6, "every": 1e-6, "run_in": 0, "error": False}
    run = cd.simulate(drive, record=["roller_x", "roller_y"], **settings)
    start = run.isel(time=0)
    rollers = np.stack([start["roller_x"], start["roller_y"]], axis=-1)
    gaps = crank.distance(rollers) - 0.5 * 5e-3
    assert np.sort(gaps)[:5].max() < 1e-5
    assert gaps.min() > -1e-4


def test_names_and_open_faces_are_told(drive, crank, shoe):
    assert crank.closed
    assert not shoe.closed
    assert repr(shoe).startswith("<chaindrive.Profile of 'shoe': open, 0.18")
    with pytest.raises(cd.ParameterError, match="is open and encloses nothing"):
        shoe.contains([0.0, 0.0])
    with pytest.raises(cd.ParameterError, match="named `crunk`; there are `crank`, `exhaust`"):
        drive.profile("crunk", settled=False)
    with pytest.raises(cd.ParameterError, match="billionth"):
        crank.outline(0.0)
    with pytest.raises(TypeError, match=r"Drive\.profile"):
        cd.Profile()


def test_a_guide_in_the_teeth_is_refused():
    scene = cd.scenes.marine_engine().to_dict()
    ends = {"start": ["0.60 m", "0.0 m"], "end": ["1.62 m", "1.41 m"]}
    scene["guides"][0]["face"] = {"kind": "bar", **ends, "end_radius": "1 m", "end_angle": "8 deg"}
    message = "guide `crank-to-camshaft` cuts into the teeth of `crank` by"
    with pytest.raises(cd.AssemblyError, match=message):
        cd.Drive.from_dict(scene).statics()
