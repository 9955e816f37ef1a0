"""Newton on Warp: tetrahedra of stable neo-Hookean material (Smith et al. 2018), stepped with explicit forces."""

import newton
import numpy as np
import warp

from peer import STEP, Scene

scene = Scene(__doc__)
warp.set_device("cpu")
builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=tuple(scene.gravity))
free_mass = np.where(scene.held, 0.0, scene.mass)  # nodes without mass are held
builder.add_particles(list(scene.position), list(scene.velocity), list(free_mass), radius=[0.0] * len(free_mass))

# Lamé's constants are μ = E/2 and λ = 0. This energy has them for k_mu = 4/3 μ and k_lambda = λ + 5/6 μ.
# Its damping is not of strain but of the deformation gradient, so it brakes rotations, too.
mu = scene.young / 2  # Pa
damping = 2 * scene.damping_ratio / scene.frequency  # s
for corners in scene.tetrahedra().tolist():
    builder.add_tetrahedron(*corners, k_mu=4 / 3 * mu, k_lambda=5 / 6 * mu, k_damp=damping * mu)
if scene.floor:
    builder.add_ground_plane()
model = builder.finalize()

if scene.floor:
    # A contact is a stiff spring, damped on approach only: it rebounds with e = exp(-ζ acos(ζ) / √(1-ζ²)).
    ratios = np.linspace(0, 0.999, 1000)
    rebounds = np.exp(-ratios * np.arccos(ratios) / np.sqrt(1 - ratios**2))
    ratio = np.interp(-scene.floor["restitution"], -rebounds, ratios)
    frequency, mass = 15 * scene.frequency, scene.mass[0]
    constants = dict(ke=mass * frequency**2, kd=2 * ratio * mass * frequency, kf=1e3, mu=scene.floor["friction"])
    for name, value in constants.items():  # the mean of node and floor counts
        setattr(model, "soft_contact_" + name, value)
        getattr(model, "shape_material_" + name).fill_(value)

solver, control = newton.solvers.SolverSemiImplicit(model), model.control()
pipeline = newton.CollisionPipeline(model)
contacts, now, after = pipeline.contacts(), model.state(), model.state()


def step():
    global now, after
    now.clear_forces()
    pipeline.collide(now, contacts)
    solver.step(now, after, control, contacts, STEP)
    now, after = after, now


scene.record(f"Newton {newton.__version__}, Warp {warp.__version__}", step, lambda: now.particle_q.numpy())
