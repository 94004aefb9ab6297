"""Polygon action and centre distances."""

import math

import numpy as np
import pytest

import chaindrive as cd

PITCH = 25.4e-3


def test_equal_sprockets_at_whole_pitches_transmit_without_error():
    """A parallelogram: span of whole pitches, equal wheels."""
    action = cd.kinematics.polygon_action(19, 19, PITCH, 30 * PITCH)
    np.testing.assert_allclose(action["speed_ratio"], 1.0, atol=1e-12)
    np.testing.assert_allclose(action["transmission_error"], 0.0, atol=1e-12)
    assert action.attrs["mean_ratio"] == 1.0


def test_one_period_returns_to_its_start():
    action = cd.kinematics.polygon_action(17, 38, PITCH, 0.7)
    angle = action["driver_angle"]
    assert float(angle[-1]) == pytest.approx(2 * math.pi / 17)
    assert float(action["driven_angle"][-1]) == pytest.approx(2 * math.pi / 38, rel=1e-9)
    ratio = action["speed_ratio"].to_numpy()
    assert ratio[0] == pytest.approx(ratio[-1], rel=1e-9)
    mean = np.trapezoid(ratio, angle) / float(angle[-1])
    assert mean == pytest.approx(17 / 38, rel=1e-4)
    assert ratio.min() >= action.attrs["least_ratio"] - 1e-12
    assert ratio.max() <= action.attrs["greatest_ratio"] + 1e-12
    for name in action.variables:
        assert action[name].attrs["units"]


def test_rate_is_the_slope_of_the_ratio():
    action = cd.kinematics.polygon_action(
        17, 38, PITCH, 0.7, driver_angle=np.linspace(0.01, 0.02, 1001)
    )
    slope = np.gradient(action["speed_ratio"], action["driver_angle"])
    np.testing.assert_allclose(slope[1:-1], action["speed_ratio_rate"][1:-1], rtol=1e-5)


def test_seating_speed_is_about_pitch_times_speed():
    speed = cd.kinematics.seating_speed(17, 38, PITCH, 0.7, 100.0)
    assert speed == pytest.approx(PITCH * 100.0, rel=0.05)
    assert cd.kinematics.seating_speed(17, 38, PITCH, 0.7, -100.0) == speed


def test_links_and_centre_distance_are_inverse():
    links = cd.kinematics.links_for(19, 57, PITCH, 1.0)
    assert cd.kinematics.centre_distance(19, 57, PITCH, links) == pytest.approx(1.0, rel=1e-12)
    # Equal wheels: X = 2C/p + z.
    assert cd.kinematics.links_for(19, 19, PITCH, 30 * PITCH) == pytest.approx(79.0)


def test_wheels_that_overlap():
    with pytest.raises(cd.ParameterError, match="overlap"):
        cd.kinematics.polygon_action(19, 19, PITCH, 0.1)
    with pytest.raises(cd.ParameterError):
        cd.kinematics.links_for(19, 19, -PITCH, 1.0)
    with pytest.raises(cd.ParameterError, match="too few"):
        cd.kinematics.centre_distance(19, 57, PITCH, 10)


@pytest.mark.parametrize("teeth", [0, -3, 10**12])
def test_numbers_that_no_wheel_has_are_refused(teeth):
    for call in (cd.kinematics.polygon_action, cd.kinematics.links_for):
        with pytest.raises(cd.ParameterError, match=f"teeth2 = {teeth}, must be 3 to"):
            call(19, teeth, 12.7e-3, 0.4)
