"""MuJoCo: a flex of tetrahedra with St. Venant–Kirchhoff elasticity."""

import mujoco
import numpy as np

from peer import STEP, Scene


def words(numbers):
    return " ".join(str(each) for each in np.ravel(numbers).tolist())


scene = Scene(__doc__)
contact = 'condim="3"'
if scene.floor:
    # A contact is a stiff damped spring. Its damping ratio gives the restitution: e = exp(-πζ/√(1-ζ²)).
    logarithm = np.log(scene.floor["restitution"])
    ratio = -logarithm / np.hypot(np.pi, logarithm)
    contact += f' solref="{1 / (15 * scene.frequency * ratio)} {ratio}" solimp="0.99 0.99 0.001"'
    contact += f' friction="{scene.floor["friction"]} 0 0"'
floor = f'<geom type="plane" size="9 9 1" zaxis="0 1 0" {contact}/>' if scene.floor else ""
pin = f'<pin id="{words(np.flatnonzero(scene.held))}"/>' if scene.held.any() else ""
model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{STEP}" gravity="{words(scene.gravity)}" cone="elliptic">
    <flag autoreset="disable"/>
  </option>
  <worldbody>
    {floor}
    <flexcomp name="body" type="direct" dim="3" radius="0.0001" mass="{scene.mass.sum()}"
        point="{words(scene.position)}" element="{words(scene.tetrahedra())}">
      <contact selfcollide="none" {contact}/>
      <elasticity young="{scene.young}" poisson="0" damping="{2 * scene.damping_ratio / scene.frequency}"/>
      {pin}
    </flexcomp>
  </worldbody>
</mujoco>""")
data = mujoco.MjData(model)
data.qvel[:] = scene.velocity[~scene.held].ravel()  # held nodes have no degrees of freedom
mujoco.mj_forward(model, data)
scene.record(f"MuJoCo {mujoco.__version__}", lambda: mujoco.mj_step(model, data), lambda: data.flexvert_xpos)
