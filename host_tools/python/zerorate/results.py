"""Results as dataclasses that show themselves in a notebook and draw themselves with matplotlib."""

import html
import pathlib
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np

DPH_PER_RAD_S = 3600.0 * 180.0 / np.pi


def table(title: str, header: "list[str]", rows: "list[list[object]]") -> str:
    def line(tag: str, cells: "list[object]") -> str:
        return "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>"

    return (f"<table><caption>{html.escape(title)}</caption>{line('th', list(header))}" +
            "".join(line("td", row) for row in rows) + "</table>")


def axes_to_draw_on(given: Any, **labels: Any) -> Any:
    """The axes of matplotlib to draw on: those given, or new ones."""
    if given is None:
        import matplotlib.pyplot as plt  # only who draws needs it
        given = plt.subplots(layout="constrained")[1]
    given.set(**labels)
    return given


@dataclass(frozen=True)
class Figure:
    """A figure with its 95 % interval; NaN where there is none."""

    value: float
    lo95: float
    hi95: float

    @classmethod
    def of_json(cls, estimate: "dict[str, Any]") -> "Figure":
        return cls(*(float("nan") if estimate[key] is None else estimate[key] for key in ("value", "lo95", "hi95")))

    @classmethod
    def of_ci(cls, json: "dict[str, Any]", name: str) -> "Figure":
        low, high = json[name + "_ci95"]
        return cls.of_json({"value": json[name], "lo95": low, "hi95": high})

    def __str__(self) -> str:
        return f"{self.value:.3g} [{self.lo95:.3g}, {self.hi95:.3g}]"


@dataclass(frozen=True)
class Model:
    """A sensor model as TOML text."""

    name: str
    toml: str = field(repr=False)

    def save(self, path: "str | pathlib.Path") -> None:
        """Writes the model for `zerorate replay --model`, zerorated and `zerorate export`."""
        pathlib.Path(path).write_text(self.toml, encoding="utf-8")

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.toml)}</pre>"


@dataclass(frozen=True)
class Recording:
    """Samples of a gyro: n times, n by 3 (or n by 1) rates, and what else the file has."""

    time_ns: np.ndarray
    rate_rad_s: np.ndarray
    temperature_degc: Optional[np.ndarray] = None
    still: Optional[np.ndarray] = None
    odometer_pulses: Optional[np.ndarray] = None
    name: str = "recording"
    acceleration_m_s2: Optional[np.ndarray] = None
    ref_heading_rad: Optional[np.ndarray] = None
    ref_rate_rad_s: Optional[np.ndarray] = None
    ref_speed_m_s: Optional[np.ndarray] = None

    def arrays(self) -> "dict[str, Optional[np.ndarray]]":
        """The arrays by name, as Node.replay() takes them."""
        return {"time_ns": self.time_ns, "rate_rad_s": self.rate_rad_s, "temperature_degc": self.temperature_degc,
                "still": self.still, "odometer_pulses": self.odometer_pulses,
                "acceleration_m_s2": self.acceleration_m_s2}

    def references(self) -> "dict[str, Optional[np.ndarray]]":
        """What a reference system measured, NaN where it did not."""
        return {"ref_heading_rad": self.ref_heading_rad, "ref_rate_rad_s": self.ref_rate_rad_s,
                "ref_speed_m_s": self.ref_speed_m_s}

    def rows(self, part: "slice | np.ndarray") -> "Recording":
        """Some of the samples: a slice, indices or truth values."""
        def of(values: Optional[np.ndarray]) -> Optional[np.ndarray]:
            return None if values is None else values[part]

        return Recording(name=self.name, **{name: of(values) for name, values in (self.arrays() | self.references()).items()})

    @property
    def time_s(self) -> np.ndarray:
        """Time since the first sample [s]."""
        return (self.time_ns - self.time_ns[0]) * 1e-9

    @property
    def axes(self) -> "list[str]":
        return ["rate"] if self.rate_rad_s.shape[1] == 1 else ["x", "y", "z"]

    def _repr_html_(self) -> str:
        rows = [[axis, f"{np.degrees(np.nanmean(rate)):.4g}", f"{np.degrees(np.nanstd(rate)):.4g}"]
                for axis, rate in zip(self.axes, self.rate_rad_s.T)]
        return table(f"{self.name}: {len(self.time_ns)} samples over {self.time_s[-1]:.0f} s",
                      ["axis", "mean [deg/s]", "standard deviation [deg/s]"], rows)

    def plot(self, ax: Any = None) -> Any:
        """Draws the rates over time."""
        ax = axes_to_draw_on(ax, xlabel="time [s]", ylabel="rate [deg/s]", title=self.name)
        for axis, rate in zip(self.axes, self.rate_rad_s.T):
            ax.plot(self.time_s, np.degrees(rate), label=axis, linewidth=0.5)
        ax.legend()
        return ax


