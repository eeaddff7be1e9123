"""Bias prediction for MEMS gyroscopes: the tools of the command line `zerorate`, for NumPy arrays.

    >>> import zerorate
    >>> rest = zerorate.read("rest.csv.gz")
    >>> noise = zerorate.characterize(rest)
    >>> noise.axes["x"].angle_random_walk_dps_per_sqrt_hz
    >>> noise.plot()
    >>> noise.middle.save("mine.toml")

Rates are in rad/s and times in whole nanoseconds unless a name says otherwise. Every figure is the one that the command
line prints: both call the same libraries.
"""

import dataclasses
import json
import os
from typing import Callable, Optional, Union

import numpy as np

from . import _native
from ._native import ModelError, RecordingError
from .evaluation import DriveErrors, Evaluation, PredictorScore, StopErrors
from .results import (AllanDeviation, AllanFloor, AxisDiagnosis, AxisNoise, Cause, Characterization, Corrected, Diagnosis, Figure,
                      Model, NoiseCoefficients, Recording)

__all__ = [
    "AllanDeviation", "AllanFloor", "AxisDiagnosis", "AxisNoise", "Cause", "Characterization", "Corrected", "Diagnosis",
    "DriveErrors", "Evaluation", "Figure", "Model", "ModelError", "Node", "NoiseCoefficients", "PredictorScore", "Recording",
    "RecordingError", "StopErrors", "allan_deviation", "catalogue", "characterize", "diagnose", "evaluate", "model", "read"
]
__version__: str = _native.__version__

PathOrRecording = Union[str, "os.PathLike[str]", Recording]
ModelOrName = Union[str, "os.PathLike[str]", Model]


def read(path: Union[str, "os.PathLike[str]"], *, columns: str = "", units: str = "", delimiter: str = "") -> Recording:
    """Reads a recording: CSV or CSV.gz, a folder of EuRoC, a bag of ROS.

    `columns`, `units` and `delimiter` are those of the command line, for files of other formats:
    `columns="t=stamp,gx=wx,gy=wy,gz=wz", units="time=ns,rate=radps"`. Raises RecordingError.
    """
    arrays = _native.Source(os.fsencode(path), columns, units, delimiter).read()
    return Recording(name=_words(os.path.basename(os.fspath(path))), **arrays)


def catalogue() -> list[str]:
    """Names of the sensor models that come with zerorate."""
    return _native.model_names()


def model(name: ModelOrName) -> Model:
    """A model of the catalogue or of a file. Raises ModelError, ValueError, OSError."""
    return Model(_words(os.fspath(name)), _native.model_text(_text_of(name)))


def allan_deviation(rate: np.ndarray, sample_period_s: float, *, points_per_decade: float = 16.0) -> AllanDeviation:
    """Overlapping Allan deviation of the evenly spaced rates of one axis, with 95 % intervals, in the unit of the rate."""
    return AllanDeviation(*_native.allan_deviation(np.asarray(rate, np.float64), sample_period_s, points_per_decade))


def characterize(recording: PathOrRecording, *, axis: str = "all", order: Optional[float] = None,
                 still_from: str = "odometer", accept: str = "") -> Characterization:
    """White and flicker noise of a sensor at rest, as `zerorate characterize`.

    `order` is d where it is known, else it is estimated. Raises RecordingError for a sensor that was not at rest; `accept`
    names the doubts that are wrong, as the error does ("counts,motion").
    """
    source, name = _source_of(recording)
    text, models, doubts = _native.characterize(source, name, axis, order, still_from, accept)
    return Characterization.of_json(json.loads(text), models, doubts)


def diagnose(recording: PathOrRecording, *, axis: str = "all", model: Optional[ModelOrName] = None, holdout: float = 0.3,
             still_from: str = "odometer", accept: str = "") -> Diagnosis:
    """What white and flicker noise do not explain, and why, as `zerorate diagnose`.

    An odometer is not examined against a reference speed; the command line does that.
    """
    source, name = _source_of(recording)
    text = None if model is None else _text_of(model)
    (text, models, doubts), curves = _native.diagnose(source, name, axis, text, holdout, still_from, accept)
    return Diagnosis.of_json(json.loads(text), models, doubts, curves)


def evaluate(recording: PathOrRecording, *, model: ModelOrName, schedule: Optional[str] = None, axis: str = "all",
             learns_noise: bool = True, still_from: str = "odometer", filter_rate_hz: Optional[float] = None,
             vertical_axis: str = "", reference_error_deg: Optional[float] = None, reference_from_s: float = 0.0,
             still: Optional[np.ndarray] = None,
             predictor: Optional[Callable[[Recording], np.ndarray]] = None) -> Evaluation:
    """Heading drifts and coverage of a recording through the node, as `zerorate replay`.

    `schedule="still=60,drive=300,seed=1"` makes up stops and drives for a recording at rest. Of a real drive the true rate
    is not known: its drifts are None, its stops are scored. Columns of a reference (`ref_heading_rad`, `ref_speed_m_s`)
    score the drives between true stops: `true_drives`, with `vertical_axis` and the two options about the reference.

    `still`, true for each row at rest, takes the place of the recording's own column or pulses. `predictor` is a predictor
    of yours: after each stop it is called with the rows at rest (a Recording), in the order of time, and returns the bias of
    each axis [rad/s] that holds until the next stop. It is scored as `own` beside the node's predictors. The rows
    are those which the node calls still, up to the departure: `Evaluation.still`. In the newest half second, which the node
    does not learn from, the vehicle may move already.
    """
    if still is not None or predictor is not None:
        recording = recording if isinstance(recording, Recording) else read(recording)
    if still is not None:
        if schedule is not None:
            raise ValueError("still: a schedule makes up its own stops")
        recording = dataclasses.replace(recording, still=_mask(still, len(recording.time_ns)), odometer_pulses=None)
    source, _ = _source_of(recording)
    options = _options(model, learns_noise, still_from, filter_rate_hz)
    text, details = _native.evaluate(source, axis, schedule, options, vertical_axis, reference_error_deg, reference_from_s)
    arrays = {name: np.asarray(values) for name, values in details.items()}
    biases = None if predictor is None else _biases_of(predictor, recording, arrays["still"] > 0.5)
    return Evaluation.of_details(json.loads(text), arrays, biases)


