"""The variables of a result, each declared once with its unit and meaning. Files, plots and the reference use them."""

from collections.abc import Callable

from mckibben.spec import Joint, Muscle

STEP: dict[str, tuple[str, str]] = {
    "length": ("m", "distance between the fittings"),
    "contraction": ("1", "contraction 1 - h/H0, positive when shorter"),
    "force": ("N", "axial force, positive in tension"),
    "pressure": ("Pa", "gauge pressure"),
    "volume": ("m^3", "volume inside the braid"),
    "air_volume": ("m^3", "volume inside the braid without the rubber that lies inside"),
    "contact": ("1", "share of the braid's length as made along which the chamber touches it"),
    "energy_bending_1": ("J", "fibre energy, bending in the tangent plane"),
    "energy_bending_2": ("J", "fibre energy, bending normal to the surface"),
    "energy_twist": ("J", "fibre energy, twist"),
    "energy_chamber": ("J", "energy of the chamber"),
    "energy_stretch": ("J", "fibre energy, stretch"),
    "energy_fittings": ("J", "energy of the fittings, which give way"),
    "energy_crossings": ("J", "energy that crossings store elastically"),
    "energy_sliding": ("J", "energy that the grip of the mesh on the chamber stores elastically"),
    "energy": ("J", "stored energy"),
    "dissipated": ("J", "energy lost by friction since the muscle was made"),
    "work": ("J", "work done on the muscle since the first state"),
    "verdict": ("", "verdict"),
    "reason": ("", "reason for the verdict"),
    "shape": ("", "shape of the meridian"),
    "converged": ("", "whether equilibrium was found"),
    "iterations": ("1", "Newton systems solved"),
    "residual": ("1", "imbalance over the size of its terms"),
    "error_estimate": ("1", "estimated relative error of force and length"),
    "coefficient_tail": ("1", "last coefficients over the largest"),
    "conserved_variation": ("1", "relative variation of the conserved quantity along the length"),
    "modes_length_control": ("1", "negative symmetric modes under length control"),
    "modes_force_control": ("1", "negative symmetric modes under force control"),
    "modes_antisymmetric": ("1", "negative antisymmetric modes (-1: not separated)"),
    "protocol_step": ("1", "which step of the test a state belongs to"),
}
"""Variables with one value per state: unit and meaning."""

FIELDS: dict[str, tuple[str, str]] = {
    "theta": ("rad", "braid angle from the parallels"),
    "psi": ("rad", "slope angle of the meridian"),
    "r": ("m", "radius"),
    "z": ("m", "axial position from the fixed fitting"),
    "stretch_hoop": ("1", "hoop stretch of the chamber"),
    "stretch_axial": ("1", "meridian stretch of the chamber"),
    "stretch_thickness": ("1", "thickness stretch of the chamber"),
    "u1": ("1/m", "fibre strain u1, geodesic curvature"),
    "u2": ("1/m", "fibre strain u2, normal curvature"),
    "u3": ("1/m", "fibre strain u3, twist"),
    "density_bending_1": ("J/m", "fibre energy per unit v, bending in the tangent plane"),
    "density_bending_2": ("J/m", "fibre energy per unit v, bending normal to the surface"),
    "density_twist": ("J/m", "fibre energy per unit v, twist"),
    "density_fibres": ("J/m", "fibre energy per unit v"),
    "density_chamber": ("J/m", "energy of the chamber per unit v"),
    "fibre_tension": ("N", "tension of one fibre"),
    "fibre_stretch": ("1", "stretch of the fibres"),
    "density_stretch": ("J/m", "fibre energy per unit v, stretch"),
    "roll": ("rad", "angle by which a fibre's section has turned about the fibre"),
    "crossing_moment": ("N m", "moment of one crossing, positive against lengthening"),
    "slide": ("m", "how far from here along v, towards the last end, the chamber beside it was mounted"),
    "shear_stress": ("Pa", "shear stress of the mesh on the chamber, positive towards the last end"),
    "gap": ("m", "distance between chamber and mesh, 0 where they touch"),
    "share_mesh": ("1", "share of the axial load F + pi r^2 P carried by the mesh"),
    "share_chamber": ("1", "share of the axial load F + pi r^2 P carried by the chamber"),
    "contact_pressure": ("Pa", "pressure of the chamber on the mesh, below 0 where it would not touch"),
}
"""Variables along the material coordinate v: unit and meaning."""

OBSERVED: dict[str, tuple[str, str]] = {
    name: STEP[name]
    for name in (
        "length", "contraction", "force", "pressure", "volume", "energy_bending_1", "energy_bending_2", "energy_twist",
        "energy_chamber", "energy", "air_volume",
    )
} | {
    "peak_fibre_tension": ("N", "largest tension of a fibre along its length"),
    "largest_radius": ("m", "largest radius along the length"),
}  # fmt: skip
"""Results of one state that have derivatives: unit and meaning."""

EXTREMES: dict[str, tuple[str, str]] = {
    "largest_diameter": ("m", "largest diameter of the braid along the length"),
    "peak_fibre_tension": OBSERVED["peak_fibre_tension"],
    "safety_factor": ("1", "breaking force of a fibre over its largest tension"),
}
"""What tables show of a state's fields: unit and meaning. A muscle without a breaking force has no safety factor."""


def _slides(muscle: Muscle) -> bool:
    return muscle.friction is not None and muscle.friction.chamber_coefficient is not None


OPTIONAL: dict[str, Callable[[Muscle], bool]] = {
    "energy_stretch": lambda muscle: muscle.braid.fibre.stretch,
    "fibre_stretch": lambda muscle: muscle.braid.fibre.stretch,
    "density_stretch": lambda muscle: muscle.braid.fibre.stretch,
    "energy_fittings": lambda muscle: muscle.gives_way,
    "roll": lambda muscle: muscle.braid.joint == Joint.PIN,
    "contact": lambda muscle: muscle.chamber is not None and muscle.chamber.gap,
    "gap": lambda muscle: muscle.chamber is not None and muscle.chamber.gap,
    "energy_crossings": lambda muscle: muscle.friction is not None,
    "dissipated": lambda muscle: muscle.friction is not None,
    "crossing_moment": lambda muscle: muscle.friction is not None,
    "energy_sliding": _slides,
    "slide": _slides,
    "shear_stress": _slides,
}
"""Variables that only some muscles have."""


def has(muscle: Muscle, name: str) -> bool:
    """Whether results of a muscle have a variable."""
    return name not in OPTIONAL or OPTIONAL[name](muscle)


VARIABLES = STEP | FIELDS
LATER = ("air_volume", "contact_pressure")
"""Variables that files of earlier versions do not hold; NaN there."""
COORDINATES = {"step": ("", "state"), "v": ("m", "axial material coordinate")}


def dimensions(name: str) -> tuple[str, ...]:
    """Dimensions of a variable or coordinate."""
    if name in COORDINATES:
        return (name,)
    return ("step",) if name in STEP else ("step", "v")


def about_variable(name: str) -> dict[str, str]:
    """Attributes of a variable or coordinate in a Dataset or file."""
    unit, meaning = (VARIABLES | COORDINATES)[name]
    return {"long_name": meaning} | ({"units": unit} if unit else {})