@dataclass(frozen=True)
class AllanDeviation:
    """Allan deviation in the unit of the rate, with 95 % intervals."""

    tau_s: np.ndarray
    adev: np.ndarray
    lo95: np.ndarray
    hi95: np.ndarray
    edf: np.ndarray

    def _repr_html_(self) -> str:
        rows = [[f"{value:.4g}" for value in row] for row in zip(self.tau_s, self.adev, self.lo95, self.hi95)]
        return table("Allan deviation", ["tau [s]", "deviation", "lower 95 %", "upper 95 %"], rows)

    def plot(self, ax: Any = None, unit: str = "unit of the rate", label: str = "") -> Any:
        """Draws the curve with its interval."""
        ax = axes_to_draw_on(ax, xlabel="averaging time [s]", ylabel=f"Allan deviation [{unit}]", xscale="log", yscale="log")
        line, = ax.plot(self.tau_s, self.adev, label=label)
        ax.fill_between(self.tau_s, self.lo95, self.hi95, alpha=0.3, color=line.get_color(), linewidth=0)
        return ax


@dataclass(frozen=True)
class NoiseCoefficients:
    """N, B and K of IEEE Std 952, fitted together: white noise, 1/f noise (d = 1/2) and a random walk. None where the
    recording does not show that noise."""

    angle_random_walk_dps_per_sqrt_hz: Figure
    bias_instability_dph: Optional[Figure]
    rate_random_walk_dph_per_sqrt_h: Optional[Figure]

    @classmethod
    def of_json(cls, json: "dict[str, Any]") -> "NoiseCoefficients":
        names = ("angle_random_walk_dps_per_sqrt_hz", "bias_instability_dph", "rate_random_walk_dph_per_sqrt_h")
        return cls(*(Figure.of_json(json[name]) if json.get(name) else None for name in names))


@dataclass(frozen=True)
class AllanFloor:
    """The floor of an Allan deviation: the point whose upper limit is the lowest."""

    adev_dph: Figure
    tau_s: float

    @classmethod
    def of_json(cls, json: "dict[str, Any]") -> "AllanFloor":
        return cls(Figure(json["adev_dph"], json["lo95_dph"], json["hi95_dph"]), json["tau_s"])


