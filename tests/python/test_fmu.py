"""Functional mock-up units, as two importers load them: the C interface is called through fmpy."""

import ctypes
import os
import re
import shutil
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic, sleep

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

import chaindrive as cd
from chaindrive.fmu import LIBRARY

# Particles and rigid links.
PRESETS = ["timing_drive", "bicycle"]


@dataclass
class Unit:
    """An instance of a unit, with names instead of value references."""

    folder: Path
    name: str = "drive"
    messages: list[str] = field(default_factory=list)

    def __post_init__(self):
        description = fmpy.read_model_description(str(self.folder))
        self.reference = {it.name: it.valueReference for it in description.modelVariables}
        self.is_three = description.fmiVersion.startswith("3")
        slave = FMU3Slave if self.is_three else FMU2Slave
        self.slave = slave(
            guid=description.guid if not self.is_three else description.instantiationToken,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=str(self.folder),
            instanceName=self.name,
        )
        self.slave.instantiate()

    def start(self, **values):
        if not self.is_three:
            self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        for name, value in values.items():
            self.set(name, value)
        self.slave.exitInitializationMode()
        return self

    def get(self, *names):
        references = [self.reference[name] for name in names]
        read = self.slave.getFloat64 if self.is_three else self.slave.getReal
        return np.array(read(references))

    def set(self, name, value):
        write = self.slave.setFloat64 if self.is_three else self.slave.setReal
        write([self.reference[name]], [value])

    def choose(self, name, value):
        write = self.slave.setInt64 if self.is_three else self.slave.setInteger
        write([self.reference[name]], [value])

    def step(self, time, step):
        self.slave.doStep(time, step)

    def save(self):
        return self.slave.getFMUState() if self.is_three else self.slave.getFMUstate()

    def restore(self, state):
        if self.is_three:
            self.slave.setFMUState(state)
        else:
            self.slave.setFMUstate(state)

    def free(self):
        self.slave.terminate()
        self.slave.freeInstance()


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Units, made once each: to pack the library takes longer than what is tested."""
    made = {}

    def write(drive, fmi):
        key = (drive.name, fmi)
        if key not in made:
            folder = tmp_path_factory.mktemp("units")
            made[key] = drive.fmu(folder / f"{drive.name}.fmu", fmi=fmi, run=False)
        return made[key]

    return write


@pytest.fixture(scope="module")
def unpacked(written):
    """Folders of units, unpacked once each."""

    def unpack(drive, fmi):
        path = written(drive, fmi)
        folder = path.with_suffix("")
        if not folder.exists():
            fmpy.extract(str(path), str(folder))
        return folder

    return unpack


def turned_shaft(drive):
    """A shaft that a torque can act on."""
    simulation = cd.Simulation(drive)
    for shaft in drive.sprockets:
        try:
            simulation.set_torque(shaft, 0.0)
        except cd.ParameterError:
            continue
        return shaft
    raise AssertionError("every shaft has a motion")


@pytest.mark.parametrize(
    ("preset", "fmi"),
    [
        *((preset, fmi) for preset in [*PRESETS, "marine_two_sprockets"] for fmi in (2, 3)),
        ("marine_engine", 3),
        ("two_stage_timing", 3),
    ],
)
def test_an_importer_finds_nothing_wrong(written, preset, fmi):
    assert validate_fmu(str(written(getattr(cd.scenes, preset)(), fmi))) == []


def test_the_export_says_the_verdict_of_its_run(tmp_path):
    drive = cd.scenes.marine_two_sprockets().replace({"run.run_in": 0})
    path = drive.fmu(tmp_path / "drive.fmu", until="5 ms")
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(str(path))
    said = {it.name: it.start for it in description.modelVariables if "at_export" in it.name}
    run = cd.simulate(drive, until="5 ms")
    assert said["at_export.verdict"] == run.attrs["verdict"]
    assert said["at_export.verdict_note"] == run.attrs["verdict_note"]
    assert said["at_export.horizon_note"] == run.attrs["waveform_note"]
    assert float(said["at_export.until"]) == 0.005
    unit = Unit(Path(fmpy.extract(str(path), str(tmp_path / "unpacked"))))
    texts = unit.slave.getString([unit.reference["at_export.verdict"]])
    assert [text.decode() if isinstance(text, bytes) else text for text in texts] == [
        run.attrs["verdict"]
    ]
    unit.slave.freeInstance()


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("preset", PRESETS)
def test_a_unit_has_the_bits_of_a_simulation(unpacked, preset, fmi):
    drive = getattr(cd.scenes, preset)()
    shaft = turned_shaft(drive)
    unit = Unit(unpacked(drive, fmi)).start()
    simulation = cd.Simulation(drive)
    random = np.random.default_rng(7)
    spans = simulation.view(["span_tension"]).labels["span_tension"]
    channels = ["sprocket_angle", "sprocket_speed", "sprocket_torque", "sprocket_force_x"]
    names = [f"{it}[{sprocket}]" for it in channels for sprocket in drive.sprockets]
    names += [f"span_tension[{span}]" for span in spans]
    names += ["energy_kinetic", "energy_stored", "energy_residual"]
    time = 0.0
    for _ in range(20):
        step = random.uniform(2e-5, 2e-4)
        torque = random.uniform(-1.0, 1.0)
        unit.set(f"set_torque[{shaft}]", torque)
        simulation.set_torque(shaft, torque)
        unit.step(time, step)
        time = time + step
        simulation.advance_to(time)
        ours = [np.ravel(simulation[it]) for it in [*channels, "span_tension"]]
        ours += [np.ravel(simulation[it]) for it in names[-3:]]
        np.testing.assert_array_equal(unit.get(*names), np.concatenate(ours))
    unit.free()


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_unit_goes_back_to_any_of_fifty_times(unpacked, fmi):
    drive = cd.scenes.timing_drive()
    shaft = turned_shaft(drive)
    unit = Unit(unpacked(drive, fmi)).start()
    random = np.random.default_rng(11)
    steps = random.uniform(1e-5, 1e-4, 50)
    torques = random.uniform(-2.0, 2.0, 50)
    names = [f"sprocket_angle[{it}]" for it in drive.sprockets]
    names += ["energy_residual", "coupling_energy", "coupling_energy_error"]

    def go(index, time):
        unit.set(f"set_torque[{shaft}]", torques[index])
        unit.step(time, steps[index])
        return unit.get(*names)

    # The sums that the importer would make.
    times = [0.0]
    states, first = [], []
    for index in range(50):
        states.append(unit.save())
        first.append(go(index, times[-1]))
        times.append(times[-1] + steps[index])
    for index in random.permutation(50):
        unit.restore(states[index])
        np.testing.assert_array_equal(go(index, times[index]), first[index])
    free = unit.slave.freeFMUState if unit.is_three else unit.slave.freeFMUstate
    written = unit.save()
    serialize = unit.slave.serializeFMUState if unit.is_three else unit.slave.serializeFMUstate
    read = unit.slave.deserializeFMUState if unit.is_three else unit.slave.deSerializeFMUstate
    data = serialize(states[25])
    another = read(data)
    unit.restore(another)
    np.testing.assert_array_equal(go(25, times[25]), first[25])
    for state in [*states, written, another]:
        free(state)
    with pytest.raises(fmpy.fmi1.FMICallException):
        unit.restore(states[0])
    unit.free()


def test_a_hundred_instances_live_side_by_side_and_four_threads_move_them(unpacked):
    drive = cd.scenes.marine_two_sprockets()
    folder = unpacked(drive, 3)
    units = [Unit(folder, f"drive {index}").start() for index in range(100)]
    names = ["sprocket_angle[camshaft]", "span_tension[crank-camshaft]", "energy_residual"]
    results = {}

    def move(mine):
        for index in mine:
            unit, time = units[index], 0.0
            for _ in range(5):
                unit.set("set_torque[camshaft]", 1e3 * index)
                unit.step(time, 1e-4)
                time += 1e-4
            results[index] = unit.get(*names)

    threads = [threading.Thread(target=move, args=(range(i, 100, 4),)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for index in (0, 1, 50, 99):
        simulation = cd.Simulation(drive)
        time = 0.0
        if index:
            simulation.set_torque("camshaft", 1e3 * index)
        for _ in range(5):
            time += 1e-4
        simulation.advance_to(time)
        angle = float(simulation["sprocket_angle"].sel(sprocket="camshaft"))
        assert results[index][0] == angle
    for unit in units:
        unit.free()


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_importer_simulates_a_unit(written, fmi):
    drive = cd.scenes.marine_two_sprockets()
    path = written(drive, fmi)
    result = fmpy.simulate_fmu(
        str(path), stop_time=2e-3, output_interval=1e-4, output=["sprocket_speed[camshaft]"]
    )
    simulation = cd.Simulation(drive)
    simulation.advance_to(2e-3)
    last = float(simulation["sprocket_speed"].sel(sprocket="camshaft"))
    assert result["sprocket_speed[camshaft]"][-1] == pytest.approx(last, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_second_importer_steps_a_unit(written, fmi):
    drive = cd.scenes.marine_two_sprockets()
    path = written(drive, fmi)
    description = fmpy.read_model_description(str(path))
    reference = {it.name: str(it.valueReference) for it in description.modelVariables}
    names = ["set_torque[camshaft]", "sprocket_speed[camshaft]"]
    manifest = Path(__file__).parents[1] / "importer" / "Cargo.toml"
    command = ["cargo", "run", "--quiet", "--manifest-path", str(manifest)]
    command += ["--target-dir", str(Path(__file__).parents[2] / "target" / "importer")]
    command += ["--", str(path), *(reference[name] for name in names)]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    simulation = cd.Simulation(drive)
    time, speeds = 0.0, []
    for k in range(10):
        if k:
            simulation.set_torque("camshaft", float(k))
        time += 1e-4
        simulation.advance_to(time)
        speeds.append(float(simulation["sprocket_speed"].sel(sprocket="camshaft")))
    bits = np.array([int(line) for line in told], dtype=np.uint64)
    np.testing.assert_array_equal(bits.view(np.float64), speeds)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_shaft_takes_torque_then_speed_then_angle(unpacked, fmi):
    drive = cd.scenes.marine_two_sprockets()
    unit = Unit(unpacked(drive, fmi)).start()
    time, step = 0.0, 1e-4
    unit.step(time, step)
    unit.choose("input[camshaft]", 3)
    unit.set("set_speed[camshaft]", -15.0)
    unit.step(time + step, step)
    assert unit.get("sprocket_speed[camshaft]")[0] == -15.0
    angle = unit.get("sprocket_angle[camshaft]")[0]
    unit.choose("input[camshaft]", 4)
    for index in range(2, 6):
        angle -= 15.0 * step
        unit.set("set_angle[camshaft]", angle)
        unit.step(index * step, step)
        # A held angle comes where it was told at the end of the step.
        assert unit.get("sprocket_angle[camshaft]")[0] == pytest.approx(angle, abs=1e-13)
    unit.choose("input[camshaft]", 2)
    unit.set("set_torque[camshaft]", 1e5)
    unit.step(6 * step, step)
    faster = unit.get("sprocket_speed[camshaft]")[0]
    assert faster > -15.0
    with pytest.raises(fmpy.fmi1.FMICallException):
        unit.choose("input[camshaft]", 1)
    with pytest.raises(fmpy.fmi1.FMICallException):
        unit.choose("input[camshaft]", 9)
    unit.free()


def test_a_centre_comes_where_it_is_told(unpacked):
    drive = cd.scenes.marine_two_sprockets()
    unit = Unit(unpacked(drive, 3)).start()
    name, step = "set_centre_x[crank]", 1e-4
    for index, place in enumerate([0.0, 0.0, 1e-6, 3e-6, 4e-6, 4e-6]):
        unit.set(name, place)
        unit.step(index * step, step)
        assert unit.get("sprocket_x[crank]")[0] == pytest.approx(place, abs=1e-15)
    unit.free()


def test_the_energy_of_the_delay_is_that_of_the_held_torque(unpacked):
    """Σ (τ_k − τ_{k−1}) ω h, by hand; zero of a torque that stays."""
    drive = cd.scenes.marine_two_sprockets()
    unit = Unit(unpacked(drive, 3)).start()
    step = 1e-4
    torque = [0.0, 1e3, 4e3, 9e3, 9e3, 9e3]
    angle, error, work = [], 0.0, 0.0
    for index, value in enumerate(torque):
        unit.set("set_torque[camshaft]", value)
        angle.append(unit.get("sprocket_angle[camshaft]")[0])
        unit.step(index * step, step)
        if index >= 2:
            # The first step with a torque that differs from its start begins the sum.
            way = angle[index] - angle[index - 1]
            error += (value - torque[index - 1]) * way
            work += torque[index - 1] * way
    # The work is that of this instant: the step that ended here is in it.
    work += torque[-1] * (unit.get("sprocket_angle[camshaft]")[0] - angle[-1])
    found = unit.get("coupling_energy_error", "coupling_energy")
    np.testing.assert_allclose(found, [error, work], rtol=1e-12)
    unit.free()


def test_every_function_of_the_standard_exists():
    library = ctypes.CDLL(str(LIBRARY))
    headers = Path(fmpy.__file__).parent / "c-code"
    functions = set()
    for header in ("fmi2FunctionTypes.h", "fmi3FunctionTypes.h"):
        text = (headers / header).read_text(encoding="utf-8")
        functions |= set(re.findall(r"\b(fmi[23]\w+)TYPE\b", text))
    assert len(functions) > 100
    missing = [name for name in functions if not hasattr(library, name)]
    assert missing == []


def test_the_library_needs_no_python():
    told = subprocess.run(
        [sys.executable, "-c", "import ctypes, sys; ctypes.CDLL(sys.argv[1])", str(LIBRARY)],
        check=True,
    )
    assert told.returncode == 0
    if sys.platform == "linux":
        content = LIBRARY.read_bytes()
        assert b"PyObject" not in content
        assert b"libpython" not in content


def test_wrong_calls_are_refused_with_a_message(unpacked, capfd):
    folder = unpacked(cd.scenes.marine_two_sprockets(), 3)
    unit = Unit(folder)
    refused = fmpy.fmi1.FMICallException
    with pytest.raises(refused):
        unit.step(0.0, 1e-4)
    assert "not yet initialized" in capfd.readouterr()[0]
    unit.start()
    for values in [("set_torque[camshaft]", float("nan")), ("energy_kinetic", 1.0)]:
        with pytest.raises(refused):
            unit.set(*values)
    for time, step in [(1.0, 1e-4), (0.0, 0.0), (0.0, -1e-4), (0.0, float("nan"))]:
        with pytest.raises(refused):
            unit.step(time, step)
    told = capfd.readouterr()[0]
    assert "finite" in told
    assert "only read" in told
    assert "stands at 0 s" in told
    with pytest.raises(refused):
        unit.slave.getFloat64([10_000])
    with pytest.raises(refused):
        unit.slave.getInt32([0])
    assert "no variables of this type" in capfd.readouterr()[0]
    unit.free()


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_step_without_end_is_given_up_when_the_unit_is_terminated(unpacked, fmi, capfd):
    unit = Unit(unpacked(cd.scenes.marine_two_sprockets(), fmi)).start()
    begun, refused = threading.Event(), []

    def step():
        begun.set()
        try:
            unit.step(0.0, 1e4)
        except fmpy.fmi1.FMICallException as error:
            refused.append(error)

    thread = threading.Thread(target=step, daemon=True)
    thread.start()
    begun.wait()
    sleep(0.2)
    asked = monotonic()
    unit.slave.terminate()
    thread.join(10.0)
    assert monotonic() - asked < 5.0
    assert refused
    assert "given up" in capfd.readouterr()[0]
    unit.slave.freeInstance()


@pytest.mark.parametrize("endless", ["/dev/zero", "pipe"])
def test_a_scene_of_a_unit_that_never_ends_is_refused(unpacked, tmp_path, endless, capfd):
    folder = tmp_path / "unit"
    shutil.copytree(unpacked(cd.scenes.marine_two_sprockets(), 3), folder)
    scene = folder / "resources" / "scene.toml"
    scene.unlink()
    if endless == "pipe":
        os.mkfifo(scene)
    else:
        scene.symlink_to(endless)
    asked = monotonic()
    with pytest.raises(Exception, match="instantiate"):
        Unit(folder)
    assert monotonic() - asked < 5.0
    assert "scene.toml: this is no file" in capfd.readouterr()[0]


def test_what_cannot_be_written_is_refused(tmp_path):
    drive = cd.scenes.spinning_ring()
    with pytest.raises(cd.ParameterError, match=r"must end in \.fmu"):
        drive.fmu(tmp_path / "drive.zip")
    path = drive.fmu(tmp_path / "drive.fmu", run=False)
    before = path.read_bytes()
    with pytest.raises(cd.errors.WriteError, match="already a file"):
        drive.fmu(path, run=False)
    with pytest.raises(cd.ParameterError, match="FMI 1"):
        drive.fmu(path, fmi=1, run=False, overwrite=True)
    with pytest.raises(cd.ParameterError, match="library"):
        drive.fmu(path, run=False, overwrite=True, library=tmp_path / "none.so")
    assert path.read_bytes() == before
    # The same drive has the same bytes.
    assert drive.fmu(path, run=False, overwrite=True).read_bytes() == before
    assert [it.name for it in tmp_path.iterdir()] == ["drive.fmu"]


def test_the_command_writes_a_unit(tmp_path):
    command = [sys.executable, "-m", "chaindrive", "fmu", "spinning_ring", "--no-run", "--fmi", "2"]
    subprocess.run([*command, "-o", "ring.fmu"], cwd=tmp_path, check=True)
    assert validate_fmu(str(tmp_path / "ring.fmu")) == []
    again = subprocess.run([*command, "-o", "ring.fmu"], cwd=tmp_path, check=False)
    assert again.returncode == 3
