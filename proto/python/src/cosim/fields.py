"""Kinds of fields that may cross the interface, and the table of the common ones.

The table is that of `proto/contract/src/field.rs`. A solver that exchanges further fields lists
them in `Solver.fields`.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

Mapping = Literal["conservative", "consistent"]
Body = Literal["upper", "lower", "interface"]


@dataclass(frozen=True)
class FieldKind:
    """All properties of a field that do not depend on a run."""

    name: str
    """Name in messages, results and case files; at most 31 bytes of ASCII."""
    unit: str
    """SI unit; at most 15 bytes of ASCII."""
    components: int = 1
    """Number of components; the values are component-major."""
    mapping: Mapping = "consistent"
    """Quantity that a mapping between grids preserves: the surface integral, or a constant."""
    body: Body = "interface"
    """Body of the field; the case names the bodies (`Case.bodies`)."""
    meaning: str = ""
    """Meaning of the field, in one line."""

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
        return asdict(self)

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> FieldKind:
        """Read from JSON."""
        return cls(**{name: value[name] for name in cls.__dataclass_fields__})


BODIES: tuple[Body, Body] = ("lower", "upper")

TABLE: dict[str, FieldKind] = {
    kind.name: kind
    for kind in (
        FieldKind("pressure", "Pa", meaning="normal contact pressure, positive in compression"),
        FieldKind(
            "geometry",
            "m",
            3,
            meaning="geometry of a grid that moves, on a topic of its own (grid/geometry.rs)",
        ),
        FieldKind(
            "normal_gap", "m", meaning="distance of the deformed surfaces, 0 where they touch"
        ),
        FieldKind(
            "traction", "Pa", 2, meaning="tangential traction (x, y) acting on the upper body"
        ),
        FieldKind(
            "slip_velocity",
            "m/s",
            2,
            meaning="velocity (x, y) of the upper surface relative to the lower one",
        ),
        FieldKind(
            "friction_power",
            "W/m2",
            mapping="conservative",
            meaning="frictional power density, element and window mean",
        ),
        FieldKind(
            "surface_speed",
            "m/s",
            2,
            meaning="speeds (upper, lower) at which material passes through the contact, on a "
            "one-point grid",
        ),
        FieldKind(
            "contact_force",
            "N",
            3,
            meaning="force (x, y, z) of the contact on the upper body, on a one-point grid",
        ),
        *(
            FieldKind(
                f"{body}_temperature",
                "K",
                body=body,
                meaning=f"temperature rise of the {body} body's surface",
            )
            for body in BODIES
        ),
        *(
            FieldKind(
                f"{body}_rise_integral",
                "K m",
                body=body,
                meaning=f"temperature rise of the {body} body integrated over the depth z, each wave "
                "number k weighted by exp(-k z)",
            )
            for body in BODIES
        ),
        *(
            FieldKind(
                f"{body}_wear_depth",
                "m",
                body=body,
                meaning=f"depth that has been worn off the {body} body",
            )
            for body in BODIES
        ),
        FieldKind(
            "lower_section_temperature",
            "K",
            body="lower",
            meaning="temperature rise of the lower body in a vertical plane along x under the surface",
        ),
        FieldKind(
            "upper_section_temperature",
            "K",
            body="upper",
            meaning="temperature rise of the upper body in a vertical plane along x over the surface",
        ),
        *(
            FieldKind(
                f"{body}_section_{name}_stress",
                "Pa",
                body=body,
                meaning=f"{words} of the {body} body in a vertical plane along x {side} the surface",
            )
            for name, words in (
                ("von_mises", "von Mises stress"),
                ("max_shear", "largest shear stress"),
            )
            for body, side in zip(BODIES, ("under", "over"))
        ),
        FieldKind(
            "point_von_mises_stress",
            "Pa",
            meaning="von Mises stress at points that the case names",
        ),
        FieldKind(
            "point_max_shear_stress",
            "Pa",
            meaning="largest shear stress (Tresca) at points that the case names",
        ),
        FieldKind(
            "point_hydrostatic_stress",
            "Pa",
            meaning="mean normal stress at points that the case names, tension positive",
        ),
        FieldKind(
            "point_stress",
            "Pa",
            6,
            meaning="stress tensor (xx, yy, zz, xy, yz, xz) at points that the case names, tension positive",
        ),
        *(
            FieldKind(
                f"point_principal_stress_{number}",
                "Pa",
                meaning=f"{which} principal stress at points that the case names",
            )
            for number, which in enumerate(("largest", "middle", "smallest"), 1)
        ),
        *(
            FieldKind(
                f"point_principal_direction_{number}",
                "1",
                3,
                meaning=f"unit vector along the {which} principal stress",
            )
            for number, which in enumerate(("largest", "middle", "smallest"), 1)
        ),
    )
}
"""All rows of the table, by name."""