@dataclass(frozen=True)
class AxisNoise:
    """Noise of an axis. N, and strength and order d of the flicker noise where there is some, are those of the model;
    `coefficients` are N, B and K of IEEE Std 952, and `without_flicker` N and K of filters without 1/f noise (Kalibr). The
    flicker noise's strength at 1 rad/s is B where d = 1/2 alone."""

    angle_random_walk_dps_per_sqrt_hz: Figure
    flicker_dph_at_1_rad_s: Optional[Figure]
    order: Optional[Figure]
    coefficients: NoiseCoefficients
    without_flicker: Optional[NoiseCoefficients]
    allan_floor: Optional[AllanFloor]
    allan_dph: Optional[AllanDeviation] = field(repr=False)
    model: Model
    remarks: "list[str]"

    @classmethod
    def of_json(cls, json: "dict[str, Any]", model: Model) -> "AxisNoise":
        flicker, coefficients = json["flicker"], json["coefficients"]
        columns = [np.array([point[key] for point in json["allan_deviation"]], float)
                   for key in ("tau_s", "adev_dph", "lo95_dph", "hi95_dph", "edf")]
        return cls(Figure.of_json(json["angle_random_walk_dps_per_sqrt_hz"]),
                   Figure.of_json(flicker["bias_instability_dph"]) if flicker else None,
                   Figure.of_json(flicker["order"]) if flicker else None, NoiseCoefficients.of_json(coefficients),
                   NoiseCoefficients.of_json(coefficients["without_flicker"]) if coefficients["without_flicker"] else None,
                   AllanFloor.of_json(json["allan_floor"]) if json["allan_floor"] else None,
                   AllanDeviation(*columns) if len(columns[0]) else None, model, json["remarks"])


@dataclass(frozen=True)
class Characterization:
    """Noise of each axis, as `zerorate characterize` finds it. `json` is its whole answer."""

    axes: "dict[str, AxisNoise]"
    middle_axis: str
    doubts: "list[str]"
    json: "dict[str, Any]" = field(repr=False)

    @classmethod
    def of_json(cls, json: "dict[str, Any]", models: "dict[str, str]", doubts: "list[str]") -> "Characterization":
        axes = {axis: AxisNoise.of_json(noise, Model(f"{json['recording']}, axis {axis}", models[axis]))
                for axis, noise in json["axes"].items()}
        return cls(axes, json["middle_axis"], doubts, json)

    @property
    def middle(self) -> Model:
        """Model of the axis with the median slow noise: the one for a sensor as a whole."""
        return self.axes[self.middle_axis].model

    def _repr_html_(self) -> str:
        rows = [[axis, noise.angle_random_walk_dps_per_sqrt_hz, noise.flicker_dph_at_1_rad_s or "not detectable",
                 noise.order or ""] for axis, noise in self.axes.items()]
        return table(f"Noise of {self.json['recording']}, with 95 % intervals",
                      ["axis", "N [deg/s/√Hz]", "flicker noise at 1 rad/s [deg/h]", "order d"], rows)

    def plot(self, ax: Any = None) -> Any:
        """Draws the Allan deviations."""
        for axis, noise in self.axes.items():
            if noise.allan_dph is not None:
                ax = noise.allan_dph.plot(ax, unit="deg/h", label=axis)
        if ax is not None:
            ax.legend()
        return ax


@dataclass(frozen=True)
class Cause:
    """An effect that a recording holds, with the probability that it is among the causes."""

    name: str
    probability: float
    stands_alone: bool
    gain_nats: float
    in_model: bool
    parameters: "dict[str, Figure]"

    @classmethod
    def of_json(cls, json: "dict[str, Any]") -> "Cause":
        parameters = json["parameters"]
        figures = {name: Figure.of_ci(parameters, name) for name in parameters if name + "_ci95" in parameters}
        return cls(json["name"], json["probability"], json["stands_alone"], json["gain_nats"], json["in_model"], figures)


@dataclass(frozen=True)
class AxisDiagnosis:
    """Verdict on an axis, its causes and what the extended model is worth."""

    verdict: str
    material: Optional[bool]
    causes: "list[Cause]"
    heading_drift_ratio: Figure
    model: Model
    allan_rad_s: np.ndarray  # tau, recording, base low, base, base high, extended low, extended, extended high
    json: "dict[str, Any]" = field(repr=False)


