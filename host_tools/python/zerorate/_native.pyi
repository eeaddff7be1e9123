"""What native.cpp offers; use the package `zerorate` instead."""

from typing import Optional

import numpy as np
from numpy.typing import NDArray

__version__: str

class RecordingError(ValueError): ...
class ModelError(ValueError): ...

class Source:
    def __init__(self, path: "str | bytes", columns: str = "", units: str = "", delimiter: str = "") -> None: ...
    @staticmethod
    def of_arrays(
        time_ns: NDArray[np.int64],
        rate_rad_s: NDArray[np.float32],
        temperature_degc: Optional[NDArray[np.float32]] = None,
        still: Optional[NDArray[np.bool_]] = None,
        odometer_pulses: Optional[NDArray[np.int64]] = None,
        acceleration_m_s2: Optional[NDArray[np.float32]] = None,
        ref_heading_rad: Optional[NDArray[np.float32]] = None,
        ref_rate_rad_s: Optional[NDArray[np.float32]] = None,
        ref_speed_m_s: Optional[NDArray[np.float32]] = None,
    ) -> "Source": ...
    def read(self) -> dict[str, NDArray]: ...

class NodeOptions:
    model: "str | bytes"
    still_from: str
    learns_noise: bool
    filter_rate_hz: Optional[float]
    settle_s: float
    hold_back_s: float

class Node:
    def __init__(self, options: NodeOptions, sample_period_s: Optional[float] = None) -> None: ...
    def replay(
        self,
        time_ns: NDArray[np.int64],
        rate_rad_s: NDArray[np.float32],
        temperature_degc: Optional[NDArray[np.float32]] = None,
        still: Optional[NDArray[np.bool_]] = None,
        odometer_pulses: Optional[NDArray[np.int64]] = None,
        acceleration_m_s2: Optional[NDArray[np.float32]] = None,
    ) -> dict[str, NDArray]: ...

_Outcome = tuple[str, dict[str, str], list[str]]

def characterize(source: Source, name: str, axis: str, order: Optional[float], still_from: str, accept: str) -> _Outcome: ...
def diagnose(
    source: Source, name: str, axis: str, model: Optional[str], holdout: float, still_from: str, accept: str
) -> tuple[_Outcome, dict[str, list[list[float]]]]: ...
def evaluate(
    source: Source,
    axis: str,
    schedule: Optional[str],
    options: NodeOptions,
    vertical_axis: str,
    reference_error_deg: Optional[float],
    reference_from_s: float,
) -> tuple[str, dict[str, list[float]]]: ...
def allan_deviation(
    rate: NDArray[np.float64], sample_period_s: float, points_per_decade: float
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]: ...
def model_names() -> list[str]: ...
def model_text(name: "str | bytes") -> str: ...