def _mask(still: np.ndarray, rows: int) -> np.ndarray:
    mask = np.asarray(still)
    if mask.shape != (rows,) or mask.dtype.kind != "b":
        raise ValueError(f"still: expected {rows} truth values, one a row, found {mask.dtype} of shape {mask.shape}")
    return mask


def _biases_of(predictor: Callable[[Recording], np.ndarray], recording: Recording, still: np.ndarray) -> np.ndarray:
    """What a predictor answers after each stop, a row each."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    axes = recording.rate_rad_s.shape[1]
    biases = np.full((len(edges) // 2, axes), np.nan)
    for number, (begin, end) in enumerate(edges.reshape(-1, 2)):
        answer = np.asarray(predictor(recording.rows(slice(begin, end))), float)
        if answer.shape not in ((axes,), (1, axes)) and not (axes == 1 and answer.shape == ()):
            raise ValueError(f"predictor: expected {axes} biases after stop {number + 1}, found shape {answer.shape}")
        biases[number] = answer
    return biases


class Node:
    """The node of the firmware: samples in, corrected rate with its interval out, bit for bit as on the target.

    A node learns from its stops (`learns_noise`). It keeps its state from one call to the next.
    """

    def __init__(self, model: ModelOrName, *, sample_period_s: Optional[float] = None, learns_noise: bool = True,
                 still_from: str = "odometer", filter_rate_hz: Optional[float] = None, settle_s: float = 1.0,
                 hold_back_s: float = 0.5) -> None:
        options = _options(model, learns_noise, still_from, filter_rate_hz)
        options.settle_s = settle_s
        options.hold_back_s = hold_back_s
        self._node = _native.Node(options, sample_period_s)

    def replay(self, time_ns: np.ndarray, rate_rad_s: np.ndarray, *, temperature_degc: Optional[np.ndarray] = None,
               still: Optional[np.ndarray] = None, odometer_pulses: Optional[np.ndarray] = None,
               acceleration_m_s2: Optional[np.ndarray] = None) -> Corrected:
        """Takes n samples: times, n by 3 rates (n by 1 of a single axis) and what decides about rest, one element a sample.

        Accelerations are n by 3, specific force (1 g upwards at rest), NaN where there is none.
        """
        _require_whole_numbers(time_ns, odometer_pulses)
        arrays = self._node.replay(time_ns, rate_rad_s, temperature_degc, still, odometer_pulses,
                                   acceleration_m_s2)
        return Corrected(time_ns=np.asarray(time_ns), **arrays)

    def replay_recording(self, recording: Recording) -> Corrected:
        """Takes the samples of a recording."""
        return self.replay(**recording.arrays())

    def step(self, time_ns: int, rate_rad_s: "tuple[float, float, float]", *, still: bool) -> Corrected:
        """Takes one sample; the result has one row. Node(sample_period_s=...) has to be given."""
        return self.replay(np.array([time_ns]), np.array([rate_rad_s], np.float32), still=np.array([still]))


def _options(model_or_name: ModelOrName, learns_noise: bool, still_from: str,
             filter_rate_hz: Optional[float]) -> _native.NodeOptions:
    options = _native.NodeOptions()
    options.model = _text_of(model_or_name)
    options.learns_noise = learns_noise
    options.still_from = still_from
    options.filter_rate_hz = filter_rate_hz
    return options


def _text_of(model_or_name: ModelOrName) -> "str | bytes":
    return model_or_name.toml if isinstance(model_or_name, Model) else os.fsencode(model_or_name)


def _words(name: "str | bytes") -> str:
    """A name for results; what is no UTF-8 is replaced."""
    return os.fsencode(name).decode("utf-8", "replace")


def _require_whole_numbers(time_ns: np.ndarray, odometer_pulses: Optional[np.ndarray]) -> None:
    """Refuses what would be cut to whole numbers: seconds would all become 0 or 1."""
    if np.asarray(time_ns).dtype.kind not in "iu":
        raise TypeError("time_ns: expected whole nanoseconds (integers); seconds * 1e9, rounded")
    if odometer_pulses is not None and np.asarray(odometer_pulses).dtype.kind not in "iu":
        raise TypeError("odometer_pulses: expected counts (integers)")


def _source_of(recording: PathOrRecording) -> "tuple[_native.Source, str]":
    if isinstance(recording, Recording):
        _require_whole_numbers(recording.time_ns, recording.odometer_pulses)
        return _native.Source.of_arrays(**recording.arrays(), **recording.references()), _words(recording.name)
    return _native.Source(os.fsencode(recording)), _words(os.path.basename(os.fspath(recording)))