@dataclass(frozen=True)
class Diagnosis:
    """Diagnosis of each axis, as `zerorate diagnose` finds it."""

    axes: "dict[str, AxisDiagnosis]"
    doubts: "list[str]"
    json: "dict[str, Any]" = field(repr=False)

    @classmethod
    def of_json(cls, json: "dict[str, Any]", models: "dict[str, str]", doubts: "list[str]",
                curves: "dict[str, list[list[float]]]") -> "Diagnosis":
        axes = {}
        for one in json.get("axes", [json]):
            name = one["axis"]
            causes = [Cause.of_json(cause) for cause in one["causes"] + one["further_causes"]]
            axes[name] = AxisDiagnosis(one["verdict"], one["material"], causes,
                                       Figure.of_ci(one["gain"], "heading_drift_ratio"), Model(f"axis {name}", models[name]),
                                       np.array(curves.get(name, [])).reshape(-1, 8).T, one)
        return cls(axes, doubts, json)

    def _repr_html_(self) -> str:
        rows = [[name, axis.verdict, {True: "yes", False: "no", None: "not known"}[axis.material],
                 ", ".join(f"{cause.name} ({cause.probability:.2f})" for cause in axis.causes) or "none",
                 axis.heading_drift_ratio] for name, axis in self.axes.items()]
        return table("Diagnosis", ["axis", "verdict", "matters for the heading", "causes (probability)",
                                    "heading drift, extended over base"], rows)

    def plot(self, axis: Optional[str] = None, ax: Any = None) -> Any:
        """Draws the Allan deviation of an axis (default: the first) with the 95 % bands of base and extended model."""
        axis = axis or next(iter(self.axes))
        ax = axes_to_draw_on(ax, xlabel="averaging time [s]", ylabel="Allan deviation [deg/h]", xscale="log", yscale="log",
                   title=f"axis {axis}: {self.axes[axis].verdict}")
        tau, measured, *bands = self.axes[axis].allan_rad_s
        for name, (low, _, high) in (("base", bands[:3]), ("extended", bands[3:])):
            ax.fill_between(tau, low * DPH_PER_RAD_S, high * DPH_PER_RAD_S, alpha=0.3, label=name)
        ax.plot(tau, measured * DPH_PER_RAD_S, label="recording", color="black")
        ax.legend()
        return ax


@dataclass(frozen=True)
class Corrected:
    """What the node published, one row a sample; NaN and infinite where nothing was known yet."""

    time_ns: np.ndarray
    corrected_rad_s: np.ndarray
    bias_rad_s: np.ndarray
    sigma_rad_s: np.ndarray
    turn_rad: np.ndarray
    turn_sigma_rad: np.ndarray
    still: np.ndarray
    calibrated: np.ndarray
    has_rate: np.ndarray
    model_inconsistent: np.ndarray
    saturated: np.ndarray
    temperature_missing: np.ndarray
    odometer_disagreement: np.ndarray

    def _repr_html_(self) -> str:
        last = np.degrees(np.stack([self.bias_rad_s[-1], self.sigma_rad_s[-1]])) * 3600.0
        return table(f"{len(self.time_ns)} samples, {np.mean(self.still):.0%} at rest",
                      ["axis", "last bias [deg/h]", "its sigma [deg/h]"],
                      [[i, f"{bias:.4g}", f"{sigma:.3g}"] for i, (bias, sigma) in enumerate(last.T)])

    def plot(self, axis: int = 0, ax: Any = None) -> Any:
        """Draws the bias of an axis with its 95 % interval; the stops are grey."""
        ax = axes_to_draw_on(ax, xlabel="time [s]", ylabel="bias [deg/h]")
        time_s = (self.time_ns - self.time_ns[0]) * 1e-9
        bias, sigma = (np.where(self.calibrated, values[:, axis], np.nan) * DPH_PER_RAD_S
                       for values in (self.bias_rad_s, self.sigma_rad_s))
        ax.plot(time_s, bias)
        ax.fill_between(time_s, bias - 1.96 * sigma, bias + 1.96 * sigma, alpha=0.3, linewidth=0)
        ax.fill_between(time_s, 0, 1, where=self.still, transform=ax.get_xaxis_transform(), color="grey", alpha=0.15,
                        linewidth=0)
        return ax
