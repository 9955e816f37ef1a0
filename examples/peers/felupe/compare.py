"""The same bodies at rest in felupe and in this program: a cantilever of hexahedra, and a block in uniaxial stretch. One table in Markdown.

    localshape-study load -o load
    python compare.py load/load.csv
"""

import csv
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import felupe
import numpy as np

HERE = Path(__file__).parent
TOLERANCE = 1e-10  # of Newton's method
PARTS = 8  # in which the load grows


class Law:
    """The stable neo-Hookean law of this program, P = μ F + (λ + μ)(J − α) cof F, as a material of felupe."""

    def __init__(self, young, poisson):
        self.mu = young / (2 * (1 + poisson))
        self.sum = self.mu + young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        self.alpha = 1 + self.mu / self.sum

    def stress(self, x, **_):
        gradient = x[0]
        excess = felupe.math.det(gradient) - self.alpha
        return [self.mu * gradient + self.sum * excess * felupe.math.cof(gradient), x[-1]]

    def elasticity(self, x, **_):
        gradient = x[0]
        volume = felupe.math.det(gradient)
        cofactor = felupe.math.cof(gradient)
        inverse = cofactor / volume  # transposed
        identity = np.eye(3)[..., None, None]
        both = np.einsum("ij...,kl...->ijkl...", cofactor, cofactor)
        # The derivative of cof F is J (F⁻ᵀ ⊗ F⁻ᵀ − F⁻ᵀ ⊠ F⁻ᵀ).
        change = np.einsum("ij...,kl...->ijkl...", inverse, inverse) - np.einsum("il...,kj...->ijkl...", inverse, inverse)
        unit = np.einsum("ik...,jl...->ijkl...", identity, identity)
        return [self.mu * unit + self.sum * (both + (volume - self.alpha) * volume * change)]


def materials(young, poisson):
    law = Law(young, poisson)
    mu, lame = law.mu, law.sum - law.mu
    return {
        "neo-hookean": felupe.Material(law.stress, law.elasticity),
        "linear": felupe.LinearElastic(E=young, nu=poisson),
        "felupe's neo-Hookean, ln J": felupe.NeoHookeCompressible(mu=mu, lmbda=lame),
    }


def field(cells, side):
    mesh = felupe.Cube(b=np.multiply(cells, side), n=np.add(cells, 1))
    return felupe.FieldContainer([felupe.Field(felupe.RegionHexahedron(mesh), dim=3)])


def cantilever(material, cells, side, force):
    """The mean displacement of the end of a bar along x that is held at x = 0, under a force across, shared by area."""
    u = field(cells, side)
    points = u.region.mesh.points
    clamp = {"clamp": felupe.Boundary(u[0], fx=0)}
    free = felupe.dof.partition(u, clamp)
    end = np.flatnonzero(np.isclose(points[:, 0], cells[0] * side))
    area = np.prod([np.where(np.isin(points[end, axis], [0, cells[axis] * side]), 0.5, 1.0) for axis in (1, 2)], axis=0)
    values = np.outer(area / area.sum(), force)
    body = felupe.SolidBody(material, u)
    for part in range(1, PARTS + 1):
        load = felupe.PointLoad(u, end, values * part / PARTS)
        found = felupe.newtonraphson(
            items=[body, load], dof0=free[0], dof1=free[1], ext0=felupe.dof.apply(u, clamp, free[0]),
            tol=TOLERANCE, verbose=False,
        )
        assert found.success
    return u[0].values[end].mean(axis=0)


def stretched(material, stretch, side=1.0):
    """The force on the ends of a cube of 2×2×2 cells that is free across, over the area at rest."""
    u = field([2, 2, 2], side / 2)
    body = felupe.SolidBody(material, u)
    for part in range(1, PARTS + 1):
        bounds, case = felupe.dof.uniaxial(u, move=(stretch - 1) * side * part / PARTS, clamped=False, return_loadcase=True)
        found = felupe.newtonraphson(items=[body], **case, tol=TOLERANCE, verbose=False)
        assert found.success
    return felupe.tools.force(u, body.assemble.vector(u), bounds["move"])[0] / side**2


def closed_form(name, stretch, poisson):
    """The force of the law over E and the area at rest."""
    law = Law(1.0, poisson)
    square = (law.alpha - law.mu / (law.sum * stretch)) / stretch  # of the stretch across
    neo_hookean = law.mu * stretch + law.sum * (stretch * square - law.alpha) * square
    return neo_hookean if name == "neo-hookean" else stretch - 1


def ours(scene, across):
    """The mean displacement of the end in this program, by model."""
    folder = Path(tempfile.mkdtemp())
    cells, side = [8 * across, across, across], 0.1 / across
    options = ["--set", f"body.lattice.cells={cells}", "--set", f"body.lattice.side={side}"]
    subprocess.run(["localshape", "simulate", scene, "-o", folder, "--quiet", *options], check=True)
    with open(folder / "diagnostics.csv") as file:
        rows = list(csv.DictReader(file))
    place = lambda row: np.array([float(row[f"displacement of end_{axis}"]) for axis in "xyz"])
    return {row["run"].lower(): place(row) for row in rows}


def shown(way):
    return f"{way[0] + 0.0:.6f}, {way[1]:.6f}".replace("-0.000000", "0.000000").replace("-", "−")


def line(*cells):
    print("|", " | ".join(cells), "|")


scene = HERE / "cantilever.toml"
text = tomllib.loads(scene.read_text())
young, poisson = (text["run"][0]["model"][key] for key in ("young", "poisson"))
force = text["load"][0]["force"]
with open(sys.argv[1]) as file:
    rows = list(csv.DictReader(file))
study = {(row["case"], row["model"], row["elements"], row["refined"]): row["found_over_closed_form"] for row in rows}

print(f"felupe {felupe.__version__}, NumPy {np.__version__}; Newton's method to {TOLERANCE}, loads in {PARTS} parts.\n")
line("case", "law", "felupe", "this program", "difference")
line("---", "---", "---:", "---:", "---:")
for across in (1, 2, 4):
    cells, side = (8 * across, across, across), 0.1 / across
    here = ours(scene, across)
    for name, material in materials(young, poisson).items():
        there = cantilever(material, cells, side, force)
        case = f"end of a cantilever, {across}×{across}×{8 * across}: along, across (m)"
        if name in here:
            off = np.linalg.norm(here[name] - there) / np.linalg.norm(there)
            line(case, name, *(shown(way) for way in (there, here[name])), f"{off:.0e}")
        else:
            line(case, name, shown(there), "–", "–")
for case, stretch in (("A bar stretched to 1.5 of its length", 1.5), ("A bar pressed to 0.8 of its length", 0.8)):
    for name, material in materials(1.0, 0.3).items():
        there = stretched(material, stretch)
        ratio = study.get((case, name, "hexahedra", "1"))
        here = float(ratio) * closed_form(name, stretch, 0.3) if ratio else None
        ours_and_off = (f"{here:.6f}", f"{abs(here / there - 1):.0e}") if here else ("–", "–")
        line(f"{case[2:]}: force / E A", name, f"{there:.6f}", *ours_and_off)
