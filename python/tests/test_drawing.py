import matplotlib.pyplot as plt
import numpy as np
import pytest

import carnot


@pytest.fixture(autouse=True)
def close():
    yield
    plt.close("all")


def test_a_path_in_the_plane(parking):
    ax = parking.best().plot(color="C2", linewidth=3)
    assert ax.get_xlabel() == "x [length]"
    assert "locally-minimal" in ax.get_title()
    assert ax.get_aspect() == 1
    names = [text.get_text() for text in ax.get_legend().get_texts()]
    assert {"start", "end"} <= set(names)
    [path] = [line for line in ax.lines if line.get_linewidth() == 3]
    assert np.array_equal(path.get_xdata(), parking.best().q[:, 0])
    bodies = len(ax.lines)
    assert len(parking.best().plot(bodies=0).lines) < bodies


def test_draws_into_given_axes(parking):
    _, ax = plt.subplots()
    assert parking.best().plot(ax) is ax


def test_limits_are_shaded():
    car = carnot.scene("vehicle", discs=[(0.3, 0.5, 0.1)])
    ax = car.geodesics([0, 0, 0, 0], [0, 1, 0, 0]).best().plot()
    assert ax.patches


def test_paths_in_space_and_over_time():
    ball = carnot.scene("heisenberg-group").geodesics([0, 0, 0], [1, 0, 0.2]).best()
    assert ball.plot().name == "3d"
    pendulum = carnot.scene("kapitza-pendulum").flow([1], [0], time=3, steps=100)
    ax = pendulum.plot()
    assert ax.get_xlabel() == "t [time]"
    with pytest.raises(ValueError, match="no drawing"):
        pendulum.animate()


def test_animates(parking, tmp_path):
    film = parking.best().animate(frames=3)
    film.save(tmp_path / "film.gif", writer="pillow")
    assert (tmp_path / "film.gif").stat().st_size > 1000


def test_a_field_and_a_curve(unicycle, car, parking):
    plane = np.linspace(-1, 1, 7)
    field = unicycle.distance_field({"x": plane, "y": plane, "theta": [0, 0.5]}, check=0)
    ax = field.plot(at={"theta": 0.4})
    assert "theta = 0.5" in ax.get_title()
    assert ax.get_aspect() == 1
    with pytest.raises(ValueError, match="two of"):
        field.plot(at={"theta": 0, "x": 0})
    with pytest.raises(ValueError, match="two of"):
        field.plot(at={"z": 0})
    curve = car.follow(parking.best(), to=[0, 0.98, 0, 0]).plot()
    assert curve.get_ylabel() == "action"


def test_needs_samples(car):
    bare = car.geodesics([0, 0, 0, 0], [0, 1, 0, 0], samples=0).best()
    with pytest.raises(ValueError, match="samples"):
        bare.plot()
