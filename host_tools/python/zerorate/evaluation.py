"""Scores of predictors: those of the node, and one of the user."""

from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np

from .results import DPH_PER_RAD_S, axes_to_draw_on, table


@dataclass(frozen=True)
class PredictorScore:
    """Heading drift of a predictor over the drives of an axis, None where the true rate is not known; and what it predicted
    for the first seconds of each next stop, which needs no truth."""

    drives: int
    heading_drift_rms_deg: Optional[float]
    ratio_to_calibration_mean: Optional[float]
    coverage95: Optional[float]
    stops: int
    stop_error_rms_dph: Optional[float]
    stop_error_rms_sigmas: Optional[float]
    stop_coverage95: Optional[float]


_PREDICTORS = ("kalman", "moving_average", "calibration_mean")


@dataclass(frozen=True)
class StopErrors:
    """Each next stop: the bias that its first seconds measured, and that less the predicted one, n by axes [deg/h]."""

    measured_dph: np.ndarray
    error_dph: "dict[str, np.ndarray]"


@dataclass(frozen=True)
class DriveErrors:
    """Each drive: beginning and length [s], and the error of its heading by predictor [deg], n by axes of a schedule, n
    against a reference. Against a reference the bias is that at departure, from middle to middle of the stops."""

    from_s: np.ndarray
    length_s: np.ndarray
    error_deg: "dict[str, np.ndarray]"


def _root_mean_square(values: np.ndarray) -> Optional[float]:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else None


def _after(biases: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """The biases that were predicted after periods of rest, NaN before the first."""
    known = np.concatenate([biases, np.full((1, biases.shape[1]), np.nan)])
    return known[np.where(periods < 0, -1, periods).astype(int)]


def _stop_errors(details: "dict[str, np.ndarray]", axes: int, biases: Optional[np.ndarray]) -> StopErrors:
    measured = details.get("stop_measured", np.empty(0)).reshape(-1, axes)
    by_predictor = details.get("stop_error", np.empty(0)).reshape(-1, axes, len(_PREDICTORS))
    errors = {name: by_predictor[:, :, k] for k, name in enumerate(_PREDICTORS)}
    if biases is not None:
        errors["own"] = measured - _after(biases, details.get("stop_period", np.empty(0)))
    return StopErrors(measured * DPH_PER_RAD_S, {name: error * DPH_PER_RAD_S for name, error in errors.items()})


def _drive_errors(details: "dict[str, np.ndarray]", kind: str, axes: int, biases: Optional[np.ndarray]) -> DriveErrors:
    def of(name: str) -> np.ndarray:
        return details.get(f"{kind}_{name}", np.empty(0))

    measured, length_s = of("measured").reshape(-1, axes), of("length_s")
    by_predictor = of("error").reshape(-1, axes, len(_PREDICTORS))
    errors = {name: by_predictor[:, :, k] for k, name in enumerate(_PREDICTORS)}
    if biases is not None:
        errors["own"] = measured - _after(biases, of("period")) * length_s[:, np.newaxis]
    degrees = {name: np.degrees(error) for name, error in errors.items()}
    return DriveErrors(of("from_s"), np.abs(length_s), degrees)


def _score_of_own(stops: StopErrors, drives: Optional[DriveErrors], axis: int) -> PredictorScore:
    """Without intervals: a predictor of a user states none."""
    of_stops = stops.error_dph["own"][:, axis]
    drift = ratio = None
    count = 0
    if drives is not None:
        of_drives = drives.error_deg["own"][:, axis]
        both = np.isfinite(of_drives)
        count = int(np.count_nonzero(both))
        drift = _root_mean_square(of_drives)
        mean = _root_mean_square(drives.error_deg["calibration_mean"][both, axis])
        ratio = drift / mean if drift is not None and mean else None
    return PredictorScore(count, drift, ratio, None, int(np.count_nonzero(np.isfinite(of_stops))), _root_mean_square(of_stops),
                          None, None)


@dataclass(frozen=True)
class Evaluation:
    """Scores by axis and predictor, as `zerorate replay` finds them. `json` is its whole answer.

    `still` says of each row whether the node learnt from it, `stops` and `drives` have the single errors; `drives` is None
    where nobody knows the true rate, and `reference_drives` where there is no reference.
    """

    scores: "dict[str, dict[str, PredictorScore]]"
    json: "dict[str, Any]" = field(repr=False)
    true_drives: "Optional[dict[str, Any]]" = field(default=None, repr=False)  # scores against a reference
    still: np.ndarray = field(default_factory=lambda: np.empty(0, bool), repr=False)
    stops: Optional[StopErrors] = field(default=None, repr=False)
    drives: Optional[DriveErrors] = field(default=None, repr=False)
    reference_drives: Optional[DriveErrors] = field(default=None, repr=False)

    @classmethod
    def of_details(cls, json: "dict[str, Any]", details: "dict[str, np.ndarray]",
                   biases: Optional[np.ndarray]) -> "Evaluation":
        names = PredictorScore.__dataclass_fields__
        scores = {axis: {predictor: PredictorScore(**{name: score[name] for name in names})
                         for predictor, score in of_axis["predictors"].items()}
                  for axis, of_axis in json["axes"].items()}
        axes = 1 if "rate" in json["axes"] else 3
        stops = _stop_errors(details, axes, biases)
        drives = _drive_errors(details, "drive", axes, biases) if json["truth_known"] else None
        reference = None
        if "true_axis" in details:
            vertical = int(details["true_axis"][0])
            of_axis = None if biases is None else biases[:, [vertical]]
            whole = _drive_errors(details, "true", 1, of_axis)
            reference = DriveErrors(whole.from_s, whole.length_s, {name: error[:, 0] for name, error in whole.error_deg.items()})
        if biases is not None:
            for axis, predictors in scores.items():
                predictors["own"] = _score_of_own(stops, drives, 0 if axis == "rate" else "xyz".index(axis))
        return cls(scores, json, json.get("true_drives"), details.get("still", np.empty(0)) > 0.5, stops, drives, reference)

    def _rows(self) -> "list[list[Any]]":
        return [[axis, predictor, score.drives, score.heading_drift_rms_deg, score.ratio_to_calibration_mean, score.coverage95,
                 score.stop_error_rms_dph, score.stop_coverage95]
                for axis, predictors in self.scores.items() for predictor, score in predictors.items()]

    def _repr_html_(self) -> str:
        rows = [["" if cell is None else f"{cell:.3g}" if isinstance(cell, float) else cell for cell in row]
                for row in self._rows()]
        return table("Heading drift", ["axis", "predictor", "drives", "rms [deg]", "ratio to calibration mean",
                                        "inside the 95 % interval", "next stop, rms [deg/h]", "inside"], rows)

    def plot(self, ax: Any = None) -> Any:
        """Draws the drift of each axis and predictor as bars; without a known rate what the next stops differed by."""
        figure, label = (3, "heading drift rms [deg]") if self.json["truth_known"] else (6, "error at the next stop rms [deg/h]")
        ax = axes_to_draw_on(ax, xlabel=label)
        rows = [row for row in self._rows() if row[figure] is not None]
        ax.barh([f"{row[0]} {row[1]}" for row in rows], [row[figure] for row in rows])
        return ax
